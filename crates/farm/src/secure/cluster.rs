//! Mutual TLS 1.3 between the nodes of a cluster.

use std::{io, sync::Arc};

use rustls::{
    CertificateError, ClientConfig, Error, RootCertStore, ServerConfig,
    client::{
        Resumption, WebPkiServerVerifier,
        danger::{ServerCertVerified, ServerCertVerifier},
    },
    crypto::{CryptoProvider, ring},
    pki_types::{ServerName, UnixTime},
    server::{NoServerSessionStorage, WebPkiClientVerifier},
    version::TLS13,
};
use tokio::net::TcpStream;
use tokio_rustls::{TlsAcceptor, TlsConnector};

use super::{Bundle, BundleError, Flaw, HandshakeFailure, NODE_NAME, Stream};

/// A bundle ready for use: makes connections of which both sides know that the other belongs
/// to the cluster.
///
/// TLS 1.3 alone. Every connection is a full handshake: there are no tickets, so that a
/// certificate is looked at each time, and no early data.
#[derive(Clone)]
pub struct Cluster {
    acceptor: TlsAcceptor,
    connector: TlsConnector,
    name: ServerName<'static>,
}

impl Cluster {
    /// Makes a bundle ready, if it is good now: its certificate was issued by one of its
    /// authorities, holds at this time, and has this key.
    ///
    /// # Errors
    /// [`BundleError::Flaw`].
    pub fn new(bundle: &Bundle) -> Result<Self, BundleError> {
        Self::at(bundle, UnixTime::now()).map_err(|flaw| flaw.at(&bundle.origin))
    }

    /// The same at another time.
    pub(super) fn at(bundle: &Bundle, now: UnixTime) -> Result<Self, Flaw> {
        let provider = Arc::new(ring::default_provider());
        let name = ServerName::try_from(NODE_NAME).map_err(|e| Flaw::Purpose(e.to_string()))?;
        let mut authorities = RootCertStore::empty();
        for authority in &bundle.authorities {
            let added = authorities.add(authority.clone());
            added.map_err(|error| Flaw::Certificate(error.to_string()))?;
        }
        let authorities = Arc::new(authorities);
        check_ourselves(bundle, &authorities, &provider, &name, now)?;

        let verifier =
            WebPkiClientVerifier::builder_with_provider(authorities.clone(), provider.clone())
                .build()
                .map_err(|error| Flaw::Key(error.to_string()))?;
        let chain = vec![bundle.node.clone()];
        let mut server = ServerConfig::builder_with_provider(provider.clone())
            .with_protocol_versions(&[&TLS13])
            .map_err(of_key)?
            .with_client_cert_verifier(verifier)
            .with_single_cert(chain.clone(), bundle.key.clone_key())
            .map_err(of_key)?;
        server.session_storage = Arc::new(NoServerSessionStorage {});
        server.send_tls13_tickets = 0;
        let mut client = ClientConfig::builder_with_provider(provider)
            .with_protocol_versions(&[&TLS13])
            .map_err(of_key)?
            .with_root_certificates(authorities)
            .with_client_auth_cert(chain, bundle.key.clone_key())
            .map_err(of_key)?;
        client.resumption = Resumption::disabled();
        Ok(Self {
            acceptor: Arc::new(server).into(),
            connector: Arc::new(client).into(),
            name,
        })
    }

    /// Takes a peer in that has dialled. If it is not let in, it has been told, and its
    /// connection is given back.
    pub(crate) async fn accept(&self, stream: TcpStream) -> Result<Stream, (io::Error, TcpStream)> {
        let accepted = self.acceptor.accept(stream).into_fallible().await?;
        Ok(Stream::Tls(Box::new(accepted.into())))
    }

    /// Dials a peer. Whether it takes us is only known when it first answers.
    pub(crate) async fn connect(&self, stream: TcpStream) -> io::Result<Stream> {
        let connected = self.connector.connect(self.name.clone(), stream).await?;
        Ok(Stream::Tls(Box::new(connected.into())))
    }
}

impl std::fmt::Debug for Cluster {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Cluster").finish_non_exhaustive()
    }
}

/// Whether others with the same bundle would trust us.
fn check_ourselves(
    bundle: &Bundle,
    authorities: &Arc<RootCertStore>,
    provider: &Arc<CryptoProvider>,
    name: &ServerName<'_>,
    now: UnixTime,
) -> Result<ServerCertVerified, Flaw> {
    let verifier =
        WebPkiServerVerifier::builder_with_provider(authorities.clone(), provider.clone())
            .build()
            .map_err(|error| Flaw::Key(error.to_string()))?;
    let verified = verifier.verify_server_cert(&bundle.node, &[], name, &[], now);
    verified.map_err(|error| {
        let Error::InvalidCertificate(cause) = &error else {
            return Flaw::Purpose(error.to_string());
        };
        match (HandshakeFailure::of_certificate(cause), cause) {
            (HandshakeFailure::Expired, _) => Flaw::Expired(bundle.validity().not_after),
            (HandshakeFailure::NotYetValid, _) => Flaw::NotYetValid(bundle.validity().not_before),
            (HandshakeFailure::ForeignCluster, _) => Flaw::Unissued,
            (_, CertificateError::NotValidForNameContext { presented, .. }) => {
                Flaw::Purpose(format!("its names are {presented:?}"))
            }
            (_, other) => Flaw::Purpose(other.to_string()),
        }
    })
}

fn of_key(error: Error) -> Flaw {
    match error {
        Error::InconsistentKeys(_) => Flaw::KeyMismatch,
        other => Flaw::Key(other.to_string()),
    }
}
