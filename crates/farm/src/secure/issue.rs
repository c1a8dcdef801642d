//! Making a new cluster.

use rcgen::{
    BasicConstraints, CertificateParams, DistinguishedName, DnType, ExtendedKeyUsagePurpose, IsCa,
    Issuer, KeyPair, KeyUsagePurpose,
};
use ring::digest::{SHA256, digest};
use rustls::pki_types::PrivatePkcs8KeyDer;
use time::{Duration, OffsetDateTime};

use super::{Bundle, NODE_NAME, Validity};

/// Longest time for which a bundle is made, in days.
pub const MAX_DAYS: u32 = 3650;
/// Clocks of a cluster may differ by so much.
const CLOCK_SKEW: Duration = Duration::hours(1);

/// A bundle could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IssueError {
    /// Not a time for which bundles are made.
    #[error("a bundle holds for 1 to {MAX_DAYS} days, not {0}")]
    Days(u32),
    /// Keys or certificates could not be made.
    #[error("cannot make keys and certificates: {0}")]
    Keys(#[from] rcgen::Error),
}

impl Bundle {
    /// Makes a cluster: an authority, and the certificate of its nodes. The authority's private key is
    /// gone when this returns, so that nobody can ever issue another.
    ///
    /// # Errors
    /// [`IssueError`].
    pub fn issue(days: u32) -> Result<Self, IssueError> {
        if !(1..=MAX_DAYS).contains(&days) {
            return Err(IssueError::Days(days));
        }
        let now = OffsetDateTime::now_utc();
        let until = now + Duration::days(i64::from(days));
        let authority_key = KeyPair::generate()?;
        // A name of its own, so that a node of another cluster is told at once from a forgery.
        let id = digest(&SHA256, authority_key.public_key_raw());
        let id: String = id.as_ref()[..8]
            .iter()
            .map(|b| format!("{b:02x}"))
            .collect();

        let mut authority = named(&format!("lie cluster {id}"), vec![])?;
        authority.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
        authority.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
        let mut node = named(&format!("lie node {id}"), vec![NODE_NAME.to_owned()])?;
        node.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        node.extended_key_usages = vec![
            ExtendedKeyUsagePurpose::ServerAuth,
            ExtendedKeyUsagePurpose::ClientAuth,
        ];
        for certificate in [&mut authority, &mut node] {
            certificate.not_before = now - CLOCK_SKEW;
            certificate.not_after = until;
        }

        let node_key = KeyPair::generate()?;
        let authority_certificate = authority.self_signed(&authority_key)?;
        let issuer = Issuer::new(authority, authority_key);
        let node_certificate = node.signed_by(&node_key, &issuer)?;
        Ok(Self {
            origin: "that was just made".to_owned(),
            validity: Validity {
                not_before: node.not_before.unix_timestamp(),
                not_after: node.not_after.unix_timestamp(),
            },
            node: node_certificate.der().clone(),
            key: PrivatePkcs8KeyDer::from(node_key.serialize_der()).into(),
            authorities: vec![authority_certificate.der().clone()],
        })
    }
}

fn named(name: &str, hosts: Vec<String>) -> Result<CertificateParams, rcgen::Error> {
    let mut params = CertificateParams::new(hosts)?;
    params.distinguished_name = DistinguishedName::new();
    params.distinguished_name.push(DnType::CommonName, name);
    params.use_authority_key_identifier_extension = true;
    Ok(params)
}
