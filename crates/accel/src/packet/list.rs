//! A packet against triangles one by one, without a tree.

use lie_geom::{Triangle, edge_planes, plane_offset};
use multiversion::multiversion;

use super::{Lanes, PACKET, RayPacket, finish, hits::PacketHits};
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
    let mut test = Test {
        packet,
        cutout,
        active: packet.active(),
        bound: packet.t_max,
        blocked: 0,
    };
    match packet.apex {
        Some(apex) => {
            for chunk in indices.chunks(PACKET) {
                if test.fan(apex, all, chunk) {
                    break;
                }
            }
        }
        None => {
            for &index in indices {
                let Some(triangle) = all.get(index as usize) else {
                    continue;
                };
                let hits = packet.intersect::<false>(parts(triangle), &test.bound);
                if hits.is_some_and(|hits| test.take(index, &hits)) {
                    break;
                }
            }
        }
    }
    test.blocked
}

/// A packet on its way along a list.
struct Test<'a> {
    packet: &'a RayPacket,
    cutout: Option<&'a dyn Cutout>,
    active: u32,
    bound: Lanes,
    blocked: u32,
}

impl Test<'_> {
    /// Up to sixteen triangles against rays from one apex. What the rays have in common is
    /// worked out for all triangles at once. Says whether no ray is left.
    #[inline(always)]
    fn fan(&mut self, apex: [f32; 3], all: &[Triangle], indices: &[u32]) -> bool {
        let mut corners = [[[0.0; PACKET]; 3]; 3];
        let mut normal = [[0.0; PACKET]; 3];
        for (place, &index) in indices.iter().enumerate().take(PACKET) {
            // A place left empty is degenerate: nothing hits it.
            if let Some(triangle) = all.get(index as usize) {
                for axis in 0..3 {
                    corners[0][axis][place] = triangle.a[axis];
                    corners[1][axis][place] = triangle.b[axis];
                    corners[2][axis][place] = triangle.c[axis];
                    normal[axis][place] = triangle.normal[axis];
                }
            }
        }
        let mut planes = [[[0.0; PACKET]; 3]; 3];
        let mut offset = [0.0; PACKET];
        for place in 0..PACKET {
            let at = |axes: &[Lanes; 3]| [axes[0][place], axes[1][place], axes[2][place]];
            let shape = [at(&corners[0]), at(&corners[1]), at(&corners[2])];
            let edges = edge_planes(shape, apex);
            offset[place] = plane_offset(shape[0], at(&normal), apex);
            for edge in 0..3 {
                for axis in 0..3 {
                    planes[edge][axis][place] = edges[edge][axis];
                }
            }
        }
        for (place, &index) in indices.iter().enumerate().take(PACKET) {
            let at = |axes: &[Lanes; 3]| [axes[0][place], axes[1][place], axes[2][place]];
            let edges = [at(&planes[0]), at(&planes[1]), at(&planes[2])];
            let hits = self
                .packet
                .intersect_from(edges, at(&normal), offset[place], &self.bound);
            if hits.is_some_and(|hits| self.take(index, &hits)) {
                return true;
            }
        }
        false
    }

    /// Takes in a triangle's hits. Says whether no ray is left.
    #[inline(always)]
    fn take(&mut self, index: u32, hits: &PacketHits) -> bool {
        let mut hit = hits.mask();
        if let Some(cutout) = self.cutout.filter(|cutout| cutout.has_holes(index)) {
            for ray in 0..PACKET {
                if hit >> ray & 1 == 1 {
                    let weights = hits.lane(ray).hit();
                    let solid = cutout.is_solid(index, weights.u, weights.v);
                    hit &= !(u32::from(!solid) << ray);
                }
            }
        }
        self.blocked |= hit;
        finish(hit, &mut self.bound);
        self.blocked == self.active
    }
}

#[inline(always)]
fn parts(triangle: &Triangle) -> ([[f32; 3]; 3], [f32; 3]) {
    let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array());
    (corners, triangle.normal.to_array())
}
