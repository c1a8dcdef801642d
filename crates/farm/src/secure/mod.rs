//! Who belongs to a cluster, and connections between those who do.
//!
//! A [`Bundle`] is the file that makes a process a node of its cluster; a [`Cluster`] is the
//! same ready for use: mutual TLS 1.3 on every connection. A [`Stream`] is a connection
//! with or without it, and a [`HandshakeFailure`] says why there is none.
//!
//! Decision 36 says why it is built like this, `docs/security.md` against whom it helps.

mod blocks;
mod bundle;
mod cluster;
mod failure;
mod flaw;
mod issue;
mod stream;

pub use bundle::{Bundle, Validity};
pub use cluster::Cluster;
pub use failure::HandshakeFailure;
pub use flaw::{BundleError, Flaw};
pub use issue::{IssueError, MAX_DAYS};
pub use stream::Stream;

/// The name in every node's certificate. Nodes are known by their cluster and not by their
/// host's name, so that all of them have this one.
pub const NODE_NAME: &str = "node.lie.internal";

#[cfg(test)]
mod tests;
