//! Numbers for monitoring: what counts them (`number`), how they are written for Prometheus
//! (`exposition`), and who hands them out (`http`).
//!
//! Counting is atomic and takes no lock: the threads that render do it once for each tile.

mod exposition;
mod http;
mod number;
mod process;

pub(crate) use exposition::Exposition;
pub(crate) use http::serve;
pub(crate) use number::{Counter, Gauge, Histogram};
pub(crate) use process::{write_audits, write_bytes, write_process};
