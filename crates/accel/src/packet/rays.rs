//! A packet's rays in registers, against boxes and triangles.

use fearless_simd::prelude::*;
use lie_geom::{EdgeWeights, dot, edge_weights, plane_offset, weights_of};

use super::{
    RayPacket,
    hits::PacketHits,
    vector::{Wide, WideMask, extremes, load, load_axes, mask_of, splat_axes},
};
use crate::node::LARGEST_INVERSE;

/// Sixteen rays.
#[derive(Clone, Copy)]
pub(crate) struct Rays<S: Simd> {
    pub(crate) simd: S,
    pub(crate) start: [Wide<S>; 3],
    pub(crate) way: [Wide<S>; 3],
    pub(crate) t_min: Wide<S>,
    /// Where all of them start, if they do.
    pub(crate) apex: [f32; 3],
}

/// How far each ray still looks.
#[derive(Clone, Copy)]
pub(crate) struct Ahead<S: Simd> {
    /// Nothing from here on counts.
    pub(crate) bound: Wide<S>,
    /// Rays that look for anything. The others' bounds are below everything.
    pub(crate) active: WideMask<S>,
}

impl<S: Simd> Ahead<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, packet: &RayPacket) -> Self {
        let bound = load(simd, &packet.t_max);
        Self {
            bound,
            active: bound.simd_gt(f32::NEG_INFINITY),
        }
    }

    /// Some rays look for nothing any more.
    #[inline(always)]
    pub(crate) fn finish(&mut self, simd: S, rays: u32) {
        let rays = mask_of(simd, rays);
        self.bound = rays.select(Wide::splat(simd, f32::NEG_INFINITY), self.bound);
        self.active &= !rays;
    }
}

impl<S: Simd> Rays<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, packet: &RayPacket) -> Self {
        Self {
            simd,
            start: load_axes(simd, &packet.origin),
            way: load_axes(simd, &packet.direction),
            t_min: load(simd, &packet.t_min),
            apex: packet.apex.unwrap_or_default(),
        }
    }

    /// One over each direction, as of [`crate::node::inverse`].
    #[inline(always)]
    pub(crate) fn inverse(&self) -> [Wide<S>; 3] {
        let most = Wide::splat(self.simd, LARGEST_INVERSE);
        let one = Wide::splat(self.simd, 1.0);
        let inverse = |axis: usize| (one / self.way[axis]).min(most).max(-most);
        [inverse(0), inverse(1), inverse(2)]
    }

    /// The least and the largest direction of some rays, by axis.
    #[inline(always)]
    pub(crate) fn ways(&self, rays: WideMask<S>) -> [[f32; 3]; 2] {
        let [x, y, z] = self.way;
        let x = extremes(self.simd, x, rays);
        let y = extremes(self.simd, y, rays);
        let z = extremes(self.simd, z, rays);
        [[x[0], y[0], z[0]], [x[1], y[1], z[1]]]
    }

    /// All rays against one triangle; `None` if none hits. Does what
    /// [`lie_geom::intersect_lane`] does, and no more than it must: most triangles are
    /// missed by every ray's line.
    #[inline(always)]
    pub(crate) fn intersect(
        &self,
        (corners, normal): ([[f32; 3]; 3], [f32; 3]),
        ahead: &Ahead<S>,
    ) -> Option<PacketHits<S>> {
        let simd = self.simd;
        let corners = [
            splat_axes(simd, corners[0]),
            splat_axes(simd, corners[1]),
            splat_axes(simd, corners[2]),
        ];
        let normal = splat_axes(simd, normal);
        let weights = edge_weights(corners, self.start, self.way);
        self.hits(weights, ahead, || {
            plane_offset(corners[0], normal, self.start) / dot(normal, self.way)
        })
    }

    /// The same for rays that start at one apex, against a triangle of which is known what they
    /// have in common: the planes through its edges, its normal and its plane's offset. Three
    /// scalar products are left for each ray. The bits are the same.
    #[inline(always)]
    pub(crate) fn intersect_from(
        &self,
        edges: [[f32; 3]; 3],
        normal: [f32; 3],
        offset: f32,
        ahead: &Ahead<S>,
    ) -> Option<PacketHits<S>> {
        let simd = self.simd;
        let edges = [
            splat_axes(simd, edges[0]),
            splat_axes(simd, edges[1]),
            splat_axes(simd, edges[2]),
        ];
        self.hits(weights_of(edges, self.way), ahead, || {
            Wide::splat(simd, offset) / dot(splat_axes(simd, normal), self.way)
        })
    }

    #[inline(always)]
    fn hits(
        &self,
        weights: EdgeWeights<Wide<S>>,
        ahead: &Ahead<S>,
        distance: impl FnOnce() -> Wide<S>,
    ) -> Option<PacketHits<S>> {
        let sum = weights.sum();
        let inside = inside(&weights, sum) & ahead.active;
        if !inside.any_true() {
            return None;
        }
        let t = distance();
        let rays = inside & t.simd_gt(self.t_min) & t.simd_lt(ahead.bound);
        rays.any_true().then_some(PacketHits {
            rays,
            t,
            weight_b: weights.b,
            weight_c: weights.c,
            sum,
        })
    }
}

/// [`EdgeWeights::inside`] in lanes: where all weights have one sign, so does their sum, and
/// where one is undefined, so is that.
#[inline(always)]
fn inside<S: Simd>(weights: &EdgeWeights<Wide<S>>, sum: Wide<S>) -> WideMask<S> {
    let least = weights.a.min(weights.b).min(weights.c);
    let most = weights.a.max(weights.b).max(weights.c);
    (least.simd_ge(0.0) & sum.simd_gt(0.0)) | (most.simd_le(0.0) & sum.simd_lt(0.0))
}
