//! Packets against short lists of triangles, without a tree: what is left of a shadow ray
//! where it is known what may be in the way.

use fearless_simd::prelude::*;
use lie_geom::{Aabb, Triangle, plane_offset};

use super::{
    Lanes, PACKET, RayPacket,
    fan_planes::{all_at, at, between, fan_planes, near},
    hits::PacketHits,
    rays::{Ahead, Rays},
    vector::{Wide, bits_of, load_axes, on_vectors, splat_axes},
};
use crate::Cutout;

/// Triangles that lists name, sixteen to a block: what a list asks of them is asked of a
/// whole block at once. Many lists share them.
#[derive(Clone, Debug, Default)]
pub struct OccluderBlocks {
    /// What is of now, and what was left of before.
    blocks: Vec<Block>,
    /// How many triangles.
    len: usize,
}

/// Sixteen triangles, one coordinate after the other. A place left over is degenerate:
/// nothing hits it.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
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
    /// What is of now, and what was left of before.
    parts: Vec<FanPart>,
    len: usize,
}

#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct FanPart {
    /// The planes through the apex and each edge, as of [`lie_geom::edge_planes`].
    planes: [[Lanes; 3]; 3],
    normal: [Lanes; 3],
    /// As of [`plane_offset`].
    offset: Lanes,
    indices: [u32; PACKET],
    places: u32,
}

impl FanPart {
    const EMPTY: Self = Self {
        planes: [[[0.0; PACKET]; 3]; 3],
        normal: [[0.0; PACKET]; 3],
        offset: [0.0; PACKET],
        indices: [u32::MAX; PACKET],
        places: 0,
    };
}

impl Block {
    const EMPTY: Self = Self {
        corners: [[[0.0; PACKET]; 3]; 3],
        normal: [[0.0; PACKET]; 3],
        indices: [u32::MAX; PACKET],
    };
}

impl OccluderBlocks {
    /// Makes these the triangles, with their numbers in the scene: the `i`th is place `i % 16`
    /// of block `i / 16`. As many as both have.
    pub fn fill(&mut self, indices: &[u32], triangles: &[Triangle]) {
        self.len = indices.len().min(triangles.len());
        let chunks = indices.chunks(PACKET).zip(triangles.chunks(PACKET));
        // In place, and kept when they are too many: blocks are large.
        if self.blocks.len() < chunks.len() {
            self.blocks.resize(chunks.len(), Block::EMPTY);
        }
        for (block, (indices, triangles)) in self.blocks.iter_mut().zip(chunks) {
            if indices.len().min(triangles.len()) < PACKET {
                block.clone_from(&Block::EMPTY);
            }
            for (place, (&index, triangle)) in indices.iter().zip(triangles).enumerate() {
                block.indices[place] = index;
                for axis in 0..3 {
                    block.corners[0][axis][place] = triangle.a[axis];
                    block.corners[1][axis][place] = triangle.b[axis];
                    block.corners[2][axis][place] = triangle.c[axis];
                    block.normal[axis][place] = triangle.normal[axis];
                }
            }
        }
    }

    /// Where a list may be in the way to a box: bit `i` for `origins[i]`, of those in `lanes`. From
    /// the others no segment ([`RayPacket::segments`]) to anywhere in the box is blocked.
    #[must_use]
    pub fn may_hide(
        &self,
        parts: &[BlockPart],
        ends: Aabb,
        origins: &[[f32; PACKET]; 3],
        lanes: u32,
    ) -> u32 {
        on_vectors!(simd => may_hide(simd, self.filled(), parts, ends, origins, lanes))
    }

    fn filled(&self) -> &[Block] {
        &self.blocks[..self.len.div_ceil(PACKET)]
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
        let seen = &mut self.parts;
        self.len = on_vectors!(simd => look_from(simd, seen, apex, None, blocks.filled(), parts));
    }

    /// The same without what cannot be in the way to a box ([`OccluderBlocks::may_hide`]): only
    /// segments that end in it may be asked about.
    #[inline]
    pub fn look_to(
        &mut self,
        apex: [f32; 3],
        ends: Aabb,
        blocks: &OccluderBlocks,
        parts: &[BlockPart],
    ) {
        self.apex = apex;
        let (seen, ends) = (&mut self.parts, Some(ends));
        self.len = on_vectors!(simd => look_from(simd, seen, apex, ends, blocks.filled(), parts));
    }
}

