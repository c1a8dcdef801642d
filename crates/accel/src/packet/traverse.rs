//! A packet through the tree.

use fearless_simd::{f32x8, prelude::*, u32x16};
use lie_geom::{Hit, plane_offset};

use super::{
    PACKET, RayPacket,
    bounds::PacketBounds,
    fan_planes::{at, edges, fan_planes, near},
    hits::PacketHits,
    rays::{Ahead, Rays},
    slab::{Course, Going, SlabRays},
    vector::{Wide, bits_of, mask_of, on_vectors},
};
use crate::{
    Bvh,
    block::{BLOCK, TriangleBlock},
    node::{Child, Node, Target, WIDTH},
    stack::{Stack, with_stack},
};

pub(crate) fn closest(bvh: &Bvh, packet: &RayPacket) -> [Option<Hit>; PACKET] {
    with_stack(|stack| on_vectors!(simd => closest_kernel(simd, bvh, packet, stack)))
}

pub(crate) fn blocked(bvh: &Bvh, packet: &RayPacket) -> u32 {
    with_stack(|stack| on_vectors!(simd => blocked_kernel(simd, bvh, packet, stack)))
}

pub(crate) fn blockers(bvh: &Bvh, packet: &RayPacket) -> [Option<u32>; PACKET] {
    with_stack(|stack| on_vectors!(simd => blockers_kernel(simd, bvh, packet, stack)))
}

#[inline(always)]
pub(crate) fn closest_kernel<S: Simd>(
    simd: S,
    bvh: &Bvh,
    packet: &RayPacket,
    stack: &mut Stack,
) -> [Option<Hit>; PACKET] {
    let mut best = PacketHits::none(simd);
    let mut ids = u32x16::splat(simd, u32::MAX);
    traverse(simd, bvh, packet, stack, |block, lane, hits, ahead| {
        let id = u32x16::splat(simd, block.id(lane));
        let solid = mask_of(simd, solid(bvh, block, lane, hits));
        let is_tie = hits.t.simd_eq(best.t) & id.simd_lt(ids);
        let take = (hits.t.simd_lt(best.t) | is_tie) & solid;
        best.take(take, hits);
        ids = take.select(id, ids);
        // One step past the best distance, so that ties are seen.
        let past = Wide::from_bits(hits.t.to_bits() + 1);
        ahead.bound = take.select(past, ahead.bound);
    });
    let mut found = [None; PACKET];
    for ray in 0..PACKET {
        if best.t[ray] < f32::INFINITY {
            let hit = best.lane(ray).hit();
            found[ray] = Some(Hit {
                t: hit.t,
                u: hit.u,
                v: hit.v,
                triangle: ids[ray],
            });
        }
    }
    found
}

#[inline(always)]
pub(crate) fn blocked_kernel<S: Simd>(
    simd: S,
    bvh: &Bvh,
    packet: &RayPacket,
    stack: &mut Stack,
) -> u32 {
    let mut blocked = 0u32;
    traverse(simd, bvh, packet, stack, |block, lane, hits, ahead| {
        let solid = solid(bvh, block, lane, hits);
        blocked |= solid;
        ahead.finish(simd, solid);
    });
    blocked
}

#[inline(always)]
pub(crate) fn blockers_kernel<S: Simd>(
    simd: S,
    bvh: &Bvh,
    packet: &RayPacket,
    stack: &mut Stack,
) -> [Option<u32>; PACKET] {
    let mut blockers = u32x16::splat(simd, u32::MAX);
    traverse(simd, bvh, packet, stack, |block, lane, hits, ahead| {
        let solid = solid(bvh, block, lane, hits);
        let id = u32x16::splat(simd, block.id(lane));
        blockers = mask_of(simd, solid).select(id, blockers);
        ahead.finish(simd, solid);
    });
    let mut found = [None; PACKET];
    for ray in 0..PACKET {
        found[ray] = (blockers[ray] != u32::MAX).then_some(blockers[ray]);
    }
    found
}

/// The rays that hit solid matter: bit `i` for ray `i`.
#[inline(always)]
fn solid<S: Simd>(bvh: &Bvh, block: &TriangleBlock, lane: usize, hits: &PacketHits<S>) -> u32 {
    let mut mask = bits_of(hits.rays);
    if block.has_holes(lane) {
        for ray in 0..PACKET {
            let solid =
                mask >> ray & 1 == 1 && block.is_solid(lane, hits.lane(ray), bvh.cutout.as_deref());
            mask &= !(u32::from(!solid) << ray);
        }
    }
    mask
}

