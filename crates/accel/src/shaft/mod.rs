//! What is certain between a place and a box: the triangles inside the shaft that segments from
//! the one to the other fill (Haines and Wallace 1991, *Shaft Culling for Efficient Ray-Traced
//! Radiosity*), and whether they leave a way through.

mod boxes;
mod cover;

use glam::Vec3;
use lie_geom::{Aabb, Triangle, edge_planes, plane_offset};
use multiversion::multiversion;

pub use self::boxes::BoxShaft;
use crate::{
    Bvh,
    block::{BLOCK, TriangleBlock},
    node::{Child, Node, Target, WIDTH},
    stack::{Stack, with_stack},
};

/// All segments from one place to a box.
///
/// Invariant: a triangle that [`lie_geom::intersect_lane`] finds on a segment from the apex to
/// a point in the box, before the point, is inside, by every test here.
#[derive(Clone, Copy, Debug)]
pub struct Shaft {
    apex: [f32; 3],
    /// Box around all of it: minima and maxima by axis.
    around: [[f32; 3]; 2],
    /// The least and the largest way from the apex to the box, by axis.
    ways: [[f32; 3]; 2],
    /// Planes along one axis each, which it lies on one side of.
    sides: [Side; SIDES],
}

/// A convex part of space, by conservative tests.
trait Volume {
    /// Box around all of it: minima and maxima by axis.
    fn around(&self) -> &[[f32; 3]; 2];

    /// Planes along one axis each, which it lies on one side of.
    fn sides(&self) -> &[Side; SIDES];

    /// Whether a triangle, by its corners and normal, may be in it.
    fn is_inside(&self, corners: [[f32; 3]; 3], normal: [f32; 3]) -> bool;

    /// The children of a node whose boxes it meets: bit `i` for child `i`.
    #[inline(always)]
    fn children(&self, node: &Node) -> u32 {
        let mut inside = [true; WIDTH];
        let [least, most] = self.around();
        for axis in 0..3 {
            let (low, high) = (&node.planes[2 * axis], &node.planes[2 * axis + 1]);
            for child in 0..WIDTH {
                inside[child] &= (low[child] <= most[axis]) & (high[child] >= least[axis]);
            }
        }
        for side in self.sides() {
            let (u, v) = (&node.planes[side.rows[0]], &node.planes[side.rows[1]]);
            for child in 0..WIDTH {
                let most = side.normal[0] * u[child] + side.normal[1] * v[child];
                // Unused children's boxes are infinite, and their sum may be undefined.
                inside[child] &= most >= side.least;
            }
        }
        let mut bits = [0; WIDTH];
        for child in 0..WIDTH {
            bits[child] = if inside[child] { 1 << child } else { 0 };
        }
        union(&bits)
    }

    /// The triangles of a block that it may meet: bit `i` for lane `i`.
    #[inline(always)]
    fn triangles(&self, block: &TriangleBlock) -> u32 {
        let mut inside = [0; BLOCK];
        for lane in 0..BLOCK {
            let (corners, normal) = block.lane(lane);
            inside[lane] = if self.is_inside(corners, normal) {
                1 << lane
            } else {
                0
            };
        }
        union(&inside)
    }
}

/// Two tangents from the apex to the box, seen along each axis.
const SIDES: usize = 6;

/// A plane through the apex and along one axis. What is inside has `normal · x ≥ least` on the
/// other two.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// For each of the two axes the row of [`Node::planes`] with a box's farthest coordinate
    /// along the normal.
    rows: [usize; 2],
    normal: [f32; 2],
    least: f32,
}

impl Shaft {
    /// The shaft from `apex` to `ends`, in a scene with these bounds.
    #[must_use]
    pub fn new(apex: Vec3, ends: Aabb, bounds: Aabb) -> Self {
        let apex = apex.to_array();
        let (min, max) = (ends.min.to_array(), ends.max.to_array());
        let mut shaft = Self {
            apex,
            around: [min, max],
            ways: [[0.0; 3]; 2],
            sides: [Side {
                rows: [0, 2],
                normal: [0.0; 2],
                least: f32::NEG_INFINITY,
            }; SIDES],
        };
        for axis in 0..3 {
            shaft.around[0][axis] = apex[axis].min(min[axis]);
            shaft.around[1][axis] = apex[axis].max(max[axis]);
            shaft.ways[0][axis] = min[axis] - apex[axis];
            shaft.ways[1][axis] = max[axis] - apex[axis];
        }
        // Coordinates of boxes are no larger: what rounding makes of them.
        let reach = |axis: usize| {
            let ends = bounds.min[axis].abs().max(bounds.max[axis].abs());
            ends.max(apex[axis].abs())
        };
        // As far beside the ends rays may be found to meet something.
        let room = 8.0 * f32::EPSILON * (0..3).map(reach).fold(0.0, f32::max);
        for axis in 0..3 {
            shaft.around[0][axis] -= room;
            shaft.around[1][axis] += room;
        }
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let tangents = tangents(
                [shaft.ways[0][u], shaft.ways[1][u]],
                [shaft.ways[0][v], shaft.ways[1][v]],
            );
            for (place, normal) in tangents.into_iter().enumerate() {
                let Some(normal) = normal else { continue };
                let room =
                    8.0 * f32::EPSILON * (normal[0].abs() * reach(u) + normal[1].abs() * reach(v));
                shaft.sides[2 * axis + place] = Side {
                    rows: [
                        2 * u + usize::from(normal[0] > 0.0),
                        2 * v + usize::from(normal[1] > 0.0),
                    ],
                    normal,
                    least: normal[0] * apex[u] + normal[1] * apex[v] - room,
                };
            }
        }
        shaft
    }

    /// Whether some segment may hit a triangle; in doubt it does.
    #[must_use]
    pub fn may_hit(&self, triangle: &Triangle) -> bool {
        let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array());
        self.is_inside(corners, triangle.normal.to_array())
    }

    /// The least and the most of a scalar product with the segments' directions.
    #[inline(always)]
    fn interval(&self, vector: [f32; 3]) -> [f32; 2] {
        let [low, high] = self.ways;
        let x = ends(vector[0] * low[0], vector[0] * high[0]);
        let y = ends(vector[1] * low[1], vector[1] * high[1]);
        let z = ends(vector[2] * low[2], vector[2] * high[2]);
        [x[0] + y[0] + z[0], x[1] + y[1] + z[1]]
    }
}

