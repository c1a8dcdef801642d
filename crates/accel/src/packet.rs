//! Sixteen rays through the tree together: each box and each triangle is loaded once and
//! tested against all of them.

use lie_geom::{Hit, LaneHit, Ray, SHADOW_T_MAX, Triangle, intersect_lane};
use multiversion::multiversion;

use crate::{
    Bvh, Cutout,
    block::TriangleBlock,
    node::{Child, Node, Target, WIDER, WIDTH, inverse},
};

/// Rays per packet.
pub const PACKET: usize = 16;

/// Sixteen rays, one coordinate after the other. Coherent ones (a tile of pixels, or many
/// points towards one light) pay off; any others are still right.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct RayPacket {
    origin: [[f32; PACKET]; 3],
    direction: [[f32; PACKET]; 3],
    inverse: [[f32; PACKET]; 3],
    t_min: [f32; PACKET],
    t_max: [f32; PACKET],
}

impl RayPacket {
    /// A packet of up to sixteen rays; the lanes left over hit nothing.
    ///
    /// # Panics
    /// If there are more than sixteen.
    #[must_use]
    pub fn new(rays: &[Ray]) -> Self {
        assert!(rays.len() <= PACKET, "a packet holds {PACKET} rays");
        let mut packet = Self {
            origin: [[0.0; PACKET]; 3],
            direction: [[0.0; PACKET]; 3],
            inverse: [[0.0; PACKET]; 3],
            t_min: [0.0; PACKET],
            t_max: [f32::NEG_INFINITY; PACKET],
        };
        for (lane, ray) in rays.iter().enumerate() {
            packet.set(lane, ray);
        }
        packet
    }

    /// One lane's ray; that of a lane left over is undefined, and hits nothing.
    pub(crate) fn ray(&self, lane: usize) -> Ray {
        let [origin, direction] =
            [&self.origin, &self.direction].map(|axes| axes.map(|axis| axis[lane]).into());
        Ray {
            origin,
            direction,
            t_min: self.t_min[lane],
            t_max: self.t_max[lane],
        }
    }

    fn set(&mut self, lane: usize, ray: &Ray) {
        let inverse = inverse(ray.direction);
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
            self.inverse[axis][lane] = inverse[axis];
        }
        self.t_min[lane] = ray.t_min;
        // An undefined ray would poison comparisons; it hits nothing.
        self.t_max[lane] = if ray.is_defined() {
            ray.t_max
        } else {
            f32::NEG_INFINITY
        };
    }

    /// The closest entry of any lane into a box, and whether there is one.
    #[inline(always)]
    fn enter(&self, (lowest, highest): ([f32; 3], [f32; 3]), t_max: &[f32; PACKET]) -> f32 {
        let mut entries = [0.0; PACKET];
        for lane in 0..PACKET {
            let mut enter = self.t_min[lane];
            let mut leave = t_max[lane];
            for axis in 0..3 {
                let t0 = (lowest[axis] - self.origin[axis][lane]) * self.inverse[axis][lane];
                let t1 = (highest[axis] - self.origin[axis][lane]) * self.inverse[axis][lane];
                let (near, far) = (if t0 < t1 { t0 } else { t1 }, if t0 < t1 { t1 } else { t0 });
                enter = if near > enter { near } else { enter };
                leave = if far * WIDER < leave {
                    far * WIDER
                } else {
                    leave
                };
            }
            entries[lane] = if enter <= leave { enter } else { f32::INFINITY };
        }
        let mut nearest = f32::INFINITY;
        for entry in entries {
            nearest = if entry < nearest { entry } else { nearest };
        }
        nearest
    }

    /// The segments from sixteen places to one target ([`Ray::segment`]). Only the lanes
    /// whose bits are set hit anything.
    #[must_use]
    #[inline]
    pub fn segments(origin: &[[f32; PACKET]; 3], target: [f32; 3], lanes: u32) -> Self {
        let mut packet = Self::new(&[]);
        packet.origin = *origin;
        for lane in 0..PACKET {
            let direction: [f32; 3] = std::array::from_fn(|axis| target[axis] - origin[axis][lane]);
            let inverse = inverse(direction.into());
            for axis in 0..3 {
                packet.direction[axis][lane] = direction[axis];
                packet.inverse[axis][lane] = inverse[axis];
            }
            if lanes >> lane & 1 == 1 {
                packet.t_max[lane] = SHADOW_T_MAX;
            }
        }
        packet
    }

    /// Which rays one triangle blocks, were it solid: bit `i` for ray `i`.
    #[must_use]
    pub fn blocked_by(&self, triangle: &Triangle) -> u32 {
        blocked_by(self, triangle)
    }

    /// Which rays any of some triangles of `all` blocks, given by their indices. `cutout`
    /// says where triangles have holes; `None` means nowhere.
    #[must_use]
    pub fn blocked_by_any(
        &self,
        all: &[Triangle],
        indices: &[u32],
        cutout: Option<&dyn Cutout>,
    ) -> u32 {
        blocked_by_any(self, all, indices, cutout)
    }

    /// All lanes against one triangle.
    #[inline(always)]
    fn intersect(
        &self,
        (corners, normal): ([[f32; 3]; 3], [f32; 3]),
        t_max: &[f32; PACKET],
    ) -> PacketHits {
        let mut hits = PacketHits {
            t: [0.0; PACKET],
            weight_b: [0.0; PACKET],
            weight_c: [0.0; PACKET],
            sum: [0.0; PACKET],
        };
        for ray in 0..PACKET {
            let origin = [
                self.origin[0][ray],
                self.origin[1][ray],
                self.origin[2][ray],
            ];
            let direction = [
                self.direction[0][ray],
                self.direction[1][ray],
                self.direction[2][ray],
            ];
            let hit = intersect_lane(
                corners,
                normal,
                origin,
                direction,
                self.t_min[ray],
                t_max[ray],
            );
            hits.t[ray] = hit.t;
            hits.weight_b[ray] = hit.weight_b;
            hits.weight_c[ray] = hit.weight_c;
            hits.sum[ray] = hit.sum;
        }
        hits
    }
}

