//! A scene as bytes: what travels to shaders and what their cache holds.
//!
//! Container: `LIESCENE`, a version (u32), the length of the description (u64), the
//! description (bincode), then plain little-endian arrays in this order: vertices (8 `f32`
//! each: position, normal, texture coordinates), triangles (3 `u32`), the corners of mesh
//! lights (9 `f32` a triangle), texels (4 `u8`). How many of each the description says; the
//! arrays fill the container to its last byte.

mod arrays;
mod decode;
mod description;
mod encode;

use std::sync::Arc;

use lie_protocol::{SceneHash, limit};
use lie_scene::{GeometryError, SceneError, TextureError};

pub use decode::decode;
pub use encode::encode;

const MAGIC: [u8; 8] = *b"LIESCENE";
const VERSION: u32 = 1;

/// A scene's bytes and their hash. The hash is always that of the bytes.
#[derive(Clone, Debug)]
pub struct SceneBlob {
    hash: SceneHash,
    bytes: Arc<[u8]>,
}

impl SceneBlob {
    /// Hashes the bytes.
    #[must_use]
    pub fn new(bytes: Vec<u8>) -> Self {
        Self {
            hash: hash_of(&bytes),
            bytes: bytes.into(),
        }
    }

    /// BLAKE3 of the bytes.
    #[must_use]
    pub fn hash(&self) -> SceneHash {
        self.hash
    }

    /// The container.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// The name of some bytes.
#[must_use]
pub fn hash_of(bytes: &[u8]) -> SceneHash {
    SceneHash(*blake3::hash(bytes).as_bytes())
}

/// Why bytes are not a scene, or a scene cannot become bytes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlobError {
    /// Not such a container, or of another version.
    #[error("these bytes are not a scene of container version {VERSION}")]
    Container,
    /// The description cannot be read or written.
    #[error("the scene's description is malformed: {0}")]
    Description(String),
    /// The description promises other arrays than there are.
    #[error("the scene's {array} do not fit its bytes")]
    Array {
        /// Which array.
        array: &'static str,
    },
    /// The scene is larger than a peer would take.
    #[error("the scene takes {0} bytes, more than the {max} that can be sent", max = limit::SCENE)]
    TooLong(usize),
    /// The triangles are wrong.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A texture is wrong.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// The whole is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

#[cfg(test)]
pub(crate) mod tests;
