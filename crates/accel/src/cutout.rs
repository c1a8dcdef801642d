use lie_scene::Scene;

/// Decides where triangles with holes are solid.
pub trait Cutout: Send + Sync {
    /// Whether a triangle may have holes at all; asked once per triangle, at build time.
    fn has_holes(&self, triangle: u32) -> bool;

    /// Whether the triangle is solid at barycentric weights `(u, v)`.
    fn is_solid(&self, triangle: u32, u: f32, v: f32) -> bool;
}

impl Cutout for Scene {
    fn has_holes(&self, triangle: u32) -> bool {
        self.materials[self.geometry.material_of(triangle) as usize].is_masked()
    }

    fn is_solid(&self, triangle: u32, u: f32, v: f32) -> bool {
        Scene::is_solid(self, triangle, u, v)
    }
}
