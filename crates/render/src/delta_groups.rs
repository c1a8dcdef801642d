use glam::Vec3;
use lie_accel::{PACKET, RayPacket};

use crate::{
    LieCell, RenderStats, World,
    delta_lanes::{PointLanes, RadianceLanes},
    tile_renderer::ShadingPoint,
};

/// Up to sixteen shading points of one cell, for its lights without extent.
pub(crate) struct DeltaGroup<'a> {
    cell: &'a LieCell,
    points: PointLanes,
    /// Each lane's pixel.
    pixels: [usize; PACKET],
    len: usize,
}

impl<'a> DeltaGroup<'a> {
    /// Groups points that have cells; those of one cell must follow each other.
    pub(crate) fn gather(points: &[ShadingPoint<'a>], groups: &mut Vec<Self>) {
        groups.clear();
        let same_cell =
            |a: &ShadingPoint<'_>, b: &ShadingPoint<'_>| a.cell_address() == b.cell_address();
        for run in points.chunk_by(same_cell) {
            let Some(cell) = run[0].cell else { continue };
            for chunk in run.chunks(PACKET) {
                let mut group = Self {
                    cell,
                    points: PointLanes::new(),
                    pixels: [0; PACKET],
                    len: chunk.len(),
                };
                for (lane, point) in chunk.iter().enumerate() {
                    group.points.set(lane, &point.surface, &point.brdf);
                    group.pixels[lane] = point.pixel;
                }
                groups.push(group);
            }
        }
    }

    /// Unoccluded lights: no rays at all.
    pub(crate) fn unoccluded(&self, world: &World, sums: &mut [Vec3]) {
        let lights = self.cell.unoccluded.iter();
        let mut total = [[0.0; PACKET]; 3];
        for light in lights.filter_map(|&light| world.delta_light(light)) {
            add(&mut total, &self.points.shade(light), u32::MAX);
        }
        self.give(&total, sums);
    }

    /// Partially occluded lights: rays against the occluders alone.
    pub(crate) fn partial(&self, world: &World, stats: &mut RenderStats, sums: &mut [Vec3]) {
        let mut total = [[0.0; PACKET]; 3];
        for entry in &self.cell.partial_delta {
            let Some(light) = world.delta_light(entry.light) else {
                continue;
            };
            let radiance = self.points.shade(light);
            let lit = lit(&radiance);
            if lit == 0 {
                continue;
            }
            let rays = RayPacket::fan(light.position, &self.points.origin, lit);
            let blocked = world.blocked_by_any(&entry.occluders, &rays);
            add(&mut total, &radiance, !blocked);
            let rays = u64::from(lit.count_ones());
            stats.list_rays += rays;
            stats.occluder_tests += rays * entry.occluders.len() as u64;
        }
        self.give(&total, sums);
    }

    fn give(&self, total: &RadianceLanes, sums: &mut [Vec3]) {
        for (lane, &pixel) in self.pixels[..self.len].iter().enumerate() {
            sums[pixel] += Vec3::from(total.map(|channel| channel[lane]));
        }
    }
}

/// Adds in the lanes whose bits are set.
fn add(total: &mut RadianceLanes, radiance: &RadianceLanes, lanes: u32) {
    for (total, radiance) in total.iter_mut().zip(radiance) {
        for lane in 0..PACKET {
            let given = if lanes >> lane & 1 == 1 {
                radiance[lane]
            } else {
                0.0
            };
            total[lane] += given;
        }
    }
}

/// Lanes that a light gives anything.
fn lit(radiance: &RadianceLanes) -> u32 {
    let mut lit = 0;
    for lane in 0..PACKET {
        let any = radiance.iter().any(|channel| channel[lane] > 0.0);
        lit |= u32::from(any) << lane;
    }
    lit
}
