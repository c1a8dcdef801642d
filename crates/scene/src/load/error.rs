use std::path::PathBuf;

use crate::SceneError;

/// Why a file could not become a scene. Each message names the file, the place in it and
/// what was expected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is longer than [`crate::MAX_FILE_BYTES`].
    #[error("{}: {bytes} bytes are more than the {max} that are read", path.display(), max = crate::MAX_FILE_BYTES)]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its length.
        bytes: u64,
    },
    /// The name does not end in a known extension.
    #[error("{}: expected a .glb, .gltf, .obj or .toml file, or a folder with a scene.toml", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A text file breaks the rules of its format.
    #[error("{}:{line}:{column}: {problem}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What is wrong, and what was expected.
        problem: String,
    },
    /// An element of the file is wrong.
    #[error("{}: {element}: {problem}", path.display())]
    Element {
        /// The file.
        path: PathBuf,
        /// Which element, such as `mesh 3 primitive 0`.
        element: String,
        /// What is wrong, and what was expected.
        problem: String,
    },
    /// All was read, but does not make a scene.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: SceneError,
    },
}
