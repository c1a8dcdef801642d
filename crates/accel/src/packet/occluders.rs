//! Packets against short lists of triangles, without a tree: what is left of a shadow ray
//! where it is known what may be in the way.

use lie_geom::{Aabb, Triangle, plane_offset};
use multiversion::multiversion;

use super::{
    Lanes, PACKET, RayPacket,
    fan_planes::{FanPlanes, all_at, at},
    finish,
    hits::PacketHits,
};
use crate::Cutout;

/// Triangles that lists name, sixteen to a block: what a list asks of them is asked of a
/// whole block at once. Many lists share them.
#[derive(Clone, Debug, Default)]
pub struct OccluderBlocks {
    blocks: Vec<Block>,
    len: usize,
}

/// Sixteen triangles, one coordinate after the other. A place left over is degenerate:
/// nothing hits it.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Block {
    corners: [[Lanes; 3]; 3],
    normal: [Lanes; 3],
    /// The triangles' numbers in the scene.
    indices: [u32; PACKET],
}

/// Some triangles of one block: a part of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockPart {
    /// Index of the block.
    pub block: u32,
    /// Which of its triangles: bit `i` for the `i`th.
    pub places: u16,
}

/// A list of triangles as a light without extent sees it: what all rays from there have in
/// common is worked out. Made once, it serves every packet from that place.
#[derive(Clone, Debug, Default)]
pub struct FanOccluders {
    apex: [f32; 3],
    parts: Vec<FanPart>,
}

#[derive(Clone, Debug)]
#[repr(align(64))]
struct FanPart {
    seen: FanPlanes<PACKET>,
    normal: [Lanes; 3],
    /// As of [`plane_offset`].
    offset: Lanes,
    indices: [u32; PACKET],
    places: u32,
}

impl OccluderBlocks {
    /// Makes these the triangles, with their numbers in the scene: the `i`th is place `i % 16`
    /// of block `i / 16`. As many as both have.
    pub fn fill(&mut self, indices: &[u32], triangles: &[Triangle]) {
        self.len = indices.len().min(triangles.len());
        self.blocks.clear();
        let chunks = indices.chunks(PACKET).zip(triangles.chunks(PACKET));
        self.blocks.extend(chunks.map(|(indices, triangles)| {
            let mut block = Block {
                corners: [[[0.0; PACKET]; 3]; 3],
                normal: [[0.0; PACKET]; 3],
                indices: [u32::MAX; PACKET],
            };
            for (place, (&index, triangle)) in indices.iter().zip(triangles).enumerate() {
                block.indices[place] = index;
                for axis in 0..3 {
                    block.corners[0][axis][place] = triangle.a[axis];
                    block.corners[1][axis][place] = triangle.b[axis];
                    block.corners[2][axis][place] = triangle.c[axis];
                    block.normal[axis][place] = triangle.normal[axis];
                }
            }
            block
        }));
    }

    /// How many triangles there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

impl FanOccluders {
    /// Makes this the list `parts` of some blocks, seen from `apex`. Parts that name no block are
    /// passed over.
    #[inline]
    pub fn look_from(&mut self, apex: [f32; 3], blocks: &OccluderBlocks, parts: &[BlockPart]) {
        self.apex = apex;
        self.parts.clear();
        look_from(&mut self.parts, apex, &blocks.blocks, parts);
    }
}

impl RayPacket {
    /// Which rays any triangle of a list blocks: bit `i` for ray `i`. All rays must start
    /// where the list is seen from ([`Self::fan`]) and end in the box `ends`. `cutout` says where
    /// triangles have holes; `None` means nowhere.
    #[must_use]
    #[inline]
    pub fn blocked_by_fan(
        &self,
        list: &FanOccluders,
        ends: Aabb,
        cutout: Option<&dyn Cutout>,
    ) -> u32 {
        blocked_by_fan(self, list, ends, cutout)
    }

    /// Which rays any triangle of a list blocks, wherever they start.
    #[must_use]
    #[inline]
    pub fn blocked_by_parts(
        &self,
        blocks: &OccluderBlocks,
        parts: &[BlockPart],
        cutout: Option<&dyn Cutout>,
    ) -> u32 {
        blocked_by_parts(self, &blocks.blocks, parts, cutout)
    }

