use lie_scene::{LightKind, Scene};

use super::TriangleReport;

/// What things are called in a scene.
pub(super) struct Names<'a>(&'a Scene);

impl<'a> Names<'a> {
    pub(super) fn of(scene: &'a Scene) -> Self {
        Self(scene)
    }

    /// A light's name and its kind.
    pub(super) fn light(&self, light: u32) -> (String, &'static str) {
        let light = &self.0.lights[light as usize];
        let kind = match light.kind {
            LightKind::Point { .. } => "point",
            LightKind::Spot { .. } => "spot",
            LightKind::Directional { .. } => "directional",
            LightKind::Area(_) => "area",
        };
        (light.name.clone(), kind)
    }

    pub(super) fn triangle(&self, triangle: u32) -> TriangleReport {
        let geometry = &self.0.geometry;
        // Parts follow each other without a gap.
        let parts = geometry.parts();
        let part = parts.partition_point(|part| part.triangles.end <= triangle);
        let material = geometry.material_of(triangle) as usize;
        TriangleReport {
            triangle,
            mesh: parts
                .get(part)
                .map_or(String::new(), |part| part.name.clone()),
            material: self.0.materials[material].name.clone(),
        }
    }

    pub(super) fn triangles(&self, triangles: &[u32]) -> Vec<TriangleReport> {
        let triangles = triangles.iter();
        triangles.map(|&triangle| self.triangle(triangle)).collect()
    }
}
