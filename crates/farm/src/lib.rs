//! The processes of the renderer and what they share.

pub mod cache;
pub mod client;
pub mod connection;
mod construct;
pub mod constructor;
pub mod convert;
pub mod handshake;
pub mod launch;
pub mod network;
pub mod outbox;
pub mod pixels;
mod replica;
pub mod scene_blob;
pub mod scheduler;
mod serve;
pub mod shader;
pub mod walk;

pub use construct::{BatchReport, Builder, ConstructSettings, View};
pub use replica::{LieReplica, PublishedLies, ReplicaError};
