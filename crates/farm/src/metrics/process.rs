use super::Exposition;

/// What every process says of itself.
pub(crate) fn write_process(text: &mut Exposition, role: &str) {
    let version = env!("CARGO_PKG_VERSION");
    text.gauge("lie_build_info", "Build and role of the process; always 1.")
        .count(&[("version", version), ("role", role)], 1);
}

/// Bytes to and from peers of each kind: peer, sent, received.
pub(crate) fn write_bytes(text: &mut Exposition, peers: &[(&str, u64, u64)]) {
    let mut sent = text.counter(
        "lie_sent_bytes_total",
        "Bytes sent to processes of the farm, by what they are.",
    );
    for &(peer, bytes, _) in peers {
        sent.count(&[("peer", peer)], bytes);
    }
    let mut received = text.counter(
        "lie_received_bytes_total",
        "Bytes received from processes of the farm, by what they are.",
    );
    for &(peer, _, bytes) in peers {
        received.count(&[("peer", peer)], bytes);
    }
}

/// What audits have found.
pub(crate) fn write_audits(text: &mut Exposition, rays: u64, wrong: u64) {
    text.counter(
        "lie_audit_rays_total",
        "Shadow rays traced to check answers of the LIEs.",
    )
    .count(&[], rays);
    text.counter(
        "lie_audit_wrong_total",
        "Answers of the LIEs that were wrong.",
    )
    .count(&[], wrong);
}