    /// Which rays one triangle blocks, were it solid: bit `i` for ray `i`.
    #[must_use]
    pub fn blocked_by(&self, triangle: &Triangle) -> u32 {
        blocked_by(self, triangle)
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blocked_by(packet: &RayPacket, triangle: &Triangle) -> u32 {
    let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array());
    packet
        .intersect((corners, triangle.normal.to_array()), &packet.t_max)
        .map_or(0, |hits| hits.mask())
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn look_from(seen: &mut Vec<FanPart>, apex: [f32; 3], blocks: &[Block], parts: &[BlockPart]) {
    for part in parts {
        let Some(block) = blocks.get(part.block as usize) else {
            continue;
        };
        let mut offset = [0.0; PACKET];
        for place in 0..PACKET {
            let corner = at(&block.corners[0], place);
            offset[place] = plane_offset(corner, at(&block.normal, place), apex);
        }
        seen.push(FanPart {
            seen: FanPlanes::new(&block.corners, apex),
            normal: block.normal,
            offset,
            indices: block.indices,
            places: u32::from(part.places),
        });
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blocked_by_fan(
    packet: &RayPacket,
    list: &FanOccluders,
    ends: Aabb,
    cutout: Option<&dyn Cutout>,
) -> u32 {
    // Where the rays go, at the least and at the most.
    let ways = [
        subtract(ends.min.to_array(), list.apex),
        subtract(ends.max.to_array(), list.apex),
    ];
    let mut test = Test::new(packet, cutout);
    for part in &list.parts {
        let mut left = part.places;
        if left.count_ones() > FEW {
            left &= part.seen.near(ways);
        }
        while left != 0 {
            let place = left.trailing_zeros() as usize;
            left &= left - 1;
            let (planes, normal) = (part.seen.of(place), at(&part.normal, place));
            let offset = part.offset[place];
            let hit = packet.hit_from(planes, normal, offset, &test.bound);
            if hit == 0 {
                continue;
            }
            let index = part.indices[place];
            let solid = test.solid(index, hit, || {
                packet.intersect_from(planes, normal, offset, &test.bound)
            });
            if test.block(solid) {
                return test.blocked;
            }
        }
    }
    test.blocked
}

#[inline(always)]
fn subtract(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blocked_by_parts(
    packet: &RayPacket,
    blocks: &[Block],
    parts: &[BlockPart],
    cutout: Option<&dyn Cutout>,
) -> u32 {
    let mut test = Test::new(packet, cutout);
    for part in parts {
        let Some(block) = blocks.get(part.block as usize) else {
            continue;
        };
        let mut left = part.places;
        while left != 0 {
            let place = left.trailing_zeros() as usize;
            left &= left - 1;
            let triangle = (all_at(&block.corners, place), at(&block.normal, place));
            let Some(hits) = packet.intersect(triangle, &test.bound) else {
                continue;
            };
            let solid = test.solid(block.indices[place], hits.mask(), || Some(hits));
            if test.block(solid) {
                return test.blocked;
            }
        }
    }
    test.blocked
}

/// So many triangles are tested sooner than sorted out.
const FEW: u32 = 3;

/// A packet on its way along a list.
struct Test<'a> {
    cutout: Option<&'a dyn Cutout>,
    active: u32,
    bound: Lanes,
    blocked: u32,
}

impl<'a> Test<'a> {
    #[inline(always)]
    fn new(packet: &RayPacket, cutout: Option<&'a dyn Cutout>) -> Self {
        Self {
            cutout,
            active: packet.active(),
            bound: packet.t_max,
            blocked: 0,
        }
    }

    /// Of the rays that hit a triangle, those that do not go through a hole of it.
    #[inline(always)]
    fn solid(&self, index: u32, hit: u32, hits: impl FnOnce() -> Option<PacketHits>) -> u32 {
        let Some(cutout) = self.cutout.filter(|cutout| cutout.has_holes(index)) else {
            return hit;
        };
        let Some(hits) = hits() else { return 0 };
        let is_solid = |ray: usize| {
            let weights = hits.lane(ray).hit();
            cutout.is_solid(index, weights.u, weights.v)
        };
        (0..PACKET)
            .filter(|&ray| hit >> ray & 1 == 1 && is_solid(ray))
            .fold(0, |solid, ray| solid | 1 << ray)
    }

    /// Takes in rays that are blocked. Says whether no ray is left.
    #[inline(always)]
    fn block(&mut self, rays: u32) -> bool {
        self.blocked |= rays;
        finish(rays, &mut self.bound);
        self.blocked == self.active
    }
}

#[cfg(test)]
mod tests;
