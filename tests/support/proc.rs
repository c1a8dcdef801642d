//! What a process uses, as the system counts it.

/// Bytes of memory that are resident.
pub(crate) fn memory(id: u32) -> u64 {
    let kib = status(id, "VmRSS:").expect("it runs");
    1024 * kib
        .trim_end_matches(" kB")
        .parse::<u64>()
        .expect("a number")
}

/// Whether it takes SIGTERM into its own hands.
pub(crate) fn minds_its_end(id: u32) -> bool {
    const SIGTERM: u32 = 15;
    let caught = status(id, "SigCgt:").and_then(|mask| u64::from_str_radix(&mask, 16).ok());
    caught.is_some_and(|mask| mask >> (SIGTERM - 1) & 1 == 1)
}

fn status(id: u32, key: &str) -> Option<String> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let value = status.lines().find_map(|line| line.strip_prefix(key));
    value.map(|value| value.trim().to_owned())
}

/// Open files and sockets.
pub(crate) fn descriptors(id: u32) -> usize {
    let folder = std::fs::read_dir(format!("/proc/{id}/fd"));
    folder.expect("it runs").count()
}

/// For people.
pub(crate) fn mib(bytes: u64) -> f64 {
    bytes as f64 / (1024.0 * 1024.0)
}
