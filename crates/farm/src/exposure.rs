use crate::secure::Cluster;

/// How a process's connections are protected, and which addresses it deals with.
#[derive(Clone, Debug)]
pub enum Exposure {
    /// This machine alone: connections are neither encrypted nor authenticated.
    Loopback,
    /// Any address without protection, on the user's explicit word.
    Insecure,
    /// Any address, by mutual TLS with processes of one cluster.
    Cluster(Cluster),
}
