//! Packets against short lists of triangles, without a tree: what is left of a shadow ray
//! where it is known what may be in the way.

use fearless_simd::prelude::*;
use lie_geom::{Aabb, Triangle, plane_offset};

use super::{
    Lanes, PACKET, RayPacket,
    fan_planes::{all_at, at, fan_planes, near},
    hits::PacketHits,
    rays::{Ahead, Rays},
    vector::{Wide, bits_of, load_axes, on_vectors, splat_axes},
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
    /// The planes through the apex and each edge, as of [`lie_geom::edge_planes`].
    planes: [[Lanes; 3]; 3],
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
        let seen = &mut self.parts;
        on_vectors!(simd => look_from(simd, seen, apex, &blocks.blocks, parts));
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
        on_vectors!(simd => blocked_by_fan(simd, self, list, ends, cutout))
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
        on_vectors!(simd => blocked_by_parts(simd, self, &blocks.blocks, parts, cutout))
    }

    /// Which rays one triangle blocks, were it solid: bit `i` for ray `i`.
    #[must_use]
    pub fn blocked_by(&self, triangle: &Triangle) -> u32 {
        on_vectors!(simd => blocked_by(simd, self, triangle))
    }
}

#[inline(always)]
fn blocked_by<S: Simd>(simd: S, packet: &RayPacket, triangle: &Triangle) -> u32 {
    let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array());
    let (rays, ahead) = (Rays::new(simd, packet), Ahead::new(simd, packet));
    rays.intersect((corners, triangle.normal.to_array()), &ahead)
        .map_or(0, |hits| bits_of(hits.rays))
}

#[inline(always)]
fn look_from<S: Simd>(
    simd: S,
    seen: &mut Vec<FanPart>,
    apex: [f32; 3],
    blocks: &[Block],
    parts: &[BlockPart],
) {
    for part in parts {
        let Some(block) = blocks.get(part.block as usize) else {
            continue;
        };
        let planes = fan_planes::<S, Wide<S>>(simd, &block.corners, apex);
        let corner: [Wide<S>; 3] = load_axes(simd, &block.corners[0]);
        let normal = load_axes(simd, &block.normal);
        let offset = plane_offset(corner, normal, splat_axes(simd, apex));
        // Loops: arrays' `map` would be compiled apart, without the vector unit.
        let mut stored = [[[0.0; PACKET]; 3]; 3];
        for edge in 0..3 {
            for axis in 0..3 {
                stored[edge][axis] = planes[edge][axis].into();
            }
        }
        seen.push(FanPart {
            planes: stored,
            normal: block.normal,
            offset: offset.into(),
            indices: block.indices,
            places: u32::from(part.places),
        });
    }
}

#[inline(always)]
fn blocked_by_fan<S: Simd>(
    simd: S,
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
    let mut test = Test::new(simd, packet, cutout);
    for part in &list.parts {
        let mut left = part.places;
        if left.count_ones() > FEW {
            let planes = [
                load_axes::<S, Wide<S>>(simd, &part.planes[0]),
                load_axes(simd, &part.planes[1]),
                load_axes(simd, &part.planes[2]),
            ];
            left &= near(&planes, ways);
        }
        while left != 0 {
            let place = left.trailing_zeros() as usize % PACKET;
            left &= left - 1;
            let (edges, normal) = (all_at(&part.planes, place), at(&part.normal, place));
            let offset = part.offset[place];
            let hits = test.rays.intersect_from(edges, normal, offset, &test.ahead);
            if let Some(hits) = hits
                && test.block(part.indices[place], &hits)
            {
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

#[inline(always)]
fn blocked_by_parts<S: Simd>(
    simd: S,
    packet: &RayPacket,
    blocks: &[Block],
    parts: &[BlockPart],
    cutout: Option<&dyn Cutout>,
) -> u32 {
    let mut test = Test::new(simd, packet, cutout);
    for part in parts {
        let Some(block) = blocks.get(part.block as usize) else {
            continue;
        };
        let mut left = part.places;
        while left != 0 {
            let place = left.trailing_zeros() as usize % PACKET;
            left &= left - 1;
            let triangle = (all_at(&block.corners, place), at(&block.normal, place));
            if let Some(hits) = test.rays.intersect(triangle, &test.ahead)
                && test.block(block.indices[place], &hits)
            {
                return test.blocked;
            }
        }
    }
    test.blocked
}

/// So many triangles are tested sooner than sorted out.
const FEW: u32 = 3;

/// A packet on its way along a list.
struct Test<'a, S: Simd> {
    rays: Rays<S>,
    ahead: Ahead<S>,
    cutout: Option<&'a dyn Cutout>,
    blocked: u32,
}

impl<'a, S: Simd> Test<'a, S> {
    #[inline(always)]
    fn new(simd: S, packet: &RayPacket, cutout: Option<&'a dyn Cutout>) -> Self {
        Self {
            rays: Rays::new(simd, packet),
            ahead: Ahead::new(simd, packet),
            cutout,
            blocked: 0,
        }
    }

    /// Takes in what hit a triangle, but for what goes through a hole of it. Says whether no ray
    /// is left.
    #[inline(always)]
    fn block(&mut self, index: u32, hits: &PacketHits<S>) -> bool {
        let mut rays = bits_of(hits.rays);
        if let Some(cutout) = self.cutout.filter(|cutout| cutout.has_holes(index)) {
            let is_solid = |ray: usize| {
                let weights = hits.lane(ray).hit();
                cutout.is_solid(index, weights.u, weights.v)
            };
            rays = (0..PACKET)
                .filter(|&ray| rays >> ray & 1 == 1 && is_solid(ray))
                .fold(0, |solid, ray| solid | 1 << ray);
        }
        self.blocked |= rays;
        self.ahead.finish(self.rays.simd, rays);
        !self.ahead.active.any_true()
    }
}

#[cfg(test)]
mod tests;
