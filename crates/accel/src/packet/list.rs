//! A packet against triangles one by one, without a tree.

use lie_geom::Triangle;
use multiversion::multiversion;

use super::{PACKET, RayPacket, finish};
use crate::Cutout;

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
pub(super) fn blocked_by(packet: &RayPacket, triangle: &Triangle) -> u32 {
    packet
        .intersect::<false>(parts(triangle), &packet.t_max)
        .map_or(0, |hits| hits.mask())
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
pub(super) fn blocked_by_any(
    packet: &RayPacket,
    all: &[Triangle],
    indices: &[u32],
    cutout: Option<&dyn Cutout>,
) -> u32 {
    if packet.apex.is_some() {
        any_of::<true>(packet, all, indices, cutout)
    } else {
        any_of::<false>(packet, all, indices, cutout)
    }
}

#[inline(always)]
fn any_of<const FAN: bool>(
    packet: &RayPacket,
    all: &[Triangle],
    indices: &[u32],
    cutout: Option<&dyn Cutout>,
) -> u32 {
    let active = packet.active();
    let mut bound = packet.t_max;
    let mut blocked = 0;
    for &index in indices {
        let Some(triangle) = all.get(index as usize) else {
            continue;
        };
        let Some(hits) = packet.intersect::<FAN>(parts(triangle), &bound) else {
            continue;
        };
        let mut hit = hits.mask();
        if let Some(cutout) = cutout.filter(|cutout| cutout.has_holes(index)) {
            for ray in 0..PACKET {
                if hit >> ray & 1 == 1 {
                    let weights = hits.lane(ray).hit();
                    let solid = cutout.is_solid(index, weights.u, weights.v);
                    hit &= !(u32::from(!solid) << ray);
                }
            }
        }
        blocked |= hit;
        if blocked == active {
            break;
        }
        finish(hit, &mut bound);
    }
    blocked
}

#[inline(always)]
fn parts(triangle: &Triangle) -> ([[f32; 3]; 3], [f32; 3]) {
    let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array());
    (corners, triangle.normal.to_array())
}
