//! What tests ask generated scenes, by brute force.

use glam::{UVec2, Vec3};
use lie_geom::{Aabb, Ray, Triangle};

use crate::{Camera, Scene};

/// A scene to send single rays through: its parts, each in a ball that most rays miss.
pub(super) struct Probe {
    parts: Vec<(Vec3, f32, Vec<Triangle>)>,
}

impl Probe {
    pub(super) fn new(scene: &Scene) -> Self {
        let of = |range: std::ops::Range<u32>| {
            let triangles: Vec<_> = range.map(|index| *scene.geometry.triangle(index)).collect();
            let bounds = triangles
                .iter()
                .map(Triangle::bounds)
                .fold(Aabb::EMPTY, Aabb::union);
            (bounds.center(), 0.501 * bounds.size().length(), triangles)
        };
        let parts = scene.geometry.parts().iter();
        Self {
            parts: parts.map(|part| of(part.triangles.clone())).collect(),
        }
    }

    /// Distance to the nearest triangle along a ray.
    pub(super) fn nearest(&self, ray: &Ray) -> Option<f32> {
        let meets = |center: Vec3, radius: f32| {
            let way = center - ray.origin;
            (way - way.dot(ray.direction) * ray.direction).length() <= radius
        };
        self.parts
            .iter()
            .filter(|(center, radius, _)| meets(*center, *radius))
            .flat_map(|(_, _, triangles)| triangles)
            .filter_map(|triangle| triangle.intersect(ray))
            .map(|hit| hit.t)
            .reduce(f32::min)
    }

    /// The shortest free way from a point in eight directions about it, on a level.
    pub(super) fn clearance(&self, from: Vec3) -> f32 {
        (0..8)
            .map(|eighth| {
                let (sin, cos) = (eighth as f32 * std::f32::consts::FRAC_PI_4).sin_cos();
                self.nearest(&Ray::new(from, Vec3::new(cos, 0.0, sin)))
                    .unwrap_or(f32::INFINITY)
            })
            .fold(f32::INFINITY, f32::min)
    }

    /// Checks that a camera has room about it and meets a surface wherever it looks.
    pub(super) fn assert_sees_no_void(&self, camera: &Camera) {
        assert!(self.clearance(camera.eye) > 0.25, "'{}'", camera.name);
        let size = UVec2::new(24, 14);
        for pixel in 0..size.x * size.y {
            let film = UVec2::new(pixel % size.x, pixel / size.x).as_vec2() + 0.5;
            let hit = self.nearest(&camera.ray(film, size));
            assert!(hit.is_some(), "'{}' looks out at {film}", camera.name);
        }
    }
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
