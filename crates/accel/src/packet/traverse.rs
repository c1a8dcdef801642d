//! A packet through the tree.

use lie_geom::{Hit, plane_offset};
use multiversion::multiversion;

use super::{
    Lanes, PACKET, RayPacket,
    bounds::PacketBounds,
    fan_planes::{FanPlanes, at},
    finish,
    hits::PacketHits,
    lanes, largest,
};
use crate::{
    Bvh,
    block::{BLOCK, TriangleBlock},
    node::{Child, Node, Target, WIDTH},
    stack::{Stack, with_stack},
};

pub(crate) fn closest(bvh: &Bvh, packet: &RayPacket) -> [Option<Hit>; PACKET] {
    with_stack(|stack| closest_kernel(bvh, packet, stack))
}

pub(crate) fn blocked(bvh: &Bvh, packet: &RayPacket) -> u32 {
    with_stack(|stack| blocked_kernel(bvh, packet, stack))
}

pub(crate) fn blockers(bvh: &Bvh, packet: &RayPacket) -> [Option<u32>; PACKET] {
    with_stack(|stack| blockers_kernel(bvh, packet, stack))
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn closest_kernel(bvh: &Bvh, packet: &RayPacket, stack: &mut Stack) -> [Option<Hit>; PACKET] {
    let mut best = PacketHits {
        t: [f32::INFINITY; PACKET],
        weight_b: [0.0; PACKET],
        weight_c: [0.0; PACKET],
        sum: [0.0; PACKET],
    };
    let mut ids = [u32::MAX; PACKET];
    traverse(bvh, packet, stack, |block, lane, hits, bound| {
        let id = block.id(lane);
        let solid = solid(bvh, block, lane, hits);
        let solid = lanes(solid);
        let mut take = [false; PACKET];
        for ray in 0..PACKET {
            let closer =
                (hits.t[ray] < best.t[ray]) | ((hits.t[ray] == best.t[ray]) & (id < ids[ray]));
            take[ray] = closer & solid[ray];
        }
        best.take(&take, hits);
        for ray in 0..PACKET {
            ids[ray] = if take[ray] { id } else { ids[ray] };
            // One step past the best distance, so that ties are seen.
            let past = f32::from_bits(hits.t[ray].to_bits() + 1);
            bound[ray] = if take[ray] { past } else { bound[ray] };
        }
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

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blocked_kernel(bvh: &Bvh, packet: &RayPacket, stack: &mut Stack) -> u32 {
    let mut blocked = 0u32;
    traverse(bvh, packet, stack, |block, lane, hits, bound| {
        let solid = solid(bvh, block, lane, hits);
        blocked |= solid;
        finish(solid, bound);
    });
    blocked
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blockers_kernel(bvh: &Bvh, packet: &RayPacket, stack: &mut Stack) -> [Option<u32>; PACKET] {
    let mut blockers = [u32::MAX; PACKET];
    traverse(bvh, packet, stack, |block, lane, hits, bound| {
        let solid = solid(bvh, block, lane, hits);
        let id = block.id(lane);
        let rays = lanes(solid);
        for ray in 0..PACKET {
            blockers[ray] = if rays[ray] { id } else { blockers[ray] };
        }
        finish(solid, bound);
    });
    let mut found = [None; PACKET];
    for ray in 0..PACKET {
        found[ray] = (blockers[ray] != u32::MAX).then_some(blockers[ray]);
    }
    found
}

/// The rays that hit solid matter: bit `i` for ray `i`.
#[inline(always)]
fn solid(bvh: &Bvh, block: &TriangleBlock, lane: usize, hits: &PacketHits) -> u32 {
    let mut mask = hits.mask();
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
fn traverse(
    bvh: &Bvh,
    packet: &RayPacket,
    stack: &mut Stack,
    mut found: impl FnMut(&TriangleBlock, usize, &PacketHits, &mut Lanes),
) {
    if packet.apex.is_some() {
        walk::<true>(bvh, packet, stack, &mut found);
    } else {
        walk::<false>(bvh, packet, stack, &mut found);
    }
}

/// With `FAN`, all rays start at one apex.
#[inline(always)]
fn walk<const FAN: bool>(
    bvh: &Bvh,
    packet: &RayPacket,
    stack: &mut Stack,
    found: &mut impl FnMut(&TriangleBlock, usize, &PacketHits, &mut Lanes),
) {
    let inverse = packet.inverse();
    let Some(bounds) = PacketBounds::new(packet, &inverse) else {
        return;
    };
    let (apex, ways) = (packet.apex.unwrap_or_default(), packet.ways());
    let mut bound = packet.t_max;
    let mut farthest = largest(&bound);
    stack.clear();
    stack.push((f32::NEG_INFINITY, Child::node(0)));
    while let Some((entry, child)) = stack.pop() {
        if entry >= farthest {
            continue;
        }
        match child.target() {
            Target::Node(index) => {
                let node = &bvh.nodes[index];
                let entries = bounds.entries(node, farthest);
                push_entered::<FAN>(node, packet, &inverse, &bound, entries, stack);
            }
            Target::Block(index) if FAN => {
                let block = &bvh.blocks[index];
                let seen = FanPlanes::new(&block.corners, apex);
                let mut near = seen.near(ways);
                while near != 0 {
                    let lane = near.trailing_zeros() as usize % BLOCK;
                    near &= near - 1;
                    let (planes, normal) = (seen.of(lane), at(&block.normal, lane));
                    let offset = plane_offset(at(&block.corners[0], lane), normal, apex);
                    if let Some(hits) = packet.intersect_from(planes, normal, offset, &bound) {
                        found(block, lane, &hits, &mut bound);
                        farthest = largest(&bound);
                    }
                }
            }
            Target::Block(index) => {
                let block = &bvh.blocks[index];
                for lane in 0..block.len() {
                    if let Some(hits) = packet.intersect(block.lane(lane), &bound) {
                        found(block, lane, &hits, &mut bound);
                        farthest = largest(&bound);
                    }
                }
            }
        }
    }
}

/// Pushes the children that any ray enters, so that the nearest is popped first.
#[inline(always)]
fn push_entered<const FAN: bool>(
    node: &Node,
    packet: &RayPacket,
    inverse: &[Lanes; 3],
    bound: &Lanes,
    entries: [f32; WIDTH],
    stack: &mut Stack,
) {
    let base = stack.len();
    let mut entered = 0u32;
    for lane in 0..WIDTH {
        entered |= u32::from(entries[lane] < f32::INFINITY) << lane;
    }
    while entered != 0 {
        let lane = entered.trailing_zeros() as usize % WIDTH;
        entered &= entered - 1;
        let (entry, child) = (entries[lane], node.children[lane]);
        if child == Child::NONE || !packet.enters::<FAN>(inverse, node.bounds(lane), bound) {
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