struct PacketHits {
    t: [f32; PACKET],
    weight_b: [f32; PACKET],
    weight_c: [f32; PACKET],
    sum: [f32; PACKET],
}

impl PacketHits {
    #[inline(always)]
    fn lane(&self, ray: usize) -> LaneHit {
        LaneHit {
            t: self.t[ray],
            weight_b: self.weight_b[ray],
            weight_c: self.weight_c[ray],
            sum: self.sum[ray],
        }
    }

    #[inline(always)]
    fn any(&self) -> bool {
        let mut nearest = f32::INFINITY;
        for t in self.t {
            nearest = if t < nearest { t } else { nearest };
        }
        nearest < f32::INFINITY
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
pub(crate) fn closest(bvh: &Bvh, packet: &RayPacket) -> [Option<Hit>; PACKET] {
    let mut best: [Option<(LaneHit, u32)>; PACKET] = [None; PACKET];
    traverse(bvh, packet, |block, lane, hits, bound| {
        let id = block.id(lane);
        for ray in 0..PACKET {
            let hit = hits.lane(ray);
            let closer = best[ray]
                .is_none_or(|(old, old_id)| hit.t < old.t || (hit.t == old.t && id < old_id));
            if hit.t < f32::INFINITY && closer && block.is_solid(lane, hit, bvh.cutout.as_deref()) {
                best[ray] = Some((hit, id));
                // One step past the best distance, so that ties are seen.
                bound[ray] = hit.t.next_up();
            }
        }
    });
    best.map(|found| {
        found.map(|(hit, triangle)| {
            let hit = hit.hit();
            Hit {
                t: hit.t,
                u: hit.u,
                v: hit.v,
                triangle,
            }
        })
    })
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
pub(crate) fn blocked(bvh: &Bvh, packet: &RayPacket) -> u32 {
    let mut blocked = 0u32;
    traverse(bvh, packet, |block, lane, hits, bound| {
        for ray in 0..PACKET {
            let hit = hits.lane(ray);
            if hit.t < f32::INFINITY && block.is_solid(lane, hit, bvh.cutout.as_deref()) {
                blocked |= 1 << ray;
                // It enters and hits nothing more.
                bound[ray] = f32::NEG_INFINITY;
            }
        }
    });
    blocked
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
pub(crate) fn blockers(bvh: &Bvh, packet: &RayPacket) -> [Option<u32>; PACKET] {
    let mut blockers = [None; PACKET];
    traverse(bvh, packet, |block, lane, hits, bound| {
        for ray in 0..PACKET {
            let hit = hits.lane(ray);
            if hit.t < f32::INFINITY && block.is_solid(lane, hit, bvh.cutout.as_deref()) {
                blockers[ray] = Some(block.id(lane));
                bound[ray] = f32::NEG_INFINITY;
            }
        }
    });
    blockers
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blocked_by_any(
    packet: &RayPacket,
    all: &[Triangle],
    indices: &[u32],
    cutout: Option<&dyn Cutout>,
) -> u32 {
    let mut bound = packet.t_max;
    let mut blocked = 0u32;
    for &index in indices {
        let Some(triangle) = all.get(index as usize) else {
            continue;
        };
        let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array());
        let hits = packet.intersect((corners, triangle.normal.to_array()), &bound);
        if !hits.any() {
            continue;
        }
        let holes = cutout.filter(|cutout| cutout.has_holes(index));
        for ray in 0..PACKET {
            let hit = hits.lane(ray);
            let is_solid = |cutout: &dyn Cutout| {
                let weights = hit.hit();
                cutout.is_solid(index, weights.u, weights.v)
            };
            if hit.t < f32::INFINITY && holes.is_none_or(is_solid) {
                blocked |= 1 << ray;
                bound[ray] = f32::NEG_INFINITY;
            }
        }
        if !farther_than(&bound, f32::NEG_INFINITY) {
            break;
        }
    }
    blocked
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blocked_by(packet: &RayPacket, triangle: &Triangle) -> u32 {
    let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array());
    let hits = packet.intersect((corners, triangle.normal.to_array()), &packet.t_max);
    let mut blocked = 0;
    for ray in 0..PACKET {
        blocked |= u32::from(hits.t[ray] < f32::INFINITY) << ray;
    }
    blocked
}

/// Takes a packet through the tree, nearest box first, and calls `found` with every triangle
/// that some lane hits before its bound; `found` lowers the bounds.
#[inline(always)]
fn traverse(
    bvh: &Bvh,
    packet: &RayPacket,
    mut found: impl FnMut(&TriangleBlock, usize, &PacketHits, &mut [f32; PACKET]),
) {
    let mut bound = packet.t_max;
    let mut stack: Vec<(f32, Child)> = Vec::with_capacity(128);
    stack.push((f32::NEG_INFINITY, Child::node(0)));
    while let Some((entry, child)) = stack.pop() {
        if !farther_than(&bound, entry) {
            continue;
        }
        match child.target() {
            Target::Node(index) => push_entered(&bvh.nodes[index], packet, &bound, &mut stack),
            Target::Block(index) => {
                let block = &bvh.blocks[index];
                for lane in 0..block.len() {
                    let hits = packet.intersect(block.lane(lane), &bound);
                    if hits.any() {
                        found(block, lane, &hits, &mut bound);
                    }
                }
            }
        }
    }
}

/// Whether any lane still looks farther than `entry`.
#[inline(always)]
fn farther_than(bound: &[f32; PACKET], entry: f32) -> bool {
    let mut farthest = f32::NEG_INFINITY;
    for &t in bound {
        farthest = if t > farthest { t } else { farthest };
    }
    farthest > entry
}

/// Pushes the children that any lane enters, so that the nearest is popped first.
#[inline(always)]
fn push_entered(
    node: &Node,
    packet: &RayPacket,
    bound: &[f32; PACKET],
    stack: &mut Vec<(f32, Child)>,
) {
    let base = stack.len();
    for lane in 0..WIDTH {
        let child = node.children[lane];
        if child == Child::NONE {
            break;
        }
        let entry = packet.enter(node.bounds(lane), bound);
        if entry < f32::INFINITY {
            stack.push((entry, child));
            let mut place = stack.len() - 1;
            while place > base && stack[place - 1].0 < entry {
                stack.swap(place, place - 1);
                place -= 1;
            }
        }
    }
}