impl Volume for Shaft {
    #[inline(always)]
    fn around(&self) -> &[[f32; 3]; 2] {
        &self.around
    }

    #[inline(always)]
    fn sides(&self) -> &[Side; SIDES] {
        &self.sides
    }

    /// Rounding is monotonic, so what the operations of the triangle test make of an interval's
    /// ends bounds what they make of a ray.
    #[inline(always)]
    fn is_inside(&self, corners: [[f32; 3]; 3], normal: [f32; 3]) -> bool {
        let planes = edge_planes(corners, self.apex);
        let a = self.interval(planes[0]);
        let b = self.interval(planes[1]);
        let c = self.interval(planes[2]);
        let before = (a[0] > 0.0) | (b[0] > 0.0) | (c[0] > 0.0);
        let behind = (a[1] < 0.0) | (b[1] < 0.0) | (c[1] < 0.0);
        // It is met at `offset / along`, which must lie between 0 and 1.
        let offset = plane_offset(corners[0], normal, self.apex);
        let along = self.interval(normal);
        let reached =
            ((offset > 0.0) & (along[1] > offset)) | ((offset < 0.0) & (along[0] < offset));
        !(before & behind) & reached
    }
}

/// The normals of the lines through the origin that touch a rectangle, pointing to the side
/// that it is on. `None` where there is no such line.
fn tangents(u: [f32; 2], v: [f32; 2]) -> [Option<[f32; 2]>; 2] {
    let corners = [[u[0], v[0]], [u[1], v[0]], [u[0], v[1]], [u[1], v[1]]];
    let mut found = [None; 2];
    for (place, sign) in [1.0, -1.0].into_iter().enumerate() {
        found[place] = corners
            .iter()
            .map(|corner| [-sign * corner[1], sign * corner[0]])
            .find(|normal| {
                let side = |corner: &[f32; 2]| normal[0] * corner[0] + normal[1] * corner[1];
                *normal != [0.0; 2] && corners.iter().all(|corner| side(corner) >= 0.0)
            });
    }
    found
}

#[inline(always)]
fn ends(a: f32, b: f32) -> [f32; 2] {
    [if a < b { a } else { b }, if a < b { b } else { a }]
}

#[inline(always)]
fn union(lanes: &[u32; WIDTH]) -> u32 {
    let mut all = 0;
    for lane in lanes {
        all |= lane;
    }
    all
}

/// Adds the triangles inside a shaft to `found`, as long as there are no more than `limit` in
/// it. Says whether that is all of them.
pub(crate) fn inside(bvh: &Bvh, shaft: &Shaft, limit: usize, found: &mut Vec<u32>) -> bool {
    with_stack(|stack| inside_kernel(bvh, shaft, limit, found, stack))
}

/// The same of a shaft between boxes.
pub(crate) fn inside_boxes(
    bvh: &Bvh,
    shaft: &BoxShaft,
    limit: usize,
    found: &mut Vec<u32>,
) -> bool {
    with_stack(|stack| inside_kernel(bvh, shaft, limit, found, stack))
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn inside_kernel<V: Volume>(
    bvh: &Bvh,
    shaft: &V,
    limit: usize,
    found: &mut Vec<u32>,
    stack: &mut Stack,
) -> bool {
    stack.clear();
    if !bvh.nodes.is_empty() {
        stack.push((0.0, Child::node(0)));
    }
    while let Some((_, child)) = stack.pop() {
        match child.target() {
            Target::Node(index) => {
                let node = &bvh.nodes[index];
                let mut left = shaft.children(node);
                while left != 0 {
                    let child = left.trailing_zeros() as usize;
                    left &= left - 1;
                    if node.children[child] != Child::NONE {
                        stack.push((0.0, node.children[child]));
                    }
                }
            }
            Target::Block(index) => {
                let block = &bvh.blocks[index];
                let mut left = shaft.triangles(block);
                while left != 0 {
                    let lane = left.trailing_zeros() as usize;
                    left &= left - 1;
                    // A large one lies in several blocks.
                    let triangle = block.id(lane);
                    if found.contains(&triangle) {
                        continue;
                    }
                    if found.len() == limit {
                        return false;
                    }
                    found.push(triangle);
                }
            }
        }
    }
    true
}

#[cfg(test)]
mod tests;
