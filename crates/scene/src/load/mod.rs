//! Scenes from files.

mod error;
mod framing;
mod gltf;
mod obj;
mod picture;
mod source;
mod toml;

use std::path::Path;

pub use error::LoadError;
pub use source::MAX_FILE_BYTES;

use crate::{
    Background, RenderSettings, Scene,
    draft::{Draft, without_repetition},
};

/// Most triangles that are read from files, all instances counted.
const MAX_TRIANGLES: usize = 1 << 26;
/// Most vertices that are read from files, all instances counted.
const MAX_VERTICES: usize = 1 << 26;
/// Most bytes that all textures of a file may hold once decoded.
const MAX_TEXTURE_BYTES: usize = 4 << 30;

/// A scene, and what was left out or replaced on the way to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The scene; [`Scene::validate`] has passed.
    pub scene: Scene,
    /// One sentence each, for people.
    pub warnings: Vec<String>,
}

/// Reads a scene from a `.glb`, `.gltf`, `.obj` or `.toml` file, or from a folder that holds
/// a `scene.toml`.
///
/// A glTF or OBJ file without a camera is framed by its bounds; one without a light gets a
/// point light near that camera, with a warning that says so.
///
/// # Errors
/// [`LoadError`] names the file, the place and what was expected.
pub fn load(path: &Path) -> Result<Loaded, LoadError> {
    let folder_scene = path.join("scene.toml");
    let path = if path.is_dir() { &folder_scene } else { path };
    let (scene, warnings) = if Format::of(path)? == Format::Toml {
        toml::load(path)?
    } else {
        let mut draft = read_model(path)?;
        framing::add_missing(&mut draft);
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        draft
            .finish(
                name.into(),
                Background::default(),
                RenderSettings::default(),
            )
            .map_err(|source| LoadError::Scene {
                path: path.to_owned(),
                source,
            })?
    };
    Ok(Loaded {
        scene,
        warnings: without_repetition(warnings),
    })
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Gltf,
    Obj,
    Toml,
}

impl Format {
    fn of(path: &Path) -> Result<Self, LoadError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        match extension.to_ascii_lowercase().as_str() {
            "glb" | "gltf" => Ok(Self::Gltf),
            "obj" => Ok(Self::Obj),
            "toml" => Ok(Self::Toml),
            _ => Err(LoadError::UnknownFormat {
                path: path.to_owned(),
            }),
        }
    }
}

/// Reads a glTF or OBJ file, as it is.
fn read_model(path: &Path) -> Result<Draft, LoadError> {
    match Format::of(path)? {
        Format::Gltf => gltf::load(path, &source::read(path)?),
        Format::Obj => obj::load(path, &source::read(path)?),
        Format::Toml => Err(LoadError::UnknownFormat {
            path: path.to_owned(),
        }),
    }
}
