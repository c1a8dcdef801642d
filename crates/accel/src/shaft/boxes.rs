//! The shaft between two boxes.

use glam::Vec3;
use lie_geom::{Aabb, Triangle};

use super::{SIDES, Side, Volume};

/// All segments from one box to another.
///
/// Invariant: a triangle that [`lie_geom::intersect_lane`] finds on a segment between points of
/// the two is inside, by every test here.
#[derive(Clone, Copy, Debug)]
pub struct BoxShaft {
    /// Box around all of it: minima and maxima by axis.
    around: [[f32; 3]; 2],
    /// The corners of both boxes.
    corners: [Vec3; 16],
    /// Planes along one axis each, which it lies on one side of.
    sides: [Side; SIDES],
    /// What rounding may make of a distance from a plane with a unit normal, in metres.
    room: f32,
}

/// Rounding steps of the largest coordinate by which points may be off.
const STEPS: f32 = 16.0;

impl BoxShaft {
    /// The shaft from one box to another, in a scene with these bounds.
    #[must_use]
    pub fn new(from: Aabb, to: Aabb, bounds: Aabb) -> Self {
        let all = from.union(to);
        let reach = [bounds.min, bounds.max, all.min, all.max]
            .into_iter()
            .fold(0.0f32, |most, corner| most.max(corner.abs().max_element()));
        let room = STEPS * f32::EPSILON * reach;
        let mut shaft = Self {
            around: [(all.min - room).to_array(), (all.max + room).to_array()],
            corners: corners(from, to),
            sides: [Side {
                rows: [0, 2],
                normal: [0.0; 2],
                least: f32::NEG_INFINITY,
            }; SIDES],
            room,
        };
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let flat = shaft.corners.map(|corner| [corner[u], corner[v]]);
            for (place, (normal, least)) in tangents(&flat, room).into_iter().flatten().enumerate()
            {
                shaft.sides[2 * axis + place] = Side {
                    rows: [
                        2 * u + usize::from(normal[0] > 0.0),
                        2 * v + usize::from(normal[1] > 0.0),
                    ],
                    normal,
                    least: least - 2.0 * room,
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
}

impl Volume for BoxShaft {
    #[inline(always)]
    fn around(&self) -> &[[f32; 3]; 2] {
        &self.around
    }

    #[inline(always)]
    fn sides(&self) -> &[Side; SIDES] {
        &self.sides
    }

    #[inline(always)]
    fn is_inside(&self, corners: [[f32; 3]; 3], normal: [f32; 3]) -> bool {
        // Degenerate triangles, and lanes that hold none, are never hit.
        let mut inside = (normal[0] != 0.0) | (normal[1] != 0.0) | (normal[2] != 0.0);
        for axis in 0..3 {
            let [a, b, c] = [corners[0][axis], corners[1][axis], corners[2][axis]];
            inside &= a.min(b).min(c) <= self.around[1][axis];
            inside &= a.max(b).max(c) >= self.around[0][axis];
        }
        for side in &self.sides {
            let (u, v) = (side.rows[0] / 2, side.rows[1] / 2);
            let along = |at: [f32; 3]| side.normal[0] * at[u] + side.normal[1] * at[v];
            let most = along(corners[0])
                .max(along(corners[1]))
                .max(along(corners[2]));
            inside &= most >= side.least;
        }
        let (mut before, mut behind) = (false, false);
        for corner in &self.corners {
            let away = (corner.x - corners[0][0]) * normal[0]
                + (corner.y - corners[0][1]) * normal[1]
                + (corner.z - corners[0][2]) * normal[2];
            before |= away >= -self.room;
            behind |= away <= self.room;
        }
        inside & before & behind
    }
}

fn corners(from: Aabb, to: Aabb) -> [Vec3; 16] {
    std::array::from_fn(|index| {
        let bounds = if index < 8 { from } else { to };
        let pick = |axis: usize| {
            if index >> axis & 1 == 0 {
                bounds.min[axis]
            } else {
                bounds.max[axis]
            }
        };
        Vec3::new(pick(0), pick(1), pick(2))
    })
}

/// Of the lines through a corner of the first rectangle (the first eight points) and one of the
/// second, those that all points are on one side of, to within `room`: unit normals towards them, and the least that
/// any has along it.
fn tangents(points: &[[f32; 2]; 16], room: f32) -> [Option<([f32; 2], f32)>; 2] {
    let mut found = [None; 2];
    for (place, sign) in [1.0f32, -1.0].into_iter().enumerate() {
        let pairs = points[..8]
            .iter()
            .flat_map(|a| points[8..].iter().map(move |b| (a, b)));
        found[place] = pairs
            .filter_map(|(a, b)| {
                let (u, v) = (b[0] - a[0], b[1] - a[1]);
                let scale = sign / u.hypot(v);
                let normal = [-v * scale, u * scale];
                let along = |at: &[f32; 2]| normal[0] * at[0] + normal[1] * at[1];
                let least = points.iter().map(along).fold(f32::INFINITY, f32::min);
                (scale.is_finite() && least >= along(a) - room).then_some((normal, least))
            })
            .next();
    }
    found
}
