//! One ray through the tree: nearest child first.

use lie_geom::{Hit, LaneHit, Ray};
use multiversion::multiversion;

use crate::{
    Bvh,
    block::{BLOCK, TriangleBlock},
    node::{Child, SlabRay, Target, WIDTH},
    stack::{Stack, with_stack},
};

pub(crate) fn closest(bvh: &Bvh, ray: &Ray) -> Option<Hit> {
    if !ray.is_defined() {
        return None;
    }
    with_stack(|stack| closest_kernel(bvh, ray, stack))
}

pub(crate) fn blocker(bvh: &Bvh, ray: &Ray) -> Option<u32> {
    if !ray.is_defined() {
        return None;
    }
    with_stack(|stack| blocker_kernel(bvh, ray, stack))
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn closest_kernel(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
    let slab_ray = SlabRay::new(ray);
    let mut best: Option<(f32, u32, LaneHit)> = None;
    let mut t_max = ray.t_max;
    stack.clear();
    stack.push((ray.t_min, Child::node(0)));
    while let Some((entry, child)) = stack.pop() {
        if entry > t_max {
            continue;
        }
        match child.target() {
            Target::Node(index) => {
                let node = &bvh.nodes[index];
                push_nearest_last(node.entries(&slab_ray, t_max), &node.children, stack);
            }
            Target::Block(index) => {
                let block = &bvh.blocks[index];
                if let Some((lane, hit)) = closest_in_block(bvh, block, ray, t_max, best) {
                    t_max = hit.t;
                    best = Some((hit.t, block.id(lane), hit));
                }
            }
        }
    }
    best.map(|(_, triangle, hit)| {
        let hit = hit.hit();
        Hit {
            t: hit.t,
            u: hit.u,
            v: hit.v,
            triangle,
        }
    })
}

/// The best solid hit of a block, if it beats the best so far: closer, or as close with a
/// smaller index.
#[inline(always)]
fn closest_in_block(
    bvh: &Bvh,
    block: &TriangleBlock,
    ray: &Ray,
    t_max: f32,
    best: Option<(f32, u32, LaneHit)>,
) -> Option<(usize, LaneHit)> {
    // One step past t_max, so that a hit at exactly the best distance is seen.
    let hits = block.intersect(
        ray,
        if best.is_some() {
            t_max.next_up()
        } else {
            t_max
        },
    );
    let mut found: Option<(usize, LaneHit)> = None;
    let (mut t, mut id) = best.map_or((f32::INFINITY, u32::MAX), |(t, id, _)| (t, id));
    for lane in 0..BLOCK {
        if hits.t[lane] <= t && hits.t[lane] < f32::INFINITY {
            let closer = hits.t[lane] < t || block.id(lane) < id;
            if closer && block.is_solid(lane, hits.lane(lane), bvh.cutout.as_deref()) {
                (t, id) = (hits.t[lane], block.id(lane));
                found = Some((lane, hits.lane(lane)));
            }
        }
    }
    found
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blocker_kernel(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> Option<u32> {
    let slab_ray = SlabRay::new(ray);
    stack.clear();
    stack.push((ray.t_min, Child::node(0)));
    while let Some((_, child)) = stack.pop() {
        match child.target() {
            Target::Node(index) => {
                let node = &bvh.nodes[index];
                push_nearest_last(node.entries(&slab_ray, ray.t_max), &node.children, stack);
            }
            Target::Block(index) => {
                let block = &bvh.blocks[index];
                if let Some(lane) = block.blocker(ray, bvh.cutout.as_deref()) {
                    return Some(block.id(lane));
                }
            }
        }
    }
    None
}

/// Pushes the entered children so that the nearest is popped first.
#[inline(always)]
fn push_nearest_last(entries: [f32; WIDTH], children: &[Child; WIDTH], stack: &mut Stack) {
    let base = stack.len();
    for lane in 0..WIDTH {
        let entry = entries[lane];
        if entry < f32::INFINITY {
            // Insertion from the top keeps the new part sorted, farthest first.
            stack.push((entry, children[lane]));
            let mut place = stack.len() - 1;
            while place > base && stack[place - 1].0 < entry {
                stack.swap(place, place - 1);
                place -= 1;
            }
        }
    }
}
