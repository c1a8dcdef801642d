//! The processes of the renderer and what they share.

mod construct;
mod replica;

pub use construct::{BatchReport, Builder, ConstructSettings, View};
pub use replica::{LieReplica, PublishedLies, ReplicaError};
