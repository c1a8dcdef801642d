//! Finding a constructor on a local network by multicast DNS (RFC 6762 and 6763).
//!
//! Whoever is on the network may answer whatever it likes. What is found is an address to try, and no
//! more: who is talked to is decided where it always is, by TLS, once there is a connection.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    net::{IpAddr, SocketAddr, SocketAddrV6},
    thread,
    time::Duration,
};

use lie_protocol::Text;
use mdns_sd::{
    DaemonEvent, IfKind, ResolvedService, ScopedIp, ServiceDaemon, ServiceEvent, ServiceInfo,
};
use tokio::time::{Instant, timeout_at};

use crate::exposure::Exposure;

/// What constructors are announced as.
const SERVICE: &str = "_lie._tcp.local.";
/// What stands for an address, alone or before a colon and a name.
const SCHEME: &str = "mdns";
/// How long an answer is waited for; a question that is lost is asked again after a second.
const PATIENCE: Duration = Duration::from_secs(4);
/// After the first answer, how long other constructors are waited for. Who has just answered somebody else does not
/// do so again for a second (RFC 6762 §6), so that only a second question finds all.
const OTHERS: Duration = Duration::from_millis(1500);
/// The same for other addresses of a constructor that was asked for by name.
const OTHER_ADDRESSES: Duration = Duration::from_millis(200);
/// How long a farewell may take.
const FAREWELL: Duration = Duration::from_millis(200);
/// Most constructors that are told apart, and most addresses of one that are tried.
const MOST: usize = 8;

/// Why a constructor cannot be announced or found.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DiscoveryError {
    /// Nothing protects the connection that would be made.
    #[error(
        "finding processes on the network, and being found, needs a cluster's bundle: make one with \
         `lie key new` and name it with --bundle, or, where everybody on the network may see and \
         change everything, say --insecure"
    )]
    Unprotected,
    /// Nobody else could connect there.
    #[error(
        "{0} cannot be announced, since other machines cannot reach it: listen on another address, \
         such as --listen 0.0.0.0:{port}", port = .0.port()
    )]
    Loopback(SocketAddr),
    /// It would be mistaken for something else.
    #[error("'{0}' is no name for a constructor: 1 to 40 letters, digits, - and _ are")]
    Name(String),
    /// Multicast DNS does not work at all.
    #[error("multicast DNS does not work on this machine: {0}")]
    Failed(String),
    /// Nobody has answered.
    #[error(
        "no constructor{} was found on the network within {} s: is it there, with --announce?",
        .0.as_ref().map(|name| format!(" called '{name}'")).unwrap_or_default(),
        PATIENCE.as_secs()
    )]
    Nobody(Option<Name>),
    /// It cannot be known which one is meant.
    #[error(
        "several constructors are on the network, choose one with {SCHEME}:NAME or by its address: {0}"
    )]
    Several(String),
}

/// What a constructor is called on the network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name(String);

impl Name {
    /// # Errors
    /// [`DiscoveryError::Name`] unless it has 1 to 40 letters, digits, - and _ of ASCII.
    pub fn new(text: &str) -> Result<Self, DiscoveryError> {
        let possible = |byte: u8| byte.is_ascii_alphanumeric() || b"-_".contains(&byte);
        if (1..=40).contains(&text.len()) && text.bytes().all(possible) {
            Ok(Self(text.to_owned()))
        } else {
            Err(DiscoveryError::Name(Text::new(text).as_str().to_owned()))
        }
    }

    /// The name of this machine up to its first dot, or `lie` if that is none of ours.
    #[must_use]
    pub fn of_this_machine() -> Self {
        #[cfg(unix)]
        let host = {
            let system = rustix::system::uname();
            system.nodename().to_string_lossy().into_owned()
        };
        #[cfg(not(unix))]
        let host = std::env::var("COMPUTERNAME").unwrap_or_default();
        let first = host.split('.').next().unwrap_or_default();
        Self::new(first).unwrap_or_else(|_| Self("lie".to_owned()))
    }
}

impl fmt::Display for Name {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

/// Which constructor is looked for: one of a name, or the only one there is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted(Option<Name>);

impl Wanted {
    /// What `mdns` or `mdns:NAME` asks for; `None` for what is an address.
    ///
    /// # Errors
    /// [`DiscoveryError::Name`].
    pub fn parse(address: &str) -> Option<Result<Self, DiscoveryError>> {
        match address.strip_prefix(SCHEME)? {
            "" => Some(Ok(Self(None))),
            rest => Some(Name::new(rest.strip_prefix(':')?).map(|name| Self(Some(name)))),
        }
    }

