//! How a farm is.

mod json;
mod table;
mod words;

use std::{
    io::{ErrorKind, IsTerminal, Write},
    ops::ControlFlow,
    time::Duration,
};

use clap::Args;
use lie_farm::{
    network::Exposure,
    status::{self, StatusError},
};
use lie_protocol::FarmStatus;

use crate::process::{self, Network};

/// Shows a running farm: its constructor, its shaders and its clients.
///
/// Asks the constructor, which disturbs nobody. What shaders and clients have done is what they say of
/// themselves.
#[derive(Args)]
pub(crate) struct Status {
    /// Where the constructor listens: HOST:PORT; or `mdns:NAME`, or `mdns` for the only one, to find
    /// one on the local network that was started with `--announce`.
    #[arg(long, value_parser = process::constructor_address, env = "LIE_CONSTRUCTOR", value_name = "ADDR")]
    constructor: String,
    /// Ask again every so many seconds, until interrupted.
    #[arg(long, num_args = 0..=1, default_missing_value = "1", value_parser = interval, value_name = "SECONDS")]
    watch: Option<Duration>,
    /// Print JSON instead of tables; with `--watch`, one object on each line.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    network: Network,
}

/// Parses the time between two questions.
fn interval(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok();
    let possible = seconds.filter(|seconds| (0.1..=3600.0).contains(seconds));
    possible
        .map(Duration::from_secs_f64)
        .ok_or_else(|| "expected seconds from 0.1 to 3600".to_owned())
}

pub(crate) fn execute(arguments: &Status) -> anyhow::Result<()> {
    let exposure = arguments.network.exposure()?;
    let runtime = process::runtime()?;
    let result = match arguments.watch {
        None => runtime.block_on(async {
            let status = ask(arguments, &exposure).await?;
            show(arguments, &status, false).map(drop)
        }),
        Some(every) => {
            let shutdown = process::shutdown(&runtime, None, || process::PATIENCE);
            runtime.block_on(async {
                tokio::select! {
                    watched = watch(arguments, &exposure, every) => watched,
                    () = shutdown.cancelled() => Ok(()),
                }
            })
        }
    };
    runtime.shutdown_background();
    result
}

async fn ask(arguments: &Status, exposure: &Exposure) -> anyhow::Result<FarmStatus> {
    let asked = status::ask(&arguments.constructor, exposure).await;
    asked.map_err(|error| match error {
        StatusError::Network(error) => process::network_failure(error),
        other => other.into(),
    })
}

/// Asks for as long as somebody reads. A constructor that goes may come back; one that was never there is an error.
async fn watch(arguments: &Status, exposure: &Exposure, every: Duration) -> anyhow::Result<()> {
    let mut ticks = tokio::time::interval(every);
    ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    let redraws = !arguments.json && std::io::stdout().is_terminal();
    let mut was_there = false;
    loop {
        ticks.tick().await;
        match ask(arguments, exposure).await {
            Ok(status) => {
                was_there = true;
                if show(arguments, &status, redraws)?.is_break() {
                    return Ok(());
                }
            }
            Err(error) if was_there => tracing::warn!("{error:#}"),
            Err(error) => return Err(error),
        }
    }
}

/// Prints a status. Breaks off where nobody reads any more.
fn show(arguments: &Status, status: &FarmStatus, redraws: bool) -> anyhow::Result<ControlFlow<()>> {
    let mut out = std::io::stdout();
    let written = if arguments.json {
        let value = json::of(&arguments.constructor, status);
        match arguments.watch {
            Some(_) => writeln!(out, "{value}"),
            None => writeln!(out, "{value:#}"),
        }
    } else {
        let text = table::of(&arguments.constructor, status);
        if redraws {
            // To the upper left; what was there is cleared line by line, so that nothing flickers.
            let lines = text.replace('\n', "\x1b[K\n");
            writeln!(out, "\x1b[H{lines}\x1b[J")
        } else {
            let gap = if arguments.watch.is_some() { "\n" } else { "" };
            writeln!(out, "{}{gap}", text.trim_end())
        }
    };
    match written.and_then(|()| out.flush()) {
        Ok(()) => Ok(ControlFlow::Continue(())),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(ControlFlow::Break(())),
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_seconds() {
        assert_eq!(interval("0.5"), Ok(Duration::from_millis(500)));
        for wrong in ["", "0", "-1", "NaN", "inf", "4000", "1s"] {
            assert!(interval(wrong).is_err(), "{wrong}");
        }
    }
}
