use glam::Vec3;

use crate::{Aabb, Ray};

/// A triangle with its plane's normal, ready to be intersected.
///
/// Invariant, established by [`Self::new`]: `normal` is `(b − a) × (c − a)` computed in
/// double precision and scaled to unit length, or zero when the triangle is degenerate;
/// a degenerate triangle is never hit. Counter-clockwise order is the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// First vertex.
    pub a: Vec3,
    /// Second vertex.
    pub b: Vec3,
    /// Third vertex.
    pub c: Vec3,
    /// Unit geometric normal, or zero.
    pub normal: Vec3,
}

/// Where a ray meets one triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Ray parameter.
    pub t: f32,
    /// Weight of vertex `b`.
    pub u: f32,
    /// Weight of vertex `c`.
    pub v: f32,
}

impl Triangle {
    /// A triangle from its corners.
    #[must_use]
    pub fn new(a: Vec3, b: Vec3, c: Vec3) -> Self {
        // In double precision, once: the plane must be the same for every ray, and slivers
        // lose too many digits in single precision.
        let (a64, b64, c64) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
        let normal = (b64 - a64)
            .cross(c64 - a64)
            .try_normalize()
            .unwrap_or_default()
            .as_vec3();
        Self { a, b, c, normal }
    }

    /// Intersects a ray, both sides. Watertight: of two triangles that share an edge's
    /// vertices, a ray through the edge hits at least one, because the three edge
    /// functions of a shared edge differ exactly in sign (Plücker coordinates relative to
    /// the ray's origin; the form is that of Embree's robust mode).
    ///
    /// The vectorised kernels in `lie-accel` compute the same operations in the same
    /// order and are tested to give the same bits.
    #[must_use]
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<TriangleHit> {
        let v0 = self.a - ray.origin;
        let v1 = self.b - ray.origin;
        let v2 = self.c - ray.origin;
        // Edge functions, each the weight of the vertex opposite its edge.
        let weight_b = cross(v2 - v0, v2 + v0).dot(ray.direction);
        let weight_c = cross(v0 - v1, v0 + v1).dot(ray.direction);
        let weight_a = cross(v1 - v2, v1 + v2).dot(ray.direction);
        let smallest = weight_a.min(weight_b).min(weight_c);
        let largest = weight_a.max(weight_b).max(weight_c);
        let inside = smallest >= 0.0 || largest <= 0.0;
        let facing = self.normal.dot(ray.direction);
        let t = v0.dot(self.normal) / facing;
        // A ray in the triangle's plane has facing 0 and so an infinite or undefined t:
        // both comparisons reject it.
        if !(inside && facing != 0.0 && t > ray.t_min && t < ray.t_max) {
            return None;
        }
        let scale = 1.0 / (weight_a + weight_b + weight_c);
        Some(TriangleHit {
            t,
            u: weight_b * scale,
            v: weight_c * scale,
        })
    }

    /// Bounds of the three vertices.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::around([self.a, self.b, self.c])
    }

    /// Area in m².
    #[must_use]
    pub fn area(&self) -> f32 {
        0.5 * (self.b - self.a).cross(self.c - self.a).length()
    }

    /// Length of the longest edge in metres: what [`crate::offset_origin`] wants to know.
    #[must_use]
    pub fn extent(&self) -> f32 {
        let edges = [self.b - self.a, self.c - self.b, self.a - self.c];
        edges
            .iter()
            .map(|edge| edge.length_squared())
            .fold(0.0, f32::max)
            .sqrt()
    }
}

/// The cross product spelt out, so that the order of operations is ours and not glam's.
#[inline]
fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(
        a.y * b.z - a.z * b.y,
        a.z * b.x - a.x * b.z,
        a.x * b.y - a.y * b.x,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(range: f32) -> impl Strategy<Value = Vec3> {
        [-range..range, -range..range, -range..range].prop_map(Vec3::from_array)
    }

    proptest! {
        /// Two triangles share the edge `a b` and lie on opposite sides of it as the ray
        /// sees them: rays aimed at points on the edge never slip through.
        #[test]
        fn shared_edges_are_watertight(
            a in point(10.0), b in point(10.0), origin in point(100.0), s in 0.05f32..0.95,
            out in [0.1f32..10.0, 0.1f32..10.0], along in [-3.0f32..3.0, -3.0f32..3.0],
            deep in [-3.0f32..3.0, -3.0f32..3.0],
        ) {
            let direction = a + s * (b - a) - origin;
            let side = (b - a).cross(direction).normalize_or_zero();
            prop_assume!((b - a).length() > 0.1 && direction.length() > 1.0 && side != Vec3::ZERO);
            let third = |i: usize, sign: f32| {
                a + along[i] * (b - a) + sign * out[i] * side + deep[i] * direction.normalize()
            };
            let ray = Ray::new(origin, direction);
            let hit = Triangle::new(a, b, third(0, 1.0)).intersect(&ray).is_some()
                || Triangle::new(b, a, third(1, -1.0)).intersect(&ray).is_some();
            prop_assert!(hit);
        }

        #[test]
        fn weights_give_the_point_back(
            a in point(10.0), b in point(10.0), c in point(10.0),
            u in 0.05f32..0.45, v in 0.05f32..0.45, origin in point(100.0),
        ) {
            let triangle = Triangle::new(a, b, c);
            let target = a + u * (b - a) + v * (c - a);
            let ray = Ray::new(origin, target - origin);
            prop_assume!(triangle.area() > 1.0);
            prop_assume!(triangle.normal.dot(ray.direction.normalize()).abs() > 0.05);
            let hit = triangle.intersect(&ray).expect("aimed inside");
            prop_assert!((hit.t - 1.0).abs() < 1.0e-3);
            prop_assert!((hit.u - u).abs() < 1.0e-2 && (hit.v - v).abs() < 1.0e-2);
        }
    }

    #[test]
    fn degenerate_and_undefined_triangles_are_never_hit() {
        let ray = Ray::new(Vec3::Z, Vec3::NEG_Z);
        for c in [Vec3::X, Vec3::splat(f32::NAN), Vec3::ZERO] {
            assert_eq!(Triangle::new(Vec3::NEG_X, Vec3::X, c).intersect(&ray), None);
        }
        let good = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
        let in_plane = Ray::new(Vec3::NEG_X, Vec3::X);
        assert_eq!(good.intersect(&in_plane), None);
        let undefined = Ray::new(Vec3::Z, Vec3::splat(f32::NAN));
        assert_eq!(good.intersect(&undefined), None);
    }

    #[test]
    fn an_offset_origin_sees_neither_its_triangle_nor_its_coplanar_neighbour() {
        // A floor of 40 m far from the origin: the worst case for rounding.
        let corner = Vec3::new(100.0, 3.0, -70.0);
        let (x, z) = (Vec3::new(40.0, 0.3, 0.0), Vec3::new(0.1, 0.0, -40.0));
        let near = Triangle::new(corner, corner + x, corner + x + z);
        let far = Triangle::new(corner, corner + x + z, corner + z);
        for i in 1..200 {
            for k in 1..200 {
                let (u, v) = (i as f32 / 400.0, k as f32 / 400.0);
                let point = near.a * (1.0 - u - v) + near.b * u + near.c * v;
                let origin = crate::offset_origin(point, near.normal, near.extent());
                // Almost along the plane.
                let direction =
                    near.normal * 1.0e-3 + x.normalize() * (u - 0.2) + z.normalize() * v;
                let ray = Ray::new(origin, direction * 50.0);
                assert_eq!(near.intersect(&ray), None);
                assert_eq!(far.intersect(&ray), None);
            }
        }
    }
}
