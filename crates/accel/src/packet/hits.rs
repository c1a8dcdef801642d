use fearless_simd::prelude::*;
use lie_geom::LaneHit;

use super::vector::{Wide, WideMask};

/// Where the rays of a packet meet one triangle.
#[derive(Clone, Copy)]
pub(crate) struct PacketHits<S: Simd> {
    /// The rays that hit it; what follows is theirs alone.
    pub(crate) rays: WideMask<S>,
    pub(crate) t: Wide<S>,
    pub(crate) weight_b: Wide<S>,
    pub(crate) weight_c: Wide<S>,
    pub(crate) sum: Wide<S>,
}

impl<S: Simd> PacketHits<S> {
    /// No ray hits anything.
    #[inline(always)]
    pub(crate) fn none(simd: S) -> Self {
        let zero = Wide::splat(simd, 0.0);
        Self {
            rays: WideMask::splat(simd, false),
            t: Wide::splat(simd, f32::INFINITY),
            weight_b: zero,
            weight_c: zero,
            sum: zero,
        }
    }

    /// One ray's hit.
    #[inline(always)]
    pub(crate) fn lane(&self, ray: usize) -> LaneHit {
        LaneHit {
            t: self.t[ray],
            weight_b: self.weight_b[ray],
            weight_c: self.weight_c[ray],
            sum: self.sum[ray],
        }
    }

    /// Takes over some rays' hits.
    #[inline(always)]
    pub(crate) fn take(&mut self, rays: WideMask<S>, hits: &Self) {
        self.rays |= rays;
        self.t = rays.select(hits.t, self.t);
        self.weight_b = rays.select(hits.weight_b, self.weight_b);
        self.weight_c = rays.select(hits.weight_c, self.weight_c);
        self.sum = rays.select(hits.sum, self.sum);
    }
}
