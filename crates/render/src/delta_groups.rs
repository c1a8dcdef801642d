use glam::Vec3;
use lie_accel::{PACKET, RayPacket};

use crate::{
    LieCell, RenderStats, World,
    delta_lanes::{DeltaLight, PointLanes, RadianceLanes},
    tile_renderer::ShadingPoint,
};

/// Up to sixteen shading points of one cell, or neighbours where there are no cells, for
/// lights without extent.
pub(crate) struct DeltaGroup<'a> {
    cell: Option<&'a LieCell>,
    points: PointLanes,
    /// Each lane's pixel.
    pixels: [usize; PACKET],
    len: usize,
}

impl<'a> DeltaGroup<'a> {
    /// Groups points. `order` is for its use, and spares an allocation.
    pub(crate) fn gather(
        points: &[ShadingPoint<'a>],
        order: &mut Vec<(usize, u32)>,
        groups: &mut Vec<Self>,
    ) {
        groups.clear();
        order.clear();
        let address =
            |cell: Option<&LieCell>| cell.map_or(0, |cell| std::ptr::from_ref(cell).addr());
        order.extend(
            (0..)
                .zip(points)
                .map(|(index, point)| (address(point.cell), index)),
        );
        // Stable, and each point's light does not depend on who shares its group.
        if points.iter().any(|point| point.cell.is_some()) {
            order.sort_unstable();
        }
        for run in order.chunk_by(|a, b| a.0 == b.0) {
            for chunk in run.chunks(PACKET) {
                let mut group = Self {
                    cell: points[chunk[0].1 as usize].cell,
                    points: PointLanes::new(),
                    pixels: [0; PACKET],
                    len: chunk.len(),
                };
                for (lane, (_, index)) in chunk.iter().enumerate() {
                    let point = &points[*index as usize];
                    group.points.set(lane, &point.surface, &point.brdf);
                    group.pixels[lane] = point.pixel;
                }
                groups.push(group);
            }
        }
    }

    /// Unoccluded lights: no rays at all.
    pub(crate) fn unoccluded(&self, world: &World, sums: &mut [Vec3]) {
        let Some(cell) = self.cell else { return };
        let lights = cell.unoccluded.iter();
        let mut total = self.take(sums);
        for light in lights.filter_map(|&light| world.delta_light(light)) {
            add(&mut total, &self.points.shade(light), u32::MAX);
        }
        self.give(&total, sums);
    }

    /// Partially occluded lights: rays against the occluders alone.
    pub(crate) fn partial(&self, world: &World, stats: &mut RenderStats, sums: &mut [Vec3]) {
        let Some(cell) = self.cell else { return };
        let mut total = self.take(sums);
        for entry in &cell.partial_delta {
            let Some(light) = world.delta_light(entry.light) else {
                continue;
            };
            let rays = self.light(light, &mut total, |rays| {
                world.blocked_by_any(&entry.occluders, rays)
            });
            stats.list_rays += rays;
            stats.occluder_tests += rays * entry.occluders.len() as u64;
        }
        self.give(&total, sums);
    }

    /// Lights that too little is known of, or all if there is no cell: rays through the scene.
    pub(crate) fn traced(&self, world: &World, stats: &mut RenderStats, sums: &mut [Vec3]) {
        let mut total = self.take(sums);
        let mut trace = |light: &DeltaLight| {
            let accel = world.accel();
            stats.shadow_rays += self.light(light, &mut total, |rays| accel.blocked_packet(rays));
        };
        match self.cell {
            Some(cell) => {
                let lights = cell.traced.iter();
                lights
                    .filter_map(|&light| world.delta_light(light))
                    .for_each(&mut trace);
            }
            None => world.delta_lights().for_each(&mut trace),
        }
        self.give(&total, sums);
    }

    /// Adds one light where `blocked` lets it through. How many rays that took.
    #[inline]
    fn light(
        &self,
        light: &DeltaLight,
        total: &mut RadianceLanes,
        blocked: impl FnOnce(&RayPacket) -> u32,
    ) -> u64 {
        let radiance = self.points.shade(light);
        let lit = lit(&radiance);
        if lit == 0 {
            return 0;
        }
        let rays = RayPacket::fan(light.position, &self.points.origin, lit);
        add(total, &radiance, !blocked(&rays));
        u64::from(lit.count_ones())
    }

    /// The pixels' sums so far.
    fn take(&self, sums: &[Vec3]) -> RadianceLanes {
        let mut total = [[0.0; PACKET]; 3];
        for (lane, &pixel) in self.pixels[..self.len].iter().enumerate() {
            for channel in 0..3 {
                total[channel][lane] = sums[pixel][channel];
            }
        }
        total
    }

    fn give(&self, total: &RadianceLanes, sums: &mut [Vec3]) {
        for (lane, &pixel) in self.pixels[..self.len].iter().enumerate() {
            sums[pixel] = Vec3::new(total[0][lane], total[1][lane], total[2][lane]);
        }
    }
}

/// Adds in the lanes whose bits are set.
fn add(total: &mut RadianceLanes, radiance: &RadianceLanes, lanes: u32) {
    for channel in 0..3 {
        for lane in 0..PACKET {
            let given = lanes & (1 << lane) != 0;
            total[channel][lane] += if given { radiance[channel][lane] } else { 0.0 };
        }
    }
}

/// Lanes that a light gives anything.
fn lit(radiance: &RadianceLanes) -> u32 {
    let mut lit = 0;
    for lane in 0..PACKET {
        let any = (radiance[0][lane] > 0.0) | (radiance[1][lane] > 0.0) | (radiance[2][lane] > 0.0);
        lit |= u32::from(any) << lane;
    }
    lit
}