    fn is(&self, name: &str) -> bool {
        // Names of DNS have no case.
        let wanted = self.0.as_ref();
        wanted.is_none_or(|wanted| wanted.0.eq_ignore_ascii_case(name))
    }
}

/// What is to be announced of a constructor.
pub struct Announcement(ServiceInfo);

impl Announcement {
    /// Of a process that listens at this address.
    ///
    /// # Errors
    /// [`DiscoveryError`] where nobody could connect, or nothing would protect those who do.
    pub fn new(name: &Name, at: SocketAddr, exposure: &Exposure) -> Result<Self, DiscoveryError> {
        check(exposure)?;
        let ip = at.ip().to_canonical();
        if ip.is_loopback() {
            return Err(DiscoveryError::Loopback(at));
        }
        let host = format!("lie-{name}.local.");
        let no_text = &[][..] as &[(&str, &str)];
        let mut service = if ip.is_unspecified() {
            ServiceInfo::new(SERVICE, &name.0, &host, (), at.port(), no_text)
                .map(ServiceInfo::enable_addr_auto)
        } else {
            ServiceInfo::new(SERVICE, &name.0, &host, ip, at.port(), no_text)
        }
        .map_err(failed)?;
        service.set_interfaces(vec![match ip {
            IpAddr::V4(ip) if ip.is_unspecified() => IfKind::IPv4,
            IpAddr::V6(ip) if ip.is_unspecified() => IfKind::All,
            ip => IfKind::Addr(ip),
        }]);
        Ok(Self(service))
    }

