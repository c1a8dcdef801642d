use std::path::PathBuf;

use crate::peers::PeerError;

/// Why a measurement or its report came to nothing.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// Threads could not be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A picture could not be compared or written.
    #[error(transparent)]
    Image(#[from] lie_render::ImageError),
    /// A plot could not be drawn.
    #[error("cannot draw a plot: {0}")]
    Plot(String),
    /// Another program could not be measured.
    #[error(transparent)]
    Peer(#[from] PeerError),
    /// A farm has no frame.
    #[error(transparent)]
    Farm(#[from] lie_farm::client::ClientError),
    /// A report that something is to be put into could not be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file or folder could not be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
