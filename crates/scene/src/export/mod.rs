//! Scenes to files.

mod emission;
mod glb;
mod glb_binary;
mod glb_material;
mod obj;

/// What was written, and what the format could not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported<T> {
    /// The file's content.
    pub content: T,
    /// One sentence each, for people.
    pub warnings: Vec<String>,
}

/// The text of an OBJ file and of its material library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObjText {
    /// The OBJ file.
    pub obj: String,
    /// The MTL file that it names.
    pub mtl: String,
}

/// Why a scene cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A GLB holds at most 4 GiB.
    #[error("the scene needs {0} bytes, more than the 4 GiB that a GLB can hold")]
    TooLarge(u64),
    /// A texture could not be encoded as PNG.
    #[error("texture {texture} cannot be encoded: {source}")]
    Texture {
        /// Its index.
        texture: usize,
        /// Why.
        source: image::ImageError,
    },
    /// The description could not be encoded as JSON.
    #[error("the scene's description cannot be encoded: {0}")]
    Json(#[from] serde_json::Error),
}

pub use glb::export_glb;
pub use obj::export_obj;

#[cfg(test)]
mod tests;