impl RayPacket {
    /// Which rays any triangle of a list blocks: bit `i` for ray `i`. All rays must start
    /// where the list is seen from ([`Self::fan`], [`Self::spread`]) and end in the box `ends`, if
    /// there is one. `cutout` says where triangles have holes; `None` means nowhere.
    #[must_use]
    #[inline]
    pub fn blocked_by_fan(
        &self,
        list: &FanOccluders,
        ends: Option<Aabb>,
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
        on_vectors!(simd => blocked_by_parts(simd, self, blocks.filled(), parts, cutout))
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
fn may_hide<S: Simd>(
    simd: S,
    blocks: &[Block],
    parts: &[BlockPart],
    ends: Aabb,
    origins: &[Lanes; 3],
    lanes: u32,
) -> u32 {
    let mut clear = lanes;
    for part in parts {
        let Some(block) = blocks.get(part.block as usize) else {
            continue;
        };
        let corner: [Wide<S>; 3] = load_axes(simd, &block.corners[0]);
        let normal = load_axes(simd, &block.normal);
        let mut left = clear;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % PACKET;
            left &= left - 1;
            let apex = at(origins, lane);
            let ways = ways_to(ends, apex);
            let planes = fan_planes::<S, Wide<S>>(simd, &block.corners, apex);
            let offset = plane_offset(corner, normal, splat_axes(simd, apex));
            let in_way = near(&planes, ways) & between(offset, normal, ways);
            if in_way & u32::from(part.places) != 0 {
                clear &= !(1 << lane);
            }
        }
    }
    lanes & !clear
}

/// How many parts are made; those after them are of before.
#[inline(always)]
fn look_from<S: Simd>(
    simd: S,
    seen: &mut Vec<FanPart>,
    apex: [f32; 3],
    ends: Option<Aabb>,
    blocks: &[Block],
    parts: &[BlockPart],
) -> usize {
    // In place, and kept when they are too many: they are large.
    if seen.len() < parts.len() {
        seen.resize(parts.len(), FanPart::EMPTY);
    }
    let ways = ends.map(|ends| ways_to(ends, apex));
    let mut count = 0;
    for part in parts {
        let Some(block) = blocks.get(part.block as usize) else {
            continue;
        };
        let planes = fan_planes::<S, Wide<S>>(simd, &block.corners, apex);
        let corner: [Wide<S>; 3] = load_axes(simd, &block.corners[0]);
        let normal = load_axes(simd, &block.normal);
        let offset = plane_offset(corner, normal, splat_axes(simd, apex));
        let mut places = u32::from(part.places);
        if let Some(ways) = ways {
            places &= near(&planes, ways) & between(offset, normal, ways);
            if places == 0 {
                continue;
            }
        }
        let to = &mut seen[count];
        // Loops: arrays' `map` would be compiled apart, without the vector unit.
        for edge in 0..3 {
            for axis in 0..3 {
                planes[edge][axis].store_slice(&mut to.planes[edge][axis]);
            }
        }
        to.normal = block.normal;
        offset.store_slice(&mut to.offset);
        to.indices = block.indices;
        to.places = places;
        count += 1;
    }
    count
}

#[inline(always)]
fn blocked_by_fan<S: Simd>(
    simd: S,
    packet: &RayPacket,
    list: &FanOccluders,
    ends: Option<Aabb>,
    cutout: Option<&dyn Cutout>,
) -> u32 {
    let ways = ends.map(|ends| ways_to(ends, list.apex));
    let mut test = Test::new(simd, packet, cutout);
    for part in &list.parts[..list.len] {
        let mut left = part.places;
        if left.count_ones() > FEW
            && let Some(ways) = ways
        {
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

/// Where rays into a box go, at the least and at the most.
#[inline(always)]
fn ways_to(ends: Aabb, apex: [f32; 3]) -> [[f32; 3]; 2] {
    [
        subtract(ends.min.to_array(), apex),
        subtract(ends.max.to_array(), apex),
    ]
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
