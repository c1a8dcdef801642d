//! What holds for every ray of a packet, so that a node's eight boxes are passed over
//! together, sixteen rays at a time.

use fearless_simd::{f32x8, prelude::*};

use super::{
    rays::{Ahead, Rays},
    vector::{Wide, extremes},
};
use crate::node::{Node, WIDER, WIDTH};

/// One number for each child of a node.
type Children<S> = f32x8<S>;

/// Intervals around the rays of a packet (Boulos, Wald and Shirley 2006, *Geometric and
/// Arithmetic Culling Methods for Entire Ray Packets*).
///
/// Invariant: a box that one of the rays enters by the test of [`SlabRays::enter`](super::slab::SlabRays::enter) is
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
        /// The same, somewhat larger.
        wider: [f32; 2],
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
    pub(crate) fn new<S: Simd>(
        rays: &Rays<S>,
        inverse: &[Wide<S>; 3],
        ahead: &Ahead<S>,
    ) -> Option<Self> {
        let t_min = extremes(rays.simd, rays.t_min, ahead.active)[0];
        if t_min == f32::INFINITY {
            return None;
        }
        let axes = [
            AxisBounds::new(rays, inverse, ahead, 0),
            AxisBounds::new(rays, inverse, ahead, 1),
            AxisBounds::new(rays, inverse, ahead, 2),
        ];
        Some(Self { axes, t_min })
    }

    /// The planes of a box that all rays meet first, by axis, as of [`Node`]; `None` if they do
    /// not all go the same ways.
    #[inline(always)]
    pub(crate) fn near(&self) -> Option<[usize; 3]> {
        let near = |axis: usize| match self.axes[axis] {
            AxisBounds::OneWay { near, .. } => Some(near),
            AxisBounds::BothWays { .. } => None,
        };
        Some([near(0)?, near(1)?, near(2)?])
    }

    /// Where the rays enter each child's box at the soonest, and which they may enter before
    /// `farthest`: bit `i` for child `i`.
    #[inline(always)]
    pub(crate) fn entries<S: Simd>(
        &self,
        simd: S,
        node: &Node,
        farthest: f32,
    ) -> ([f32; WIDTH], u32) {
        let plane = |index: usize| Children::simd_from(simd, node.planes[index]);
        let mut enter = Children::splat(simd, self.t_min);
        let mut leave = Children::splat(simd, farthest);
        for axis in &self.axes {
            match *axis {
                AxisBounds::OneWay {
                    near,
                    near_origin,
                    far_origin,
                    inverse,
                    wider,
                } => {
                    let way = plane(near) - near_origin;
                    enter = (way * inverse[0]).min(way * inverse[1]).max(enter);
                    let way = plane(near ^ 1) - far_origin;
                    let t = (way * wider[0]).max(way * wider[1]);
                    leave = t.min(leave);
                }
                AxisBounds::BothWays { low, run } => {
                    let apart = plane(low).simd_gt(run[1]) | plane(low ^ 1).simd_lt(run[0]);
                    enter = apart.select(Children::splat(simd, f32::INFINITY), enter);
                }
            }
        }
        let entered = enter.simd_le(leave) & enter.simd_lt(f32::INFINITY);
        (enter.into(), entered.to_bitmask() as u32)
    }
}

impl AxisBounds {
    #[inline(always)]
    fn new<S: Simd>(rays: &Rays<S>, inverse: &[Wide<S>; 3], ahead: &Ahead<S>, axis: usize) -> Self {
        let origins = extremes(rays.simd, rays.start[axis], ahead.active);
        let inverses = extremes(rays.simd, inverse[axis], ahead.active);
        let wider = inverses.map(|inverse| inverse * WIDER);
        if inverses[0] > 0.0 {
            Self::OneWay {
                near: 2 * axis,
                near_origin: origins[1],
                far_origin: origins[0],
                inverse: inverses,
                wider,
            }
        } else if inverses[1] < 0.0 {
            Self::OneWay {
                near: 2 * axis + 1,
                near_origin: origins[0],
                far_origin: origins[1],
                inverse: inverses,
                wider,
            }
        } else {
            Self::BothWays {
                low: 2 * axis,
                run: Self::run(rays, ahead, axis),
            }
        }
    }

    /// Between which coordinates the rays run, with room for rounding.
    #[inline(always)]
    fn run<S: Simd>(rays: &Rays<S>, ahead: &Ahead<S>, axis: usize) -> [f32; 2] {
        const ROOM: f32 = 16.0 * f32::EPSILON;
        let (start, direction) = (rays.start[axis], rays.way[axis]);
        let zero = Wide::splat(rays.simd, 0.0);
        let stands = direction.simd_eq(0.0);
        let run = |t: Wide<S>| {
            // Nowhere times for ever is nowhere.
            let way = stands.select(zero, direction * t);
            let room = (start.abs() + way.abs().min(f32::MAX)) * ROOM;
            let end = start + way;
            let least = extremes(rays.simd, end - room, ahead.active)[0];
            let most = extremes(rays.simd, end + room, ahead.active)[1];
            [least, most]
        };
        let (near, far) = (run(rays.t_min), run(ahead.bound));
        [near[0].min(far[0]), near[1].max(far[1])]
    }
}
