//! Why a peer is not one of the cluster, or we are not one of its.

use std::io;

use rustls::{AlertDescription, CertificateError, Error};

/// Why there is no secure connection. "It" is the peer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum HandshakeFailure {
    /// No authority of ours issued its certificate, or it has not the key.
    #[error("it belongs to another cluster: no authority of our bundle issued its certificate")]
    ForeignCluster,
    /// Its certificate was good once.
    #[error("its certificate has expired; it needs a new bundle")]
    Expired,
    /// Its certificate will be good.
    #[error("its certificate is not valid yet; is a clock wrong?")]
    NotYetValid,
    /// It did not say who it is.
    #[error("it showed no certificate; it needs the bundle of this cluster")]
    NoCertificate,
    /// A certificate of ours, but for something else.
    #[error("its certificate is not that of a node: {0}")]
    Certificate(String),
    /// It does not trust us.
    #[error("it does not accept our certificate: it belongs to another cluster")]
    WeAreForeign,
    /// It says that our time is over.
    #[error("it says that our certificate has expired or is not valid yet")]
    WeExpired,
    /// What it sent belongs to no handshake.
    #[error("it does not speak TLS: it runs without a bundle, or is no process of lie")]
    NotTls,
    /// It began with our own protocol where TLS is asked for.
    #[error("it does not use TLS; it needs the bundle of this cluster")]
    Plaintext,
    /// It uses TLS, and we have no bundle.
    #[error("it uses TLS, and this process has no bundle (--bundle FILE)")]
    UnexpectedTls,
    /// Neither TLS nor our protocol.
    #[error("it speaks neither TLS nor lie's protocol")]
    Garbage,
    /// It cannot do TLS 1.3 as we do it.
    #[error("it does not speak TLS 1.3 as this process does: {0}")]
    Incompatible(String),
    /// Anything else.
    #[error("TLS failed: {0}")]
    Other(String),
}

impl HandshakeFailure {
    /// What TLS has to say about an error of a stream, if it is to blame.
    #[must_use]
    pub fn of(error: &io::Error) -> Option<Self> {
        let error = error.get_ref()?.downcast_ref::<Error>()?;
        Some(match error {
            Error::InvalidCertificate(cause) => Self::of_certificate(cause),
            Error::NoCertificatesPresented => Self::NoCertificate,
            Error::AlertReceived(alert) => of_alert(*alert),
            Error::InvalidMessage(_) => Self::NotTls,
            Error::PeerIncompatible(cause) => Self::Incompatible(format!("{cause:?}")),
            other => Self::Other(other.to_string()),
        })
    }

    /// Why a certificate is not accepted.
    pub(super) fn of_certificate(error: &CertificateError) -> Self {
        use CertificateError as Cause;
        match error {
            Cause::Expired | Cause::ExpiredContext { .. } => Self::Expired,
            Cause::NotValidYet | Cause::NotValidYetContext { .. } => Self::NotYetValid,
            Cause::UnknownIssuer | Cause::BadSignature => Self::ForeignCluster,
            other => Self::Certificate(other.to_string()),
        }
    }
}

fn of_alert(alert: AlertDescription) -> HandshakeFailure {
    use AlertDescription as Alert;
    match alert {
        Alert::UnknownCA | Alert::DecryptError | Alert::BadCertificate | Alert::AccessDenied => {
            HandshakeFailure::WeAreForeign
        }
        Alert::CertificateExpired => HandshakeFailure::WeExpired,
        Alert::ProtocolVersion => HandshakeFailure::Incompatible("it says so".to_owned()),
        other => HandshakeFailure::Other(format!("it refuses us with the alert {other:?}")),
    }
}
