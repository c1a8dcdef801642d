//! The `lie` executable.
fn main() {}
