//! Meshes: attributes, primitive modes, winding.

use glam::{Mat4, Vec2, Vec3};
use gltf::{
    Semantic,
    mesh::{Mode, Primitive},
};

use super::Document;
use crate::{
    Vertex,
    draft::{Draft, DraftPart},
    load::{LoadError, MAX_TRIANGLES, MAX_VERTICES},
};

impl Document<'_> {
    /// Adds the primitives of a mesh as one node places them.
    pub(super) fn add_mesh(
        &self,
        mesh: &gltf::Mesh<'_>,
        node: &str,
        node_name: Option<&str>,
        world_from_node: Mat4,
        draft: &mut Draft,
    ) -> Result<(), LoadError> {
        let primitives = mesh.primitives().len();
        for primitive in mesh.primitives() {
            let element = format!(
                "mesh {} primitive {} at {node}",
                mesh.index(),
                primitive.index()
            );
            if primitive.morph_targets().len() > 0 {
                draft.warnings.push("morph targets are ignored".into());
            }
            if matches!(
                primitive.mode(),
                Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip
            ) {
                draft
                    .warnings
                    .push(format!("{element}: points and lines are left out"));
                continue;
            }
            let vertices = self.vertices(&primitive, &element, &mut draft.warnings)?;
            let triangles = self.triangles(&primitive, vertices.len(), &element)?;
            let base = node_name
                .or(mesh.name())
                .map_or_else(|| format!("mesh {}", mesh.index()), str::to_owned);
            let mut part = DraftPart {
                name: if primitives > 1 {
                    format!("{base}.{}", primitive.index())
                } else {
                    base
                },
                vertices,
                triangles,
                material: self.material_index(&primitive, draft),
            };
            if world_from_node != Mat4::IDENTITY {
                part.transform(world_from_node);
            }
            if let Some(index) = part
                .vertices
                .iter()
                .position(|vertex| !vertex.position.is_finite())
            {
                return Err(self
                    .file
                    .error(element, format!("vertex {index} is not finite once placed")));
            }
            let (triangles, vertices) = draft.add_part(part);
            if triangles > MAX_TRIANGLES || vertices > MAX_VERTICES {
                return Err(self.file.error(
                    element,
                    format!("more than {MAX_TRIANGLES} triangles or {MAX_VERTICES} vertices are not read"),
                ));
            }
        }
        Ok(())
    }

    fn vertices(
        &self,
        primitive: &Primitive<'_>,
        element: &str,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<Vertex>, LoadError> {
        let Some(accessor) = primitive.get(&Semantic::Positions) else {
            return Err(self.file.error(element, "expected a POSITION attribute"));
        };
        let positions = self.floats::<3>(&accessor, "POSITION")?;
        if let Some(vertex) = positions.iter().position(|p| !Vec3::from(*p).is_finite()) {
            return Err(self.file.error(
                format!("{element}: accessor {} (POSITION)", accessor.index()),
                format!("vertex {vertex} is not finite"),
            ));
        }
        let count = positions.len();
        let same_count = |found: usize, what: &str| {
            if found == count {
                Ok(())
            } else {
                Err(self
                    .file
                    .error(element, format!("{count} positions but {found} of {what}")))
            }
        };
        let mut normals = vec![Vec3::ZERO; count];
        if let Some(accessor) = primitive.get(&Semantic::Normals) {
            let read = self.floats::<3>(&accessor, "NORMAL")?;
            same_count(read.len(), "NORMAL")?;
            for (normal, from) in normals.iter_mut().zip(&read) {
                *normal = Vec3::from(*from).normalize_or_zero();
            }
            if normals.contains(&Vec3::ZERO) {
                warnings.push(format!(
                    "{element}: some normals have no direction; flat there"
                ));
            }
        }
        let mut uvs = vec![Vec2::ZERO; count];
        let set = self.texture_set(primitive);
        if let Some(accessor) = primitive.get(&Semantic::TexCoords(set)) {
            let read = self.floats::<2>(&accessor, "TEXCOORD")?;
            same_count(read.len(), "TEXCOORD")?;
            for (uv, from) in uvs.iter_mut().zip(&read) {
                *uv = Vec2::from(*from);
            }
            if uvs.iter().any(|uv| !uv.is_finite()) {
                warnings.push(format!(
                    "{element}: some texture coordinates are not finite; 0 there"
                ));
                uvs.iter_mut()
                    .filter(|uv| !uv.is_finite())
                    .for_each(|uv| *uv = Vec2::ZERO);
            }
        }
        if primitive.get(&Semantic::Colors(0)).is_some() {
            warnings.push("vertex colours are ignored".into());
        }
        Ok(positions
            .into_iter()
            .zip(normals.into_iter().zip(uvs))
            .map(|(position, (normal, uv))| Vertex {
                position: position.into(),
                normal,
                uv,
            })
            .collect())
    }

    fn triangles(
        &self,
        primitive: &Primitive<'_>,
        vertices: usize,
        element: &str,
    ) -> Result<Vec<[u32; 3]>, LoadError> {
        let indices = match primitive.indices() {
            Some(accessor) => self.indices(&accessor)?,
            None => (0..vertices as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|&&index| index as usize >= vertices) {
            return Err(self.file.error(
                element,
                format!("index {index} points past its {vertices} vertices"),
            ));
        }
        Ok(match primitive.mode() {
            Mode::TriangleStrip => indices
                .windows(3)
                .enumerate()
                .map(|(place, w)| {
                    if place % 2 == 0 {
                        [w[0], w[1], w[2]]
                    } else {
                        [w[0], w[2], w[1]]
                    }
                })
                .filter(|[a, b, c]| a != b && b != c && a != c)
                .collect(),
            Mode::TriangleFan => match indices.split_first() {
                Some((&first, rest)) => rest.windows(2).map(|w| [first, w[0], w[1]]).collect(),
                None => Vec::new(),
            },
            _ => {
                if indices.len() % 3 != 0 {
                    return Err(self.file.error(
                        element,
                        format!("{} indices are not a multiple of 3", indices.len()),
                    ));
                }
                indices
                    .chunks_exact(3)
                    .map(|c| [c[0], c[1], c[2]])
                    .collect()
            }
        })
    }
}
