//! glTF 2.0, .gltf and .glb.
//!
//! Beyond what the standard leaves no choice in:
//! * without a default scene the first one counts; without any scene, all root nodes do;
//! * a primitive without a material is plain grey: the standard's default, a rough white
//!   metal, would be almost black under direct light alone;
//! * blended materials are masked at an alpha of 0.5, points and lines are left out, and
//!   orthographic cameras, animation, skins and morph targets are ignored: each with a warning.

mod accessor;
mod container;
mod light;
mod material;
mod mesh;
mod node;

use std::path::Path;

use gltf::json;

use super::LoadError;
use crate::draft::Draft;

/// Extensions that a file may require.
const SUPPORTED: [&str; 6] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// The file that messages name.
struct File<'a> {
    path: &'a Path,
}

impl File<'_> {
    fn error(&self, element: impl Into<String>, problem: impl Into<String>) -> LoadError {
        LoadError::Element {
            path: self.path.to_owned(),
            element: element.into(),
            problem: problem.into(),
        }
    }
}

/// A validated document with the bytes of its buffers.
struct Document<'a> {
    file: File<'a>,
    gltf: gltf::Document,
    buffers: Vec<Vec<u8>>,
}

/// Reads the scene of a glTF file.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Draft, LoadError> {
    let file = File { path };
    let mut draft = Draft::default();
    let container = container::split(&file, bytes, &mut draft.warnings)?;
    let root = parse(&file, container.json, bytes.starts_with(b"glTF"))?;
    check_extensions(&file, &root, &mut draft.warnings)?;
    let buffers = container::buffers(&file, &root, container.binary)?;
    let gltf = validate(&file, root)?;
    let document = Document {
        file,
        gltf,
        buffers,
    };
    document.warn_of_ignored(&mut draft);
    document.add_materials(&mut draft)?;
    document.add_nodes(&mut draft)?;
    Ok(draft)
}

fn parse(file: &File<'_>, text: &[u8], is_binary: bool) -> Result<json::Root, LoadError> {
    // The GLB chunk is padded with spaces, by some writers with zeros.
    let end = text
        .iter()
        .rposition(|&byte| byte != 0)
        .map_or(0, |last| last + 1);
    json::deserialize::from_slice(&text[..end]).map_err(|error| {
        if is_binary {
            file.error("JSON chunk", error.to_string())
        } else {
            LoadError::Syntax {
                path: file.path.to_owned(),
                line: error.line(),
                column: error.column(),
                problem: error.to_string(),
            }
        }
    })
}

fn check_extensions(
    file: &File<'_>,
    root: &json::Root,
    warnings: &mut Vec<String>,
) -> Result<(), LoadError> {
    let unknown = |name: &&String| !SUPPORTED.contains(&name.as_str());
    if let Some(name) = root.extensions_required.iter().find(unknown) {
        return Err(file.error(
            "extensionsRequired",
            format!(
                "{name} is not supported; expected none but {}",
                SUPPORTED.join(", ")
            ),
        ));
    }
    let used = root.extensions_used.iter();
    warnings.extend(
        used.filter(unknown)
            .map(|name| format!("extension {name} is ignored")),
    );
    Ok(())
}

/// The crate's own validation, after which no index is out of range, and what it lacks.
fn validate(file: &File<'_>, mut root: json::Root) -> Result<gltf::Document, LoadError> {
    if !root.asset.version.starts_with("2.") {
        let found = &root.asset.version;
        return Err(file.error("asset", format!("version '{found}': expected 2.x")));
    }
    // Checked already, against a list that is longer than the crate's.
    root.extensions_required.clear();
    for (index, image) in root.images.iter().enumerate() {
        if image.uri.is_none() && image.buffer_view.is_none() {
            return Err(file.error(format!("image {index}"), "expected a URI or a buffer view"));
        }
    }
    // The crate's validation itself panics at a primitive that names no accessor.
    for (index, mesh) in root.meshes.iter().enumerate() {
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let count = root.accessors.len();
            let mut named = primitive.attributes.values().chain(&primitive.indices);
            if let Some(bad) = named.find(|accessor| accessor.value() >= count) {
                return Err(file.error(
                    format!("mesh {index} primitive {number}"),
                    format!("accessor {} does not exist: there are {count}", bad.value()),
                ));
            }
        }
    }
    for (index, accessor) in root.accessors.iter().enumerate() {
        if accessor.count.0 > super::MAX_VERTICES as u64 * 6 {
            let problem = format!("{} elements are too many", accessor.count.0);
            return Err(file.error(format!("accessor {index}"), problem));
        }
    }
    gltf::Document::from_json(root).map_err(|error| match error {
        gltf::Error::Validation(problems) => match problems.first() {
            Some((path, problem)) => file.error(path.to_string(), problem.to_string()),
            None => file.error("document", "is not valid"),
        },
        other => file.error("document", other.to_string()),
    })
}

impl Document<'_> {
    fn warn_of_ignored(&self, draft: &mut Draft) {
        let root = self.gltf.as_json();
        for (found, what) in [
            (!root.animations.is_empty(), "animations are ignored"),
            (
                !root.skins.is_empty(),
                "skins are ignored: meshes are shown as modelled",
            ),
        ] {
            if found {
                draft.warnings.push(what.into());
            }
        }
    }
}
