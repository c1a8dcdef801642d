//! Bundles as `lie key new` never makes them.

use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
};
use time::{Duration, OffsetDateTime};

/// Somebody who can issue certificates for a cluster.
pub(crate) struct Authority {
    pem: String,
    issuer: Issuer<'static, KeyPair>,
}

impl Authority {
    pub(crate) fn new() -> Self {
        let key = KeyPair::generate().unwrap();
        let mut params = CertificateParams::new(vec![]).unwrap();
        let name = format!("authority {:02x?}", &key.public_key_raw()[1..9]);
        params.distinguished_name.push(DnType::CommonName, name);
        params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
        let pem = params.self_signed(&key).unwrap().pem();
        Self {
            pem,
            issuer: Issuer::new(params, key),
        }
    }

    /// A bundle that holds from and until so many seconds from now.
    pub(crate) fn node(&self, from_s: i64, until_s: i64) -> String {
        let now = OffsetDateTime::now_utc();
        let mut params = CertificateParams::new(vec![lie_farm::secure::NODE_NAME.into()]).unwrap();
        params.not_before = now + Duration::seconds(from_s);
        params.not_after = now + Duration::seconds(until_s);
        params.extended_key_usages = vec![
            ExtendedKeyUsagePurpose::ServerAuth,
            ExtendedKeyUsagePurpose::ClientAuth,
        ];
        let key = KeyPair::generate().unwrap();
        let node = params.signed_by(&key, &self.issuer).unwrap();
        [node.pem(), key.serialize_pem(), self.pem.clone()].concat()
    }

    /// A bundle that trusts another cluster too, without being trusted there.
    pub(crate) fn node_trusting(&self, other: &Self) -> String {
        self.node(-10, 1000) + &other.pem
    }
}
