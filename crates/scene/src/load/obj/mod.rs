//! Wavefront OBJ with MTL.
//!
//! tobj parses; around it, `scan` checks every line first (so that errors have a line and
//! a column) and `polygon` cuts faces into triangles (tobj's fans leave concave ones).

mod material;
mod polygon;
mod scan;

use std::{collections::HashMap, path::Path};

use glam::{Vec2, Vec3};

use super::LoadError;
use crate::{
    Material, Vertex,
    draft::{Draft, DraftPart},
};

/// Name under which the material library goes to tobj.
const LIBRARY: &str = "library";

/// Reads an OBJ file and its material libraries.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Draft, LoadError> {
    let mut draft = Draft::default();
    let text = scan::decode(path, bytes)?;
    let scan = scan::scan(path, &text, &mut draft.warnings)?;
    let mut library = material::read_libraries(path, &scan.libraries, &mut draft)?;
    for name in &scan.materials {
        if !library.iter().any(|material| material.name == *name) {
            let shown = super::source::shorten(name);
            draft.warnings.push(format!(
                "material '{shown}' is nowhere defined: a grey one stands in"
            ));
            library.push(tobj::Material {
                name: name.clone(),
                ..tobj::Material::default()
            });
        }
    }
    let names: HashMap<&str, usize> = library
        .iter()
        .enumerate()
        .map(|(index, material)| (material.name.as_str(), index))
        .collect();
    let options = tobj::LoadOptions {
        single_index: true,
        triangulate: false,
        ..tobj::LoadOptions::default()
    };
    let text = format!("mtllib {LIBRARY}\n{}", scan.text);
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| {
        let named = names
            .iter()
            .map(|(name, &index)| ((*name).to_owned(), index))
            .collect();
        Ok((library.iter().map(name_only).collect(), named))
    })
    .map_err(|error| LoadError::Element {
        path: path.to_owned(),
        element: "OBJ".into(),
        problem: error.to_string(),
    })?;
    material::add(library, path, &mut draft)?;
    add_parts(path, models, &mut draft)?;
    Ok(draft)
}

fn name_only(material: &tobj::Material) -> tobj::Material {
    tobj::Material {
        name: material.name.clone(),
        ..tobj::Material::default()
    }
}

/// Adds one part per group and material, in the order of their first face.
fn add_parts(path: &Path, models: Vec<tobj::Model>, draft: &mut Draft) -> Result<(), LoadError> {
    let mut part_of: HashMap<(String, u32), usize> = HashMap::new();
    let mut default_material = None;
    let mut corners = 0;
    for model in models {
        if model.mesh.indices.is_empty() {
            continue;
        }
        let material = match model.mesh.material_id {
            Some(index) => index as u32,
            None => {
                *default_material.get_or_insert_with(|| draft.add_material(Material::default()))
            }
        };
        let parts = &mut draft.parts;
        let index = *part_of
            .entry((model.name.clone(), material))
            .or_insert_with(|| {
                parts.push(DraftPart {
                    name: model.name.clone(),
                    material,
                    ..DraftPart::default()
                });
                parts.len() - 1
            });
        add_faces(&mut parts[index], &model.mesh, &mut draft.warnings);
        corners += model.mesh.indices.len();
        if corners > super::MAX_TRIANGLES {
            return Err(LoadError::Element {
                path: path.to_owned(),
                element: format!("group '{}'", model.name),
                problem: format!(
                    "more than {} corners of faces are not read",
                    super::MAX_TRIANGLES
                ),
            });
        }
    }
    Ok(())
}

fn add_faces(part: &mut DraftPart, mesh: &tobj::Mesh, warnings: &mut Vec<String>) {
    let first = part.vertices.len() as u32;
    let positions = mesh.positions.chunks_exact(3).map(Vec3::from_slice);
    for (index, position) in positions.enumerate() {
        let normal = mesh
            .normals
            .get(3 * index..3 * index + 3)
            .map(Vec3::from_slice);
        let uv = mesh
            .texcoords
            .get(2 * index..2 * index + 2)
            .map(Vec2::from_slice);
        part.vertices.push(Vertex {
            position,
            normal: normal.unwrap_or_default().normalize_or_zero(),
            // OBJ counts v from the lower edge of the image.
            uv: uv.map_or(Vec2::ZERO, |uv| Vec2::new(uv.x, 1.0 - uv.y)),
        });
    }
    // No arities at all means triangles throughout.
    let triangles = mesh.indices.len() / 3;
    let arities = match mesh.face_arities.is_empty() {
        true => vec![3; triangles],
        false => mesh.face_arities.clone(),
    };
    let mut rest = mesh.indices.as_slice();
    for arity in arities {
        let (face, after) = rest.split_at((arity as usize).min(rest.len()));
        rest = after;
        let corners: Vec<u32> = face.iter().map(|index| first + index).collect();
        let positions: Vec<Vec3> = corners
            .iter()
            .map(|&index| part.vertices[index as usize].position)
            .collect();
        let (triangles, is_simple) = polygon::triangulate(&positions);
        if !is_simple {
            let name = &part.name;
            warnings.push(format!(
                "'{name}' has a polygon that crosses itself: cut as a fan"
            ));
        }
        part.triangles.extend(
            triangles
                .into_iter()
                .map(|triangle| triangle.map(|i| corners[i])),
        );
    }
}
