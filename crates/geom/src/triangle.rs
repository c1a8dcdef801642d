use std::ops::{Add, Mul, Sub};

use glam::Vec3;

use crate::{Aabb, Ray};

/// A number, or a vector of numbers: the steps of [`intersect_lane`] serve both, with the same bits.
pub trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>> Number for T {}

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

    /// Intersects a ray, both sides; see [`intersect_lane`] for what holds.
    #[must_use]
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<TriangleHit> {
        let lane = intersect_lane(
            [self.a.to_array(), self.b.to_array(), self.c.to_array()],
            self.normal.to_array(),
            ray.origin.to_array(),
            ray.direction.to_array(),
            ray.t_min,
            ray.t_max,
        );
        (lane.t < f32::INFINITY).then(|| lane.hit())
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

/// The result of [`intersect_lane`]: unscaled, and with a miss as an infinite `t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneHit {
    /// Ray parameter; infinity for a miss.
    pub t: f32,
    /// Weight of vertex `b`, times `sum`.
    pub weight_b: f32,
    /// Weight of vertex `c`, times `sum`.
    pub weight_c: f32,
    /// Sum of the three weights.
    pub sum: f32,
}

impl LaneHit {
    /// The hit, scaled; call it only where `t` is finite.
    #[must_use]
    #[inline]
    pub fn hit(self) -> TriangleHit {
        let scale = 1.0 / self.sum;
        TriangleHit {
            t: self.t,
            u: self.weight_b * scale,
            v: self.weight_c * scale,
        }
    }
}

/// One ray against one triangle without a branch, so that a loop over lanes (triangles or
/// rays) becomes vector code. The scalar test is this same function: whatever path a ray
/// takes, it gets the same bits.
///
/// Watertight: of two triangles that share an edge's vertices, a ray through the edge hits
/// at least one, because the edge functions of a shared edge differ exactly in sign
/// (Plücker coordinates relative to the ray's origin, as in Embree's robust mode).
/// `normal` is that of [`Triangle`]; zero means degenerate and is never hit. Numbers that
/// are not finite never hit.
#[must_use]
#[inline(always)]
pub fn intersect_lane(
    [a, b, c]: [[f32; 3]; 3],
    normal: [f32; 3],
    origin: [f32; 3],
    direction: [f32; 3],
    t_min: f32,
    t_max: f32,
) -> LaneHit {
    let weights = edge_weights([a, b, c], origin, direction);
    let t = plane_distance(a, normal, origin, direction);
    let hit = weights.inside() & (t > t_min) & (t < t_max);
    LaneHit {
        t: if hit { t } else { f32::INFINITY },
        weight_b: weights.b,
        weight_c: weights.c,
        sum: weights.sum(),
    }
}

/// How a ray passes a triangle's edges: the unscaled weights of its corners, whatever the
/// distance. The first half of [`intersect_lane`], for kernels that stop here when no lane
/// passes inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeWeights<T = f32> {
    /// Weight of vertex `a`.
    pub a: T,
    /// Weight of vertex `b`.
    pub b: T,
    /// Weight of vertex `c`.
    pub c: T,
}

impl<T: Number> EdgeWeights<T> {
    /// Sum of the three.
    #[must_use]
    #[inline(always)]
    pub fn sum(self) -> T {
        self.a + self.b + self.c
    }
}

impl EdgeWeights {
    /// Whether the ray's line passes inside, on either side of the triangle.
    ///
    /// Rounding can give a ray in the triangle's plane a finite distance, but all weights
    /// are zero then, and so it is not inside.
    #[must_use]
    #[inline(always)]
    pub fn inside(self) -> bool {
        let front = (self.a >= 0.0) & (self.b >= 0.0) & (self.c >= 0.0);
        let back = (self.a <= 0.0) & (self.b <= 0.0) & (self.c <= 0.0);
        (front | back) & (self.sum() != 0.0)
    }
}

/// The edge functions of a ray and a triangle, each the weight of the vertex opposite its
/// edge.
#[must_use]
#[inline(always)]
pub fn edge_weights<T: Number>(
    corners: [[T; 3]; 3],
    origin: [T; 3],
    direction: [T; 3],
) -> EdgeWeights<T> {
    weights_of(edge_planes(corners, origin), direction)
}

/// Of the planes through an origin and each edge of a triangle, the one opposite to each
/// vertex: what the edge functions have in common for all rays from there. Not normalised.
#[must_use]
#[inline(always)]
pub fn edge_planes<T: Number>([a, b, c]: [[T; 3]; 3], origin: [T; 3]) -> [[T; 3]; 3] {
    let v0 = subtract(a, origin);
    let v1 = subtract(b, origin);
    let v2 = subtract(c, origin);
    [
        cross(subtract(v1, v2), add(v1, v2)),
        cross(subtract(v2, v0), add(v2, v0)),
        cross(subtract(v0, v1), add(v0, v1)),
    ]
}

/// [`edge_weights`] of a ray from where [`edge_planes`] start.
#[must_use]
#[inline(always)]
pub fn weights_of<T: Number>([a, b, c]: [[T; 3]; 3], direction: [T; 3]) -> EdgeWeights<T> {
    EdgeWeights {
        a: dot(a, direction),
        b: dot(b, direction),
        c: dot(c, direction),
    }
}

/// Where a ray meets the plane through `corner`. A ray in the plane divides by zero: the
/// result is infinite or undefined, and comparisons reject both.
#[must_use]
#[inline(always)]
pub fn plane_distance(
    corner: [f32; 3],
    normal: [f32; 3],
    origin: [f32; 3],
    direction: [f32; 3],
) -> f32 {
    plane_offset(corner, normal, origin) / dot(normal, direction)
}

/// How far a plane through `corner` is from an origin, along its normal.
#[must_use]
#[inline(always)]
pub fn plane_offset<T: Number>(corner: [T; 3], normal: [T; 3], origin: [T; 3]) -> T {
    dot(subtract(corner, origin), normal)
}

#[inline(always)]
fn subtract<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn add<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn cross<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The scalar product of two vectors.
#[must_use]
#[inline(always)]
pub fn dot<T: Number>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
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
                let light = origin + direction * 50.0;
                for ray in [ray, crate::Ray::segment_from(light, origin)] {
                    assert_eq!(near.intersect(&ray), None);
                    assert_eq!(far.intersect(&ray), None);
                }
            }
        }
    }
}
