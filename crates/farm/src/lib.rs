//! The processes of a farm.
pub mod cache;
pub mod convert;
pub mod scene_blob;
pub mod scheduler;
#[allow(missing_docs, clippy::all, unreachable_pub)]
mod standin;
