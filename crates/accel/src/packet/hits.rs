use lie_geom::{EdgeWeights, LaneHit, edge_weights, plane_distance, weights_of};

use super::{Lanes, PACKET, RayPacket, any, union};

/// Where the rays of a packet meet one triangle.
pub(crate) struct PacketHits {
    /// Infinite where a ray misses.
    pub(crate) t: Lanes,
    pub(crate) weight_b: Lanes,
    pub(crate) weight_c: Lanes,
    pub(crate) sum: Lanes,
}

impl PacketHits {
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
    pub(crate) fn take(&mut self, rays: &[bool; PACKET], hits: &Self) {
        let Self {
            t,
            weight_b,
            weight_c,
            sum,
        } = self;
        blend(t, rays, &hits.t);
        blend(weight_b, rays, &hits.weight_b);
        blend(weight_c, rays, &hits.weight_c);
        blend(sum, rays, &hits.sum);
    }

    /// The rays that hit: bit `i` for ray `i`.
    #[inline(always)]
    pub(crate) fn mask(&self) -> u32 {
        let mut hit = [0; PACKET];
        for ray in 0..PACKET {
            let is_hit = self.t[ray] < f32::INFINITY;
            hit[ray] = if is_hit { 1 << ray } else { 0 };
        }
        union(&hit)
    }
}

impl RayPacket {
    /// All rays against one triangle, each up to its bound; `None` if none hits. Does what
    /// [`lie_geom::intersect_lane`] does, and no more than it must: most triangles are
    /// missed by every ray's line.
    #[inline(always)]
    pub(crate) fn intersect(
        &self,
        (corners, normal): ([[f32; 3]; 3], [f32; 3]),
        bound: &Lanes,
    ) -> Option<PacketHits> {
        let start = |ray: usize| self.start::<false>([0.0; 3], ray);
        self.test(
            bound,
            |ray| edge_weights(corners, start(ray), self.way(ray)),
            |ray| plane_distance(corners[0], normal, start(ray), self.way(ray)),
        )
    }

    #[inline(always)]
    fn test(
        &self,
        bound: &Lanes,
        weights: impl Fn(usize) -> EdgeWeights,
        distance: impl Fn(usize) -> f32,
    ) -> Option<PacketHits> {
        let mut hits = PacketHits {
            t: [f32::INFINITY; PACKET],
            weight_b: [0.0; PACKET],
            weight_c: [0.0; PACKET],
            sum: [0.0; PACKET],
        };
        let mut inside = [false; PACKET];
        for ray in 0..PACKET {
            let weights = weights(ray);
            inside[ray] = weights.inside() & (bound[ray] > f32::NEG_INFINITY);
            hits.weight_b[ray] = weights.b;
            hits.weight_c[ray] = weights.c;
            hits.sum[ray] = weights.sum();
        }
        if !any(&inside) {
            return None;
        }
        let mut hit = [false; PACKET];
        for ray in 0..PACKET {
            let t = distance(ray);
            hit[ray] = inside[ray] & (t > self.t_min[ray]) & (t < bound[ray]);
            hits.t[ray] = if hit[ray] { t } else { f32::INFINITY };
        }
        any(&hit).then_some(hits)
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
        bound: &Lanes,
    ) -> Option<PacketHits> {
        self.test(
            bound,
            |ray| weights_of(edges, self.way(ray)),
            |ray| offset / dot(normal, self.way(ray)),
        )
    }

    /// The rays that [`Self::intersect_from`] finds to hit: bit `i` for ray `i`.
    #[inline(always)]
    pub(crate) fn hit_from(
        &self,
        edges: [[f32; 3]; 3],
        normal: [f32; 3],
        offset: f32,
        bound: &Lanes,
    ) -> u32 {
        let mut inside = [0; PACKET];
        for ray in 0..PACKET {
            let is_inside = weights_of(edges, self.way(ray)).inside();
            inside[ray] = if is_inside & (bound[ray] > f32::NEG_INFINITY) {
                1 << ray
            } else {
                0
            };
        }
        let inside = union(&inside);
        if inside == 0 {
            return 0;
        }
        let mut hit = [0; PACKET];
        for ray in 0..PACKET {
            let t = offset / dot(normal, self.way(ray));
            let is_hit = (t > self.t_min[ray]) & (t < bound[ray]);
            hit[ray] = if is_hit { 1 << ray } else { 0 };
        }
        union(&hit) & inside
    }

    #[inline(always)]
    fn way(&self, ray: usize) -> [f32; 3] {
        [
            self.direction[0][ray],
            self.direction[1][ray],
            self.direction[2][ray],
        ]
    }
}

#[inline(always)]
fn blend(values: &mut Lanes, lanes: &[bool; PACKET], news: &Lanes) {
    for lane in 0..PACKET {
        values[lane] = if lanes[lane] {
            news[lane]
        } else {
            values[lane]
        };
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
