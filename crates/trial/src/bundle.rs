//! Key bundles.

use lie_farm::secure::{Bundle, Cluster};

use crate::{Form, Memory, Target};

pub(crate) const TARGET: Target = Target {
    name: "bundle",
    seeds,
    open: || Box::new(run),
    memory: Memory {
        fixed: 1 << 20,
        for_each: 32,
    },
    form: Form::Text,
};

/// Bundles of new clusters: one as it is issued, and one that trusts another.
fn seeds() -> Vec<Vec<u8>> {
    let [one, other, third] = [1, 30, 3650].map(|days| Bundle::issue(days).unwrap());
    let both = third.trusting([&other]).unwrap();
    let texts = [one, other, both].map(|bundle| bundle.to_pem());
    texts.map(String::into_bytes).into()
}

fn run(bytes: &[u8]) -> bool {
    let read = Bundle::parse(bytes, "a trial");
    let received = Bundle::receive(bytes, "a trial");
    if let Ok(bundle) = &read {
        let again = Bundle::parse(bundle.to_pem().as_bytes(), "again").unwrap();
        assert_eq!(again.fingerprint(), bundle.fingerprint());
        assert_eq!(again.trusted().count(), bundle.trusted().count());
        let _ = (bundle.validity().to_string(), Cluster::new(bundle));
    }
    let is_taken = read.is_ok();
    for error in [read.err(), received.err()].into_iter().flatten() {
        assert!(error.to_string().contains("a trial"), "{error}");
    }
    is_taken
}
