use std::collections::HashMap;

use glam::{Mat3, Mat4, Vec3};
use lie_geom::Aabb;

use crate::{
    AreaLight, Background, Camera, Geometry, GeometryError, KeyFrame, Light, LightKind, Material,
    MeshPart, RenderSettings, Scene, SceneError, Texture, Vertex, Walkthrough,
    area_shape::{area_shape, transform_shape},
};

/// A scene in the making: what loaders and generators put together, piece by piece.
///
/// `lights` holds those without a surface only. The lights of emissive surfaces follow from
/// parts and materials, once, in [`Self::finish`]: so a surface cannot shine twice.
#[derive(Clone, Debug, Default)]
pub(crate) struct Draft {
    pub(crate) parts: Vec<DraftPart>,
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) lights: Vec<Light>,
    pub(crate) cameras: Vec<Camera>,
    pub(crate) walkthroughs: Vec<Walkthrough>,
    pub(crate) warnings: Vec<String>,
    /// Triangles and vertices of all parts added by [`Self::add_part`].
    size: (usize, usize),
}

/// A mesh part with vertices of its own.
#[derive(Clone, Debug, Default)]
pub(crate) struct DraftPart {
    pub(crate) name: String,
    pub(crate) vertices: Vec<Vertex>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) material: u32,
}

impl DraftPart {
    /// The corners of each triangle. Indices must be in range.
    pub(crate) fn corners(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        self.triangles
            .iter()
            .map(|triangle| triangle.map(|index| self.vertices[index as usize].position))
    }

    /// Moves the part. A transform that mirrors also turns the triangles round, so that the
    /// front stays the front.
    pub(crate) fn transform(&mut self, world_from_part: Mat4) {
        let linear = Mat3::from_mat4(world_from_part);
        let normal_matrix = normal_matrix(linear);
        for vertex in &mut self.vertices {
            vertex.position = world_from_part.transform_point3(vertex.position);
            vertex.normal = (normal_matrix * vertex.normal).normalize_or_zero();
        }
        if linear.determinant() < 0.0 {
            for triangle in &mut self.triangles {
                triangle.swap(1, 2);
            }
        }
    }
}

impl Draft {
    /// Moves everything: parts, lights, cameras and walkthroughs. Lights keep their radiant
    /// intensity, whatever the scale.
    pub(crate) fn transform(&mut self, world_from_draft: Mat4) {
        let point = |p: Vec3| world_from_draft.transform_point3(p);
        let along = |d: Vec3| world_from_draft.transform_vector3(d).normalize_or(d);
        for part in &mut self.parts {
            part.transform(world_from_draft);
        }
        for light in &mut self.lights {
            match &mut light.kind {
                LightKind::Point { position, .. } => *position = point(*position),
                LightKind::Spot {
                    position,
                    direction,
                    ..
                } => (*position, *direction) = (point(*position), along(*direction)),
                LightKind::Directional { direction, .. } => *direction = along(*direction),
                LightKind::Area(area) => {
                    let shape = transform_shape(area.shape(), world_from_draft);
                    *area = AreaLight::new(shape, area.radiance, area.double_sided);
                }
            }
        }
        let turn = |orientation: glam::Quat| {
            crate::camera::orientation_towards(
                along(orientation * Vec3::NEG_Z),
                along(orientation * Vec3::Y),
            )
        };
        for camera in &mut self.cameras {
            camera.eye = point(camera.eye);
            camera.orientation = turn(camera.orientation);
        }
        for key in self
            .walkthroughs
            .iter_mut()
            .flat_map(|walk| &mut walk.key_frames)
        {
            *key = KeyFrame {
                eye: point(key.eye),
                orientation: turn(key.orientation),
                ..*key
            };
        }
    }

    /// Adds everything of `other`, its materials and textures behind those already here.
    pub(crate) fn append(&mut self, mut other: Self) {
        let materials = self.materials.len() as u32;
        let textures = self.textures.len() as u32;
        for part in &mut other.parts {
            part.material += materials;
        }
        for material in &mut other.materials {
            for reference in [
                &mut material.base_color_texture,
                &mut material.metallic_roughness_texture,
            ]
            .into_iter()
            .flatten()
            {
                reference.texture += textures;
            }
        }
        self.parts.append(&mut other.parts);
        self.materials.append(&mut other.materials);
        self.textures.append(&mut other.textures);
        self.lights.append(&mut other.lights);
        self.cameras.append(&mut other.cameras);
        self.walkthroughs.append(&mut other.walkthroughs);
        self.warnings.append(&mut other.warnings);
    }

    /// Adds a part, and gives the number of triangles and vertices added so far.
    pub(crate) fn add_part(&mut self, part: DraftPart) -> (usize, usize) {
        self.size.0 += part.triangles.len();
        self.size.1 += part.vertices.len();
        self.parts.push(part);
        self.size
    }

    /// Adds a material and gives its index.
    pub(crate) fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// Bounds of the parts' triangles.
    pub(crate) fn bounds(&self) -> Aabb {
        Aabb::around(self.parts.iter().flat_map(DraftPart::corners).flatten())
    }

    /// Whether anything shines.
    pub(crate) fn has_lights(&self) -> bool {
        !self.lights.is_empty()
            || self.parts.iter().any(|part| {
                !part.triangles.is_empty() && self.materials[part.material as usize].is_emissive()
            })
    }

