//! A packet's rays against the box of a node's child, ray by ray.

use fearless_simd::prelude::*;

use super::{
    rays::{Ahead, Rays},
    vector::Wide,
};
use crate::node::{Node, WIDER};

/// How a packet's rays go, as far as it is known when the kernel is compiled.
pub(crate) trait Course {
    /// Whether all of them start at one apex.
    const FAN: bool;
    /// Whether all of them go the same way along each axis.
    const ONE_WAY: bool;
}

/// [`Course`] by its two constants.
pub(crate) struct Going<const FAN: bool, const ONE_WAY: bool>;

impl<const FAN: bool, const ONE_WAY: bool> Course for Going<FAN, ONE_WAY> {
    const FAN: bool = FAN;
    const ONE_WAY: bool = ONE_WAY;
}

/// What the slab test needs of sixteen rays.
pub(crate) struct SlabRays<S: Simd> {
    simd: S,
    start: [Wide<S>; 3],
    apex: [f32; 3],
    inverse: [Wide<S>; 3],
    /// The same, somewhat larger: where rays leave.
    wider: [Wide<S>; 3],
    t_min: Wide<S>,
    /// The planes that all rays meet first, by axis, if they go one way.
    near: [usize; 3],
}

impl<S: Simd> SlabRays<S> {
    #[inline(always)]
    pub(crate) fn new(rays: &Rays<S>, inverse: &[Wide<S>; 3], near: Option<[usize; 3]>) -> Self {
        let [x, y, z] = *inverse;
        Self {
            simd: rays.simd,
            start: rays.start,
            apex: rays.apex,
            inverse: *inverse,
            wider: [x * WIDER, y * WIDER, z * WIDER],
            t_min: rays.t_min,
            near: near.unwrap_or([0, 2, 4]),
        }
    }

    /// Whether any ray enters a child's box before its bound.
    #[inline(always)]
    pub(crate) fn enter<C: Course>(&self, node: &Node, child: usize, ahead: &Ahead<S>) -> bool {
        let mut enter = self.t_min;
        let mut leave = ahead.bound;
        for axis in 0..3 {
            let way = |plane: usize| {
                let plane = node.planes[plane][child];
                if C::FAN {
                    Wide::splat(self.simd, plane - self.apex[axis])
                } else {
                    Wide::splat(self.simd, plane) - self.start[axis]
                }
            };
            let (inverse, wider) = (self.inverse[axis], self.wider[axis]);
            let first = way(self.near[axis]);
            let last = way(self.near[axis] ^ 1);
            if C::ONE_WAY {
                enter = (first * inverse).max(enter);
                leave = (last * wider).min(leave);
            } else {
                enter = (first * inverse).min(last * inverse).max(enter);
                leave = (first * wider).max(last * wider).min(leave);
            }
        }
        enter.simd_le(leave).any_true()
    }
}
