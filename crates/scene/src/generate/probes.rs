//! What tests ask generated scenes, by brute force.

use glam::Vec3;
use lie_geom::Ray;

use crate::Scene;

/// Distance to the nearest triangle along a ray.
pub(super) fn nearest(scene: &Scene, ray: &Ray) -> Option<f32> {
    (0..scene.geometry.len() as u32)
        .filter_map(|index| scene.geometry.triangle(index).intersect(ray))
        .map(|hit| hit.t)
        .reduce(f32::min)
}

/// The shortest free way from a point in eight directions about it, on a level.
pub(super) fn clearance(scene: &Scene, from: Vec3) -> f32 {
    (0..8)
        .map(|eighth| {
            let (sin, cos) = (eighth as f32 * std::f32::consts::FRAC_PI_4).sin_cos();
            nearest(scene, &Ray::new(from, Vec3::new(cos, 0.0, sin))).unwrap_or(f32::INFINITY)
        })
        .fold(f32::INFINITY, f32::min)
}

/// No triangle is without area, and no shading normal looks to the other side of its triangle.
pub(super) fn assert_faces_are_sound(scene: &Scene) {
    for part in scene.geometry.parts() {
        for triangle in part.triangles.clone() {
            let corners = scene.geometry.corners(triangle);
            let [a, b, c] = corners.map(|corner| corner.position);
            let face = (b - a).cross(c - a);
            assert!(face.length() > 1.0e-10, "a sliver in '{}'", part.name);
            let mean: Vec3 = corners.iter().map(|corner| corner.normal).sum();
            assert!(face.dot(mean) > 0.0, "'{}' is shaded inside out", part.name);
        }
    }
}
