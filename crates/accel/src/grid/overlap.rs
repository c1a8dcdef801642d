use glam::DVec3;
use lie_geom::Triangle;

/// A triangle as boxes are tested against it, in double precision.
pub(super) struct Shape {
    corners: [DVec3; 3],
    edges: [DVec3; 3],
    normal: DVec3,
}

impl Shape {
    pub(super) fn new(triangle: &Triangle) -> Self {
        let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.as_dvec3());
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        Self {
            corners,
            edges,
            normal: edges[0].cross(edges[1]),
        }
    }

    /// The smallest box around it.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let [a, b, c] = self.corners;
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// Whether it meets a box, by separating axes (Akenine-Möller 2001): if there is a plane
    /// between the two, one of these thirteen directions is its normal.
    pub(super) fn meets(&self, center: DVec3, half: DVec3) -> bool {
        let corners = self.corners.map(|corner| corner - center);
        let [low, high] = [
            corners[0].min(corners[1]).min(corners[2]),
            corners[0].max(corners[1]).max(corners[2]),
        ];
        if low.cmpgt(half).any() || high.cmplt(-half).any() {
            return false;
        }
        let is_apart = |axis: DVec3| {
            let reach = half.dot(axis.abs());
            let [a, b, c] = corners.map(|corner| corner.dot(axis));
            a.min(b).min(c) > reach || a.max(b).max(c) < -reach
        };
        if is_apart(self.normal) {
            return false;
        }
        !self.edges.iter().any(|&edge| {
            is_apart(DVec3::X.cross(edge))
                || is_apart(DVec3::Y.cross(edge))
                || is_apart(DVec3::Z.cross(edge))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vec3> {
        [-3.0f32..3.0, -3.0f32..3.0, -3.0f32..3.0].prop_map(Vec3::from_array)
    }

    proptest! {
        /// A point of the triangle inside the box: they must meet.
        #[test]
        fn what_shares_a_point_meets(
            a in point(), b in point(), c in point(),
            u in 0.0f64..1.0, v in 0.0f64..1.0, aside in point(), half in 0.1f64..2.0,
        ) {
            let shape = Shape::new(&Triangle::new(a, b, c));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let inside = shape.corners[0] + u * shape.edges[0] - v * shape.edges[2];
            let center = inside + aside.as_dvec3() / 3.0 * half * 0.999;
            prop_assert!(shape.meets(center, DVec3::splat(half)));
        }
    }

    #[test]
    fn a_box_beside_the_slope_is_left_out() {
        // Its bounds hold the box, and so do its edges' in every projection but one.
        let shape = Shape::new(&Triangle::new(
            Vec3::new(4.0, 0.0, 0.0),
            Vec3::new(0.0, 4.0, 0.0),
            Vec3::new(0.0, 0.0, 4.0),
        ));
        assert!(shape.meets(DVec3::splat(4.0 / 3.0), DVec3::splat(0.1)));
        assert!(!shape.meets(DVec3::splat(0.5), DVec3::splat(0.4)));
        assert!(!shape.meets(DVec3::splat(2.4), DVec3::splat(0.4)));
    }
}