    /// The checked scene, and the warnings gathered on the way. Each part with an emissive
    /// material becomes one area light, after the lights that have no surface.
    pub(crate) fn finish(
        mut self,
        name: String,
        background: Background,
        settings: RenderSettings,
    ) -> Result<(Scene, Vec<String>), SceneError> {
        self.check_materials()?;
        let mut lights = std::mem::take(&mut self.lights);
        for part in &self.parts {
            let material = &self.materials[part.material as usize];
            if !material.is_emissive() || part.triangles.is_empty() || !in_range(part) {
                continue;
            }
            let corners: Vec<_> = part.corners().collect();
            let area = AreaLight::new(
                area_shape(corners),
                material.emission,
                material.double_sided,
            );
            if area.area() > 0.0 {
                lights.push(Light {
                    name: part.name.clone(),
                    kind: LightKind::Area(area),
                });
            } else {
                let name = &part.name;
                self.warnings
                    .push(format!("'{name}' is emissive but has no area: no light"));
            }
        }
        let scene = Scene {
            name,
            geometry: join(self.parts)?,
            materials: self.materials,
            textures: self.textures,
            lights,
            cameras: self.cameras,
            walkthroughs: self.walkthroughs,
            background,
            settings,
        };
        scene.validate()?;
        Ok((scene, self.warnings))
    }

    fn check_materials(&self) -> Result<(), SceneError> {
        let count = self.materials.len();
        match self
            .parts
            .iter()
            .find(|part| part.material as usize >= count)
        {
            Some(part) => Err(SceneError::Reference {
                what: format!("mesh '{}'", part.name),
                kind: "material",
                index: part.material,
                count,
            }),
            None => Ok(()),
        }
    }
}

/// The matrix that carries normals; zero where the transform flattens everything.
pub(crate) fn normal_matrix(linear: Mat3) -> Mat3 {
    let determinant = linear.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        Mat3::ZERO
    } else {
        linear.inverse().transpose()
    }
}

fn in_range(part: &DraftPart) -> bool {
    let count = part.vertices.len();
    part.triangles
        .iter()
        .flatten()
        .all(|&index| (index as usize) < count)
}

/// All parts one after the other.
fn join(parts: Vec<DraftPart>) -> Result<Geometry, GeometryError> {
    let total: usize = parts.iter().map(|part| part.triangles.len()).sum();
    let vertex_total: usize = parts.iter().map(|part| part.vertices.len()).sum();
    if total > Geometry::MAX_TRIANGLES || vertex_total > u32::MAX as usize {
        return Err(GeometryError::TooMany(total));
    }
    let mut vertices = Vec::with_capacity(vertex_total);
    let mut triangles = Vec::with_capacity(total);
    let mut mesh_parts = Vec::with_capacity(parts.len());
    for part in parts {
        let (first_vertex, first_triangle) = (vertices.len() as u32, triangles.len());
        let count = part.vertices.len();
        for (index, corners) in part.triangles.iter().enumerate() {
            if let Some(&bad) = corners.iter().find(|&&corner| corner as usize >= count) {
                return Err(GeometryError::Index {
                    part: part.name,
                    triangle: first_triangle + index,
                    index: bad,
                    count,
                });
            }
            triangles.push(corners.map(|corner| first_vertex + corner));
        }
        vertices.extend(part.vertices);
        mesh_parts.push(MeshPart {
            name: part.name,
            triangles: first_triangle as u32..triangles.len() as u32,
            material: part.material,
        });
    }
    Geometry::new(vertices, triangles, mesh_parts)
}

/// Most warnings that are told one by one.
const MAX_WARNINGS: usize = 100;

/// Warnings without repetition: the same one many times is said once, with its number.
pub(crate) fn without_repetition(warnings: Vec<String>) -> Vec<String> {
    let mut seen: HashMap<String, usize> = HashMap::new();
    let mut order = Vec::new();
    for warning in warnings {
        let count = seen.entry(warning.clone()).or_insert(0);
        if *count == 0 {
            order.push(warning);
        }
        *count += 1;
    }
    let more = order.len().saturating_sub(MAX_WARNINGS);
    order.truncate(MAX_WARNINGS);
    let mut told: Vec<String> = order
        .into_iter()
        .map(|warning| match seen[&warning] {
            1 => warning,
            count => format!("{warning} ({count} times)"),
        })
        .collect();
    if more > 0 {
        told.push(format!("and {more} more of such warnings"));
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirror_keeps_the_front() {
        let vertex = |position| Vertex {
            position,
            normal: Vec3::Z,
            uv: glam::Vec2::ZERO,
        };
        let mut part = DraftPart {
            vertices: vec![vertex(Vec3::ZERO), vertex(Vec3::X), vertex(Vec3::Y)],
            triangles: vec![[0, 1, 2]],
            ..DraftPart::default()
        };
        part.transform(Mat4::from_scale(Vec3::new(-2.0, 1.0, 1.0)));
        let [a, b, c] = part.corners().next().unwrap();
        assert!((b - a).cross(c - a).z > 0.0);
        assert_eq!(part.vertices[0].normal, Vec3::Z);
    }

    #[test]
    fn repeated_warnings_are_counted() {
        let warnings = ["a", "b", "a"].map(String::from).to_vec();
        assert_eq!(without_repetition(warnings), ["a (2 times)", "b"]);
    }
}