    /// Announces it from now on. What becomes of that is logged.
    ///
    /// # Errors
    /// [`DiscoveryError::Failed`].
    pub fn start(self) -> Result<Announced, DiscoveryError> {
        let daemon = Daemon::start()?;
        daemon.log()?;
        let service = self.0.get_fullname().to_owned();
        daemon.0.register(self.0).map_err(failed)?;
        Ok(Announced { daemon, service })
    }
}

/// A constructor that others can find, for as long as this lives.
pub struct Announced {
    daemon: Daemon,
    service: String,
}

impl Drop for Announced {
    fn drop(&mut self) {
        // Who does not hear the farewell finds nobody there.
        if let Ok(left) = self.daemon.0.unregister(&self.service) {
            let _ = left.recv_timeout(FAREWELL);
        }
    }
}

/// Where the constructor that is looked for says it is: at least one address, the likeliest first.
///
/// # Errors
/// [`DiscoveryError`], [`DiscoveryError::Nobody`] after some seconds.
pub async fn find(wanted: &Wanted, exposure: &Exposure) -> Result<Vec<SocketAddr>, DiscoveryError> {
    check(exposure)?;
    let daemon = Daemon::start()?;
    let events = daemon.0.browse(SERVICE).map_err(failed)?;
    let mut found = BTreeMap::<String, BTreeSet<SocketAddr>>::new();
    let mut deadline = Instant::now() + PATIENCE;
    let more = wanted.0.as_ref().map_or(OTHERS, |_| OTHER_ADDRESSES);
    while let Ok(event) = timeout_at(deadline, events.recv_async()).await {
        match event.map_err(failed)? {
            ServiceEvent::ServiceResolved(service) => {
                let name = name_of(&service.fullname);
                let addresses = addresses(&service);
                let has_room = found.len() < MOST || found.contains_key(&name);
                if wanted.is(&name) && has_room && !addresses.is_empty() {
                    deadline = deadline.min(Instant::now() + more);
                    found.entry(name).or_default().extend(addresses);
                }
            }
            ServiceEvent::ServiceRemoved(_, service) => {
                found.remove(&name_of(&service));
            }
            _ => {}
        }
    }
    match found.len() {
        0 => Err(DiscoveryError::Nobody(wanted.0.clone())),
        1 => Ok(found.into_values().flatten().take(MOST).collect()),
        _ => Err(DiscoveryError::Several(list(&found))),
    }
}

/// Without protection a process talks to its own machine alone, where nobody has to be found.
fn check(exposure: &Exposure) -> Result<(), DiscoveryError> {
    match exposure {
        Exposure::Loopback => Err(DiscoveryError::Unprotected),
        Exposure::Insecure | Exposure::Cluster(_) => Ok(()),
    }
}

/// For people, on one line.
fn list(found: &BTreeMap<String, BTreeSet<SocketAddr>>) -> String {
    let one = |(name, addresses): (&String, &BTreeSet<SocketAddr>)| {
        let first = addresses.first().map(SocketAddr::to_string);
        format!("'{name}' at {}", first.unwrap_or_default())
    };
    found.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// The first part of a service's name, as it may be shown.
fn name_of(service: &str) -> String {
    let name = service.strip_suffix(SERVICE).unwrap_or(service);
    Text::new(name.trim_end_matches('.')).as_str().to_owned()
}

/// Where a service can be dialled from here; those of this machine alone are not ours to dial.
fn addresses(service: &ResolvedService) -> Vec<SocketAddr> {
    let dialled = service.addresses.iter().filter_map(|address| {
        let ip = address.to_ip_addr();
        let is_possible = !(ip.is_loopback() || ip.is_multicast() || ip.is_unspecified());
        let at = match address {
            ScopedIp::V6(scoped) => {
                let scope = scoped.scope_id().index;
                SocketAddrV6::new(*scoped.addr(), service.port, 0, scope).into()
            }
            _ => SocketAddr::new(ip, service.port),
        };
        is_possible.then_some(at)
    });
    dialled.collect()
}

/// A thread that speaks multicast DNS; ends with this. It leaves loopback alone.
struct Daemon(ServiceDaemon);

impl Daemon {
    fn start() -> Result<Self, DiscoveryError> {
        let daemon = Self(ServiceDaemon::new().map_err(failed)?);
        let loopback = vec![IfKind::LoopbackV4, IfKind::LoopbackV6];
        daemon.0.disable_interface(loopback).map_err(failed)?;
        Ok(daemon)
    }

    /// Logs what it meets with, from a thread that ends with it.
    fn log(&self) -> Result<(), DiscoveryError> {
        let events = self.0.monitor().map_err(failed)?;
        let logger = thread::Builder::new().name("mdns-log".to_owned());
        let log = move || {
            while let Ok(event) = events.recv() {
                match event {
                    DaemonEvent::Announce(service, at) => {
                        tracing::info!("announced as '{}' at {at}", name_of(&service));
                    }
                    DaemonEvent::NameChange(change) => {
                        let [old, new] =
                            [&change.original, &change.new_name].map(|name| name_of(name));
                        tracing::warn!("'{old}' is taken on this network: announced as '{new}'");
                    }
                    DaemonEvent::Error(error) => tracing::warn!("multicast DNS: {error}"),
                    _ => {}
                }
            }
        };
        logger.spawn(log).map_err(failed)?;
        Ok(())
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        // If it has ended, it need not be told.
        let _ = self.0.shutdown();
    }
}

fn failed(error: impl fmt::Display) -> DiscoveryError {
    DiscoveryError::Failed(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> Wanted {
        Wanted(Some(Name(name.to_owned())))
    }

    #[test]
    fn what_is_looked_for_is_said_in_place_of_an_address() {
        assert_eq!(Wanted::parse("mdns").unwrap().unwrap(), Wanted(None));
        let stage = Wanted::parse("mdns:stage-2_b").unwrap().unwrap();
        assert_eq!(stage, named("stage-2_b"));
        assert!(stage.is("Stage-2_B") && !stage.is("stage"));
        for address in [
            "127.0.0.1:7400",
            "mdnsx:7400",
            "mdns.local:7400",
            "node:1",
            "",
        ] {
            assert!(Wanted::parse(address).is_none(), "{address}");
        }
        for wrong in ["mdns:", "mdns:a b", "mdns:a.local", "mdns:\u{1b}[2J"] {
            let error = Wanted::parse(wrong).unwrap().unwrap_err().to_string();
            assert!(error.contains("letters, digits"), "{error}");
            assert!(!error.contains('\u{1b}'), "{error}");
        }
        assert!(Name::new(&"n".repeat(40)).is_ok() && Name::new(&"n".repeat(41)).is_err());
        let Name(machine) = Name::of_this_machine();
        assert!(Name::new(&machine).is_ok());
    }

    #[test]
    fn several_are_listed_and_names_from_the_network_cannot_do_harm() {
        let at = |text: &str| BTreeSet::from([text.parse().unwrap()]);
        let evil = name_of("a\u{1b}[2J\n._lie._tcp.local.");
        assert!(!evil.contains(char::is_control));
        let found = BTreeMap::from([
            (name_of("stage._lie._tcp.local."), at("10.0.0.1:7400")),
            (evil, at("[2001:db8::1]:1")),
        ]);
        let error = DiscoveryError::Several(list(&found)).to_string();
        for piece in [
            "'stage' at 10.0.0.1:7400",
            "at [2001:db8::1]:1",
            "mdns:NAME",
        ] {
            assert!(error.contains(piece), "{error}");
        }
    }

    #[tokio::test]
    async fn nothing_is_announced_or_found_that_could_not_be_talked_to() {
        let name = Name::new("here").unwrap();
        let all: SocketAddr = "0.0.0.0:7400".parse().unwrap();
        let refused = Announcement::new(&name, all, &Exposure::Loopback)
            .err()
            .unwrap();
        assert!(refused.to_string().contains("--bundle"), "{refused}");
        let refused = find(&named("here"), &Exposure::Loopback).await.unwrap_err();
        assert!(matches!(refused, DiscoveryError::Unprotected));
        for here in ["127.0.0.1:7400", "[::1]:7400", "[::ffff:127.0.0.1]:7400"] {
            let at = here.parse().unwrap();
            let refused = Announcement::new(&name, at, &Exposure::Insecure)
                .err()
                .unwrap();
            assert!(refused.to_string().contains("0.0.0.0:7400"), "{refused}");
        }
    }
}
