//! What holds for every ray of a packet, so that a node's eight boxes are passed over
//! together, sixteen rays at a time.

use super::{Lanes, PACKET, RayPacket};
use crate::node::{Node, WIDER, WIDTH};

/// Intervals around the rays of a packet (Boulos, Wald and Shirley 2006, *Geometric and
/// Arithmetic Culling Methods for Entire Ray Packets*).
///
/// Invariant: a box that one of the rays enters by the test of [`RayPacket::enters`] is
/// entered by the bounds, and no later. Rounding is monotonic, so the same operations on the
/// ends of an interval bound those on what is within.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PacketBounds {
    axes: [AxisBounds; 3],
    t_min: f32,
}

#[derive(Clone, Copy, Debug)]
enum AxisBounds {
    /// All rays go the same way along the axis.
    OneWay {
        /// Index of a box's plane that they meet first.
        near: usize,
        /// The origin from which that plane is nearest.
        near_origin: f32,
        /// The origin from which the other plane is farthest.
        far_origin: f32,
        /// Least and largest inverse direction.
        inverse: [f32; 2],
    },
    /// They do not: all that is known is between which coordinates they run.
    BothWays {
        /// Index of a box's lower plane.
        low: usize,
        /// Least and largest coordinate on the rays.
        run: [f32; 2],
    },
}

impl PacketBounds {
    /// The bounds of a packet's active rays; `None` if there are none.
    #[inline(always)]
    pub(crate) fn new(packet: &RayPacket, inverse: &[Lanes; 3]) -> Option<Self> {
        let t_min = packet.extremes(&packet.t_min)[0];
        if t_min == f32::INFINITY {
            return None;
        }
        // One by one: a closure would be compiled apart, without the vector unit.
        let axes = [
            AxisBounds::new(packet, inverse, 0),
            AxisBounds::new(packet, inverse, 1),
            AxisBounds::new(packet, inverse, 2),
        ];
        Some(Self { axes, t_min })
    }

    /// Where the rays enter each child's box at the soonest, or infinity: those before
    /// `farthest` alone count.
    #[inline(always)]
    pub(crate) fn entries(&self, node: &Node, farthest: f32) -> [f32; WIDTH] {
        let mut enter = [self.t_min; WIDTH];
        let mut leave = [farthest; WIDTH];
        for axis in &self.axes {
            match *axis {
                AxisBounds::OneWay {
                    near,
                    near_origin,
                    far_origin,
                    inverse,
                } => {
                    let (first, last) = (&node.planes[near], &node.planes[near ^ 1]);
                    for child in 0..WIDTH {
                        let way = first[child] - near_origin;
                        let t = smaller(way * inverse[0], way * inverse[1]);
                        enter[child] = larger(t, enter[child]);
                        let way = last[child] - far_origin;
                        let t = larger(way * inverse[0], way * inverse[1]) * WIDER;
                        leave[child] = smaller(t, leave[child]);
                    }
                }
                AxisBounds::BothWays { low, run } => {
                    let (lowest, highest) = (&node.planes[low], &node.planes[low ^ 1]);
                    for child in 0..WIDTH {
                        let apart = (lowest[child] > run[1]) | (highest[child] < run[0]);
                        enter[child] = if apart { f32::INFINITY } else { enter[child] };
                    }
                }
            }
        }
        let mut entries = [f32::INFINITY; WIDTH];
        for child in 0..WIDTH {
            if enter[child] <= leave[child] {
                entries[child] = enter[child];
            }
        }
        entries
    }
}

impl AxisBounds {
    #[inline(always)]
    fn new(packet: &RayPacket, inverse: &[Lanes; 3], axis: usize) -> Self {
        let origins = packet.extremes(&packet.origin[axis]);
        let inverses = packet.extremes(&inverse[axis]);
        if inverses[0] > 0.0 {
            Self::OneWay {
                near: 2 * axis,
                near_origin: origins[1],
                far_origin: origins[0],
                inverse: inverses,
            }
        } else if inverses[1] < 0.0 {
            Self::OneWay {
                near: 2 * axis + 1,
                near_origin: origins[0],
                far_origin: origins[1],
                inverse: inverses,
            }
        } else {
            Self::BothWays {
                low: 2 * axis,
                run: Self::run(packet, axis),
            }
        }
    }

    /// Between which coordinates the rays run, with room for rounding.
    #[inline(always)]
    fn run(packet: &RayPacket, axis: usize) -> [f32; 2] {
        const ROOM: f32 = 16.0 * f32::EPSILON;
        let (start, direction) = (&packet.origin[axis], &packet.direction[axis]);
        let mut ends = [[0.0; PACKET]; 2];
        let mut starts = [[0.0; PACKET]; 2];
        for lane in 0..PACKET {
            let room = |way: f32| ROOM * (start[lane].abs() + smaller(way.abs(), f32::MAX));
            // Nowhere times for ever is nowhere.
            let way = |t: f32| {
                if direction[lane] == 0.0 {
                    0.0
                } else {
                    direction[lane] * t
                }
            };
            let (near, far) = (way(packet.t_min[lane]), way(packet.t_max[lane]));
            starts[0][lane] = start[lane] + near - room(near);
            starts[1][lane] = start[lane] + near + room(near);
            ends[0][lane] = start[lane] + far - room(far);
            ends[1][lane] = start[lane] + far + room(far);
        }
        [
            smaller(packet.extremes(&starts[0])[0], packet.extremes(&ends[0])[0]),
            larger(packet.extremes(&starts[1])[1], packet.extremes(&ends[1])[1]),
        ]
    }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
