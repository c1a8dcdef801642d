//! What the processes of a farm have in common.

use std::{
    io::{Read, Write},
    path::{Path, PathBuf},
    time::Duration,
};

use clap::Args;
use lie_farm::{
    client::ClientError,
    discovery::{DiscoveryError, Wanted},
    network::{Exposure, NetworkError},
    secure::{Bundle, Cluster},
};
use tokio::{net::TcpListener, runtime::Runtime};
use tokio_util::sync::CancellationToken;

use crate::{
    args::say,
    failure::{OrUsage, Usage, usage},
};

/// How long an orderly end may take before the process ends anyhow.
pub(crate) const PATIENCE: Duration = Duration::from_millis(700);

/// The same where LIEs are to be saved.
pub(crate) const PATIENCE_TO_SAVE: Duration = Duration::from_secs(60);

/// Whom a process talks to.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Network")]
pub(crate) struct Network {
    /// Talk to the processes that have this cluster bundle, on whichever machine, and to nobody
    /// else; connections are encrypted. `lie key new` makes one; `-` takes it from standard
    /// input. Without a bundle a process talks to its own machine alone.
    #[arg(long, env = "LIE_BUNDLE", value_name = "FILE")]
    bundle: Option<PathBuf>,
    /// Talk to other machines without a bundle. Connections are neither encrypted nor
    /// authenticated: only for networks on which everybody may see and change everything.
    #[arg(long, env = "LIE_INSECURE")]
    insecure: bool,
}

/// What a user says about whom to talk to.
pub(crate) enum Trust {
    /// Nothing.
    Unsaid,
    /// Anybody.
    Insecure,
    /// The nodes of a cluster.
    Bundle(Bundle),
}

impl Network {
    /// What was said, and the bundle if one is named.
    pub(crate) fn trust(&self) -> Result<Trust, Usage> {
        match (&self.bundle, self.insecure) {
            (Some(_), true) => Err(usage(
                "--bundle and --insecure (or LIE_BUNDLE and LIE_INSECURE) exclude each other: \
                 connections are either protected or not",
            )),
            (None, true) => Ok(Trust::Insecure),
            (None, false) => Ok(Trust::Unsaid),
            (Some(path), false) if path == Path::new("-") => {
                Ok(Trust::Bundle(Bundle::from_standard_input().or_usage()?))
            }
            (Some(path), false) => Ok(Trust::Bundle(Bundle::read(path).or_usage()?)),
        }
    }

    /// How connections are protected.
    pub(crate) fn exposure(&self) -> Result<Exposure, Usage> {
        match self.trust()? {
            Trust::Bundle(bundle) => Ok(Exposure::Cluster(Cluster::new(&bundle).or_usage()?)),
            Trust::Unsaid => Ok(Exposure::Loopback),
            Trust::Insecure => {
                tracing::warn!(
                    "--insecure: connections are neither encrypted nor authenticated; anybody \
                     on the network may see and change everything"
                );
                Ok(Exposure::Insecure)
            }
        }
    }
}

/// Where a process hands out metrics.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Monitoring")]
pub(crate) struct Monitoring {
    /// Hand out metrics for Prometheus at http://ADDR/metrics. A port alone is one of this machine,
    /// for this machine; whoever can reach any other address can read them.
    #[arg(long, value_parser = metrics_address, env = "LIE_METRICS", value_name = "ADDR")]
    metrics: Option<String>,
}

impl Monitoring {
    /// Listens for who wants metrics, if that is asked for. They hold no secrets, so that an address
    /// that was named is reason enough.
    pub(crate) fn listen(&self, runtime: &Runtime) -> anyhow::Result<Option<TcpListener>> {
        let listen = |address: &String| listen(runtime, address, &Exposure::Insecure);
        self.metrics.as_ref().map(listen).transpose()
    }
}

/// How a process is ended.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Supervision {
    /// End when standard input ends.
    #[arg(long, hide = true)]
    supervised: bool,
}

/// Parses `host:port`.
pub(crate) fn address(text: &str) -> Result<String, String> {
    let expected = "expected HOST:PORT, such as 127.0.0.1:7400 or [::1]:7400";
    let (host, port) = text.rsplit_once(':').ok_or(expected)?;
    let bare_v6 = host.contains(':') && !(host.starts_with('[') && host.ends_with(']'));
    if host.is_empty() || bare_v6 || port.parse::<u16>().is_err() {
        return Err(expected.to_owned());
    }
    Ok(text.to_owned())
}

/// Parses `host:port`, or `mdns` and `mdns:NAME` for a constructor that says where it is.
pub(crate) fn constructor_address(text: &str) -> Result<String, String> {
    match Wanted::parse(text) {
        Some(wanted) => wanted.map_err(|error| error.to_string())?,
        None => {
            return address(text).map_err(|expected| format!("{expected}, or mdns, or mdns:NAME"));
        }
    };
    Ok(text.to_owned())
}

/// Parses `port` or `host:port`.
fn metrics_address(text: &str) -> Result<String, String> {
    match text.parse::<u16>() {
        Ok(port) => Ok(format!("127.0.0.1:{port}")),
        Err(_) => address(text)
            .map_err(|_| "expected PORT or HOST:PORT, such as 9464 or 127.0.0.1:9464".to_owned()),
    }
}

