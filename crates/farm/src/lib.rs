//! The processes of a farm.
pub mod cache;
pub mod connection;
pub mod convert;
pub mod handshake;
pub mod network;
pub mod outbox;
pub mod pixels;
pub mod scene_blob;
pub mod scheduler;
#[allow(missing_docs, clippy::all, unreachable_pub, dead_code, clippy::unwrap_used)]
mod standin;