/// Takes a packet through the tree, nearest box first, and calls `found` with every triangle
/// that some ray hits before its bound; `found` lowers the bounds.
#[inline(always)]
fn traverse<S: Simd>(
    simd: S,
    bvh: &Bvh,
    packet: &RayPacket,
    stack: &mut Stack,
    mut found: impl FnMut(&TriangleBlock, usize, &PacketHits<S>, &mut Ahead<S>),
) {
    let rays = Rays::new(simd, packet);
    let mut ahead = Ahead::new(simd, packet);
    let inverse = rays.inverse();
    let Some(bounds) = PacketBounds::new(&rays, &inverse, &ahead) else {
        return;
    };
    let near = bounds.near();
    let walk = Walk {
        bvh,
        rays,
        bounds,
        slabs: SlabRays::new(&rays, &inverse, near),
    };
    match (packet.apex.is_some(), near.is_some()) {
        (false, false) => walk.go::<Going<false, false>>(&mut ahead, stack, &mut found),
        (false, true) => walk.go::<Going<false, true>>(&mut ahead, stack, &mut found),
        (true, false) => walk.go::<Going<true, false>>(&mut ahead, stack, &mut found),
        (true, true) => walk.go::<Going<true, true>>(&mut ahead, stack, &mut found),
    }
}

/// A packet's way through the tree.
struct Walk<'a, S: Simd> {
    bvh: &'a Bvh,
    rays: Rays<S>,
    bounds: PacketBounds,
    slabs: SlabRays<S>,
}

impl<S: Simd> Walk<'_, S> {
    #[inline(always)]
    fn go<C: Course>(
        &self,
        ahead: &mut Ahead<S>,
        stack: &mut Stack,
        found: &mut impl FnMut(&TriangleBlock, usize, &PacketHits<S>, &mut Ahead<S>),
    ) {
        let rays = &self.rays;
        let ways = rays.ways(ahead.active);
        let mut farthest = ahead.bound.reduce_max();
        stack.clear();
        stack.push((f32::NEG_INFINITY, Child::node(0)));
        while let Some((entry, child)) = stack.pop() {
            if entry >= farthest {
                continue;
            }
            let block = match child.target() {
                Target::Node(index) => {
                    self.push_entered::<C>(&self.bvh.nodes[index], farthest, ahead, stack);
                    continue;
                }
                Target::Block(index) => &self.bvh.blocks[index],
            };
            if C::FAN {
                let planes = fan_planes::<S, f32x8<S>>(rays.simd, &block.corners, rays.apex);
                let mut left = near(&planes, ways);
                while left != 0 {
                    let lane = left.trailing_zeros() as usize % BLOCK;
                    left &= left - 1;
                    let normal = at(&block.normal, lane);
                    let offset = plane_offset(at(&block.corners[0], lane), normal, rays.apex);
                    let edges = edges(&planes, lane);
                    if let Some(hits) = rays.intersect_from(edges, normal, offset, ahead) {
                        found(block, lane, &hits, ahead);
                        farthest = ahead.bound.reduce_max();
                    }
                }
            } else {
                for lane in 0..block.len() {
                    if let Some(hits) = rays.intersect(block.lane(lane), ahead) {
                        found(block, lane, &hits, ahead);
                        farthest = ahead.bound.reduce_max();
                    }
                }
            }
        }
    }

    /// Pushes the children that any ray enters, so that the nearest is popped first.
    #[inline(always)]
    fn push_entered<C: Course>(
        &self,
        node: &Node,
        farthest: f32,
        ahead: &Ahead<S>,
        stack: &mut Stack,
    ) {
        let (entries, mut entered) = self.bounds.entries(self.rays.simd, node, farthest);
        let base = stack.len();
        while entered != 0 {
            let lane = entered.trailing_zeros() as usize % WIDTH;
            entered &= entered - 1;
            let (entry, child) = (entries[lane], node.children[lane]);
            if child == Child::NONE || !self.slabs.enter::<C>(node, lane, ahead) {
                continue;
            }
            stack.push((entry, child));
            let mut place = stack.len() - 1;
            while place > base && stack[place - 1].0 < entry {
                stack.swap(place, place - 1);
                place -= 1;
            }
        }
    }
}
