//! Listening and dialling, and who may be reached.

use std::{
    io,
    net::{IpAddr, SocketAddr},
};

use tokio::{
    net::{TcpListener, TcpStream, lookup_host},
    time::timeout,
};

use crate::{
    connection::HANDSHAKE_DEADLINE,
    discovery::{self, DiscoveryError, Wanted},
    secure::{HandshakeFailure, Stream},
};

pub use crate::exposure::Exposure;

/// Why an address cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkError {
    /// The address cannot be understood, or its name is unknown.
    #[error("'{address}' is not an address that can be used (host:port is expected): {cause}")]
    Address {
        /// As given.
        address: String,
        /// What the resolver says.
        cause: io::Error,
    },
    /// Listening failed.
    #[error("cannot listen on {address}: {cause}")]
    Bind {
        /// As given.
        address: String,
        /// What the system says.
        cause: io::Error,
    },
    /// Dialling failed.
    #[error("cannot reach {address}: {cause}")]
    Dial {
        /// As given.
        address: String,
        /// What the system says.
        cause: io::Error,
    },
    /// Somebody is there, with whom there is no secure connection.
    #[error("{address}: {cause}")]
    Handshake {
        /// As given.
        address: String,
        /// What is in the way.
        cause: HandshakeFailure,
    },
    /// There is no address yet.
    #[error(transparent)]
    Discovery(#[from] DiscoveryError),
    /// The address is not on this machine, and nothing allows that.
    #[error(
        "{0} is not a loopback address; without a cluster's bundle connections are neither \
         encrypted nor authenticated, so that only this machine can be talked to: make a bundle \
         with `lie key new` and name it with --bundle, or, where everybody on the network may \
         see and change everything, say --insecure"
    )]
    NotLoopback(SocketAddr),
}

/// Where a process takes connections.
#[derive(Debug)]
pub struct Ports {
    /// From other processes of the farm.
    pub farm: TcpListener,
    /// From whoever collects metrics: anybody who can reach it, by plain HTTP.
    pub metrics: Option<TcpListener>,
}

impl From<TcpListener> for Ports {
    fn from(farm: TcpListener) -> Self {
        Self {
            farm,
            metrics: None,
        }
    }
}

/// Listens on the first of an address's meanings that works.
///
/// # Errors
/// [`NetworkError`], in one line.
pub async fn bind(address: &str, exposure: &Exposure) -> Result<TcpListener, NetworkError> {
    let mut last = None;
    for resolved in resolve(address, exposure).await? {
        match TcpListener::bind(resolved).await {
            Ok(listener) => return Ok(listener),
            Err(cause) => last = Some(cause),
        }
    }
    Err(NetworkError::Bind {
        address: address.to_owned(),
        cause: last.unwrap_or_else(|| io::ErrorKind::AddrNotAvailable.into()),
    })
}

/// Connects to the first of an address's meanings that answers, each within the deadline of a
/// handshake. With a cluster the peer has then shown that it belongs to it; whether it takes us is
/// only known when it answers to the hello.
///
/// # Errors
/// [`NetworkError`], in one line.
pub async fn dial(address: &str, exposure: &Exposure) -> Result<Stream, NetworkError> {
    let resolved = resolve(address, exposure).await?;
    dial_any(address, resolved, exposure).await
}

async fn dial_any(
    address: &str,
    resolved: Vec<SocketAddr>,
    exposure: &Exposure,
) -> Result<Stream, NetworkError> {
    let mut last = None;
    for resolved in resolved {
        let connecting = timeout(HANDSHAKE_DEADLINE, connect(resolved, exposure));
        let connected = connecting.await;
        match connected.unwrap_or_else(|_| Err(io::ErrorKind::TimedOut.into())) {
            Ok(stream) => return Ok(stream),
            Err(cause) => last = Some(cause),
        }
    }
    if let Some(cause) = last.as_ref().and_then(HandshakeFailure::of) {
        return Err(NetworkError::Handshake {
            address: address.to_owned(),
            cause,
        });
    }
    Err(NetworkError::Dial {
        address: address.to_owned(),
        cause: last.unwrap_or_else(|| io::ErrorKind::AddrNotAvailable.into()),
    })
}

async fn connect(address: SocketAddr, exposure: &Exposure) -> io::Result<Stream> {
    let stream = TcpStream::connect(address).await?;
    prepare(&stream);
    match exposure {
        Exposure::Cluster(cluster) => cluster.connect(stream).await,
        Exposure::Loopback | Exposure::Insecure => Ok(Stream::Plain(stream)),
    }
}

/// Connects to a constructor, whose address may also be `mdns` or `mdns:NAME`: then whoever says on the local network
/// that it is this constructor is dialled, as if it had been named.
///
/// # Errors
/// [`NetworkError`], in one line.
pub async fn dial_constructor(address: &str, exposure: &Exposure) -> Result<Stream, NetworkError> {
    let Some(wanted) = Wanted::parse(address) else {
        return dial(address, exposure).await;
    };
    let found = discovery::find(&wanted?, exposure).await?;
    let first = found.first().map(SocketAddr::to_string);
    let label = format!("{address} ({})", first.unwrap_or_default());
    dial_any(&label, found, exposure).await
}

/// Sets what every connection wants: small messages go at once.
pub fn prepare(stream: &TcpStream) {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!("cannot send small messages at once: {error}");
    }
}

/// Whether `peer` may be talked to at all.
#[must_use]
pub fn allows(exposure: &Exposure, peer: IpAddr) -> bool {
    !matches!(exposure, Exposure::Loopback) || peer.to_canonical().is_loopback()
}

async fn resolve(address: &str, exposure: &Exposure) -> Result<Vec<SocketAddr>, NetworkError> {
    let wrong = |cause| NetworkError::Address {
        address: address.to_owned(),
        cause,
    };
    let resolved: Vec<_> = lookup_host(address).await.map_err(wrong)?.collect();
    if let Some(&outside) = resolved.iter().find(|at| !allows(exposure, at.ip())) {
        return Err(NetworkError::NotLoopback(outside));
    }
    Ok(resolved)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn errors_say_which_address_and_why() {
        let taken = bind("127.0.0.1:0", &Exposure::Loopback).await.unwrap();
        let address = taken.local_addr().unwrap().to_string();
        let in_use = bind(&address, &Exposure::Loopback).await.unwrap_err();
        assert!(
            in_use
                .to_string()
                .starts_with(&format!("cannot listen on {address}: "))
        );
        drop(taken);
        let nobody = dial(&address, &Exposure::Loopback).await.unwrap_err();
        assert!(
            nobody
                .to_string()
                .starts_with(&format!("cannot reach {address}: "))
        );
        for wrong in ["here", "127.0.0.1:99999", ""] {
            let error = dial(wrong, &Exposure::Loopback).await.unwrap_err();
            assert!(matches!(error, NetworkError::Address { .. }), "{error}");
        }
    }

    #[tokio::test]
    async fn other_machines_need_the_users_word() {
        let refused = bind("0.0.0.0:0", &Exposure::Loopback).await.unwrap_err();
        for way in ["--insecure", "--bundle", "lie key new"] {
            assert!(refused.to_string().contains(way), "{refused}");
        }
        assert!(dial("192.0.2.1:1", &Exposure::Loopback).await.is_err());
        assert!(bind("0.0.0.0:0", &Exposure::Insecure).await.is_ok());
    }
}
