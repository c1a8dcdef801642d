//! Packets against short lists of triangles, without a tree: what is left of a shadow ray
//! where it is known what may be in the way.

use lie_geom::{Aabb, Triangle, edge_planes, plane_offset};
use multiversion::multiversion;

use super::{Lanes, PACKET, RayPacket, finish, hits::PacketHits, union};
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
    /// The planes through the apex and each edge, as of [`edge_planes`].
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
        .intersect::<false>((corners, triangle.normal.to_array()), &packet.t_max)
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
        let mut planes = [[[0.0; PACKET]; 3]; 3];
        let mut offset = [0.0; PACKET];
        for place in 0..PACKET {
            let shape = all_at(&block.corners, place);
            let edges = edge_planes(shape, apex);
            offset[place] = plane_offset(shape[0], at(&block.normal, place), apex);
            for edge in 0..3 {
                for axis in 0..3 {
                    planes[edge][axis][place] = edges[edge][axis];
                }
            }
        }
        seen.push(FanPart {
            planes,
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
            left &= part.near(ways);
        }
        while left != 0 {
            let place = left.trailing_zeros() as usize;
            left &= left - 1;
            let planes = all_at(&part.planes, place);
            let normal = at(&part.normal, place);
            let hit = packet.hit_from(planes, normal, part.offset[place], &test.bound);
            if hit == 0 {
                continue;
            }
            let index = part.indices[place];
            let solid = test.solid(index, hit, || {
                packet.intersect_from(planes, normal, part.offset[place], &test.bound)
            });
            if test.block(solid) {
                return test.blocked;
            }
        }
    }
    test.blocked
}

impl FanPart {
    /// The triangles that some ray's line may pass inside: bit `i` for triangle `i`. `ways` are
    /// the ends of the interval that the rays' directions lie in, axis by axis.
    ///
    /// Rounding is monotonic, so what the same operations make of an interval's ends bounds
    /// what they make of a ray.
    #[inline(always)]
    fn near(&self, ways: [[f32; 3]; 2]) -> u32 {
        let mut near = [0; PACKET];
        for place in 0..PACKET {
            let a = interval(at(&self.planes[0], place), ways);
            let b = interval(at(&self.planes[1], place), ways);
            let c = interval(at(&self.planes[2], place), ways);
            let before = (a[0] > 0.0) | (b[0] > 0.0) | (c[0] > 0.0);
            let behind = (a[1] < 0.0) | (b[1] < 0.0) | (c[1] < 0.0);
            near[place] = if before & behind { 0 } else { 1 << place };
        }
        union(&near)
    }
}

/// The least and the most that a scalar product may be.
#[inline(always)]
fn interval(plane: [f32; 3], ways: [[f32; 3]; 2]) -> [f32; 2] {
    let x = ends(plane[0] * ways[0][0], plane[0] * ways[1][0]);
    let y = ends(plane[1] * ways[0][1], plane[1] * ways[1][1]);
    let z = ends(plane[2] * ways[0][2], plane[2] * ways[1][2]);
    [x[0] + y[0] + z[0], x[1] + y[1] + z[1]]
}

#[inline(always)]
fn ends(a: f32, b: f32) -> [f32; 2] {
    [if a < b { a } else { b }, if a < b { b } else { a }]
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
            let Some(hits) = packet.intersect::<false>(triangle, &test.bound) else {
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

#[inline(always)]
fn at(axes: &[Lanes; 3], place: usize) -> [f32; 3] {
    [axes[0][place], axes[1][place], axes[2][place]]
}

#[inline(always)]
fn all_at(vectors: &[[Lanes; 3]; 3], place: usize) -> [[f32; 3]; 3] {
    [
        at(&vectors[0], place),
        at(&vectors[1], place),
        at(&vectors[2], place),
    ]
}

#[cfg(test)]
mod tests;