/// The threads that wait for the network; rendering and construction have their own.
pub(crate) fn runtime() -> anyhow::Result<Runtime> {
    Ok(tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .thread_name("network")
        .enable_all()
        .build()?)
}

/// Which errors are the user's to mend.
pub(crate) fn network_failure(error: NetworkError) -> anyhow::Error {
    match error {
        NetworkError::Address { .. } | NetworkError::NotLoopback(_) => usage(error).into(),
        NetworkError::Discovery(error) => discovery_failure(error),
        other => other.into(),
    }
}

/// The same where a constructor is announced or looked for.
pub(crate) fn discovery_failure(error: DiscoveryError) -> anyhow::Error {
    match error {
        DiscoveryError::Nobody(_) | DiscoveryError::Failed(_) => error.into(),
        other => usage(other).into(),
    }
}

/// The same of a client's errors.
pub(crate) fn client_failure(error: ClientError) -> anyhow::Error {
    match error {
        ClientError::Network(error) => network_failure(error),
        other => other.into(),
    }
}

/// Listens, or says why not.
pub(crate) fn listen(
    runtime: &Runtime,
    address: &str,
    exposure: &Exposure,
) -> anyhow::Result<TcpListener> {
    let bound = runtime.block_on(lie_farm::network::bind(address, exposure));
    bound.map_err(network_failure)
}

/// Says where we listen: the only line on standard output.
pub(crate) fn announce(listener: &TcpListener) -> anyhow::Result<()> {
    let announcement = lie_farm::launch::ANNOUNCEMENT;
    say(format_args!("{announcement}{}", listener.local_addr()?))?;
    Ok(std::io::stdout().flush()?)
}

/// A token that is cancelled when the process shall end: by an interrupt, a termination
/// signal, or, for a supervised child, the end of standard input. A process under supervision
/// is cut off if its end takes longer than the patience that there is for it when it begins.
pub(crate) fn shutdown(
    runtime: &Runtime,
    supervision: Option<Supervision>,
    patience: impl Fn() -> Duration + Send + 'static,
) -> CancellationToken {
    let token = CancellationToken::new();
    let signalled = token.clone();
    runtime.spawn(async move {
        if wait_for_signal().await {
            signalled.cancel();
        }
    });
    if let Some(supervision) = supervision {
        if supervision.supervised {
            let ended = token.clone();
            std::thread::spawn(move || {
                wait_for_the_end_of_input();
                ended.cancel();
            });
        }
        let cancelled = token.clone();
        runtime.spawn(async move {
            cancelled.cancelled().await;
            tokio::time::sleep(patience()).await;
            tracing::warn!("the process did not end in time and is cut off");
            std::process::exit(0);
        });
    }
    token
}

async fn wait_for_signal() -> bool {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let Ok(mut terminate) = signal(SignalKind::terminate()) else {
            return tokio::signal::ctrl_c().await.is_ok();
        };
        tokio::select! {
            interrupted = tokio::signal::ctrl_c() => interrupted.is_ok(),
            _ = terminate.recv() => true,
        }
    }
    #[cfg(not(unix))]
    tokio::signal::ctrl_c().await.is_ok()
}

fn wait_for_the_end_of_input() {
    let mut buffer = [0; 64];
    // Whatever comes is ignored; an error is an end as well.
    while matches!(std::io::stdin().read(&mut buffer), Ok(bytes) if bytes > 0) {}
}

/// As many threads as there are cores.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Threads for rendering or construction; 0 is one for each core.
pub(crate) fn threads(wanted: usize) -> Result<usize, Usage> {
    /// More than any machine has.
    const MOST: usize = 1024;
    match wanted {
        0 => Ok(cores()),
        1..=MOST => Ok(wanted),
        _ => Err(usage(format!("{wanted} threads are more than {MOST}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_a_host_and_a_port() {
        for right in ["127.0.0.1:7400", "node-1:0", "[::1]:65535"] {
            assert_eq!(address(right).as_deref(), Ok(right));
        }
        for wrong in ["", "7400", ":7400", "host:", "host:99999", "::1:7400"] {
            assert!(address(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn constructors_may_be_found_by_name() {
        for right in ["mdns", "mdns:stage", "127.0.0.1:7400", "mdns.:7400"] {
            assert_eq!(constructor_address(right).as_deref(), Ok(right));
        }
        for (wrong, piece) in [
            ("mdns:a b", "letters"),
            ("mdns:", "letters"),
            ("node", "mdns:NAME"),
        ] {
            assert!(
                constructor_address(wrong).unwrap_err().contains(piece),
                "{wrong}"
            );
        }
    }

    #[test]
    fn metrics_are_for_this_machine_unless_an_address_is_named() {
        let local = Ok("127.0.0.1:9464".to_owned());
        assert_eq!(metrics_address("9464"), local);
        assert_eq!(metrics_address("0.0.0.0:1"), Ok("0.0.0.0:1".to_owned()));
        for wrong in ["", ":9464", "99999", "host", "-1"] {
            assert!(metrics_address(wrong).is_err(), "{wrong}");
        }
    }
}
