//! Whether a surface closes a shaft.

use glam::Vec3;
use lie_geom::{SHADOW_T_MAX, Triangle, edge_planes, plane_offset};

use super::{Shaft, Side};
use crate::MeshEdges;

impl Shaft {
    /// Whether some triangles block every segment, however long their list would be. They are
    /// looked for from `start` on, which should be one that blocks the segment to the middle of
    /// the ends, across the mesh's edges: where every edge inside the shaft has a
    /// triangle on its other side, and none touches the ends, there is no way through. `is_solid` says which
    /// triangles have no holes. False if that takes more than `limit` of them.
    #[must_use]
    pub fn is_covered(
        &self,
        start: u32,
        triangles: &[Triangle],
        edges: &MeshEdges,
        is_solid: impl Fn(u32) -> bool,
        limit: usize,
    ) -> bool {
        let mut known = Vec::with_capacity(16);
        known.push(start);
        let mut done = 0;
        while done < known.len() {
            let index = known[done];
            done += 1;
            let Some(shape) = triangles.get(index as usize) else {
                return false;
            };
            let corners = [shape.a, shape.b, shape.c];
            if !self.lies_between(shape) || !is_solid(index) {
                return false;
            }
            let planes = edge_planes(corners.map(|corner| corner.to_array()), self.apex);
            for vertex in 0..3 {
                let side = |point: Vec3| dot(planes[vertex], subtract(point, self.apex));
                let [least, most] = self.interval(planes[vertex]);
                let own = side(corners[vertex]);
                if (own > 0.0 && least > 0.0) || (own < 0.0 && most < 0.0) {
                    // All of the shaft is on the triangle's side.
                    continue;
                }
                let ends = [corners[(vertex + 1) % 3], corners[(vertex + 2) % 3]];
                if self.misses(ends) {
                    continue;
                }
                let Some(other) = edges.beyond(index, vertex) else {
                    return false;
                };
                // A surface that folds back leaves the rest open.
                let Some(tip) = triangles.get(other as usize).map(|other| tip(other, ends)) else {
                    return false;
                };
                if own * side(tip) >= 0.0 {
                    return false;
                }
                if !known.contains(&other) {
                    if known.len() == limit {
                        return false;
                    }
                    known.push(other);
                }
            }
        }
        true
    }

    /// Whether every segment that passes inside a triangle meets it between its ends, as the triangle
    /// test rounds: from a light that is far away distances are coarse.
    fn lies_between(&self, shape: &Triangle) -> bool {
        let normal = shape.normal.to_array();
        let offset = plane_offset(shape.a.to_array(), normal, self.apex);
        // Rounding is monotonic: it is met at `offset / along`, and that is below 1.
        let along = match self.interval(normal) {
            [least, most] if offset > 0.0 => [least, most],
            [least, most] => [-most, -least],
        };
        let nearest = (1.0 - SHADOW_T_MAX) * along[1] * (1.0 + 64.0 * f32::EPSILON);
        along[0] > offset.abs() && offset.abs() > nearest
    }

    /// Whether a piece of an edge is outside for certain.
    fn misses(&self, ends: [Vec3; 2]) -> bool {
        let beyond = |axis: usize| {
            ends.iter().all(|end| end[axis] < self.around[0][axis])
                || ends.iter().all(|end| end[axis] > self.around[1][axis])
        };
        let beside = |(index, side): (usize, &Side)| {
            let (u, v) = ((index / 2 + 1) % 3, (index / 2 + 2) % 3);
            let most = |end: &Vec3| side.normal[0] * end[u] + side.normal[1] * end[v];
            ends.iter().all(|end| most(end) < side.least)
        };
        (0..3).any(beyond) || self.sides.iter().enumerate().any(beside)
    }
}

/// A triangle's corner that is not an end of its edge.
fn tip(shape: &Triangle, ends: [Vec3; 2]) -> Vec3 {
    let corners = [shape.a, shape.b, shape.c];
    let is_tip = |corner: &&Vec3| !ends.contains(corner);
    *corners.iter().find(is_tip).unwrap_or(&shape.a)
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn subtract(point: Vec3, from: [f32; 3]) -> [f32; 3] {
    (point - Vec3::from(from)).to_array()
}
