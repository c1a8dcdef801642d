use lie_geom::{LaneHit, edge_weights, plane_distance};

use super::{Lanes, PACKET, RayPacket, any, bits};

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
        let mut hit = [false; PACKET];
        for ray in 0..PACKET {
            hit[ray] = self.t[ray] < f32::INFINITY;
        }
        bits(&hit)
    }
}

impl RayPacket {
    /// All rays against one triangle, each up to its bound; `None` if none hits. Does what
    /// [`lie_geom::intersect_lane`] does, and no more than it must: most triangles are
    /// missed by every ray's line.
    /// With `FAN`, which asks for rays from one apex, what is the same for all is loop
    /// invariant: three scalar products are left for each ray. The bits are the same.
    #[inline(always)]
    pub(crate) fn intersect<const FAN: bool>(
        &self,
        (corners, normal): ([[f32; 3]; 3], [f32; 3]),
        bound: &Lanes,
    ) -> Option<PacketHits> {
        let mut hits = PacketHits {
            t: [f32::INFINITY; PACKET],
            weight_b: [0.0; PACKET],
            weight_c: [0.0; PACKET],
            sum: [0.0; PACKET],
        };
        let apex = self.apex.unwrap_or_default();
        let mut inside = [false; PACKET];
        for ray in 0..PACKET {
            let weights = edge_weights(corners, self.start::<FAN>(apex, ray), self.way(ray));
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
            let t = plane_distance(
                corners[0],
                normal,
                self.start::<FAN>(apex, ray),
                self.way(ray),
            );
            hit[ray] = inside[ray] & (t > self.t_min[ray]) & (t < bound[ray]);
            hits.t[ray] = if hit[ray] { t } else { f32::INFINITY };
        }
        any(&hit).then_some(hits)
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
