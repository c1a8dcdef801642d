use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;

use lie_accel::RayPacket;

use crate::{
    LieCell, LightRay, World, light_rays::LightPoints, occluder_lists::OpenLists,
    shading_point::ShadingPoint, shadow_queue::ShadowQueue, ward,
};

/// Light that is gathered point by point: directional lights, rays along smooth surfaces'
/// lobes, and what adaptive shadow testing asks for.
pub(crate) struct OneByOne<'a> {
    pub(crate) world: &'a World,
    pub(crate) points: &'a [ShadingPoint<'a>],
    pub(crate) strata: (u32, u32),
    pub(crate) cancelled: &'a AtomicBool,
}

impl OneByOne<'_> {
    /// Unoccluded directional lights: no rays at all.
    pub(crate) fn unoccluded(&self, sums: &mut [Vec3]) {
        for &light in self.world.other_lights() {
            for point in self.points {
                if point
                    .cell
                    .is_some_and(|cell| cell.unoccluded.contains(light))
                {
                    let add = |ray: LightRay| sums[point.pixel] += ray.radiance;
                    self.world
                        .for_each_light_ray(light, &self.light_points(point), add);
                }
            }
        }
    }

    /// Partially occluded directional lights. How many rays, and triangles in their lists.
    pub(crate) fn partial(&self, lists: &mut OpenLists, sums: &mut [Vec3]) -> (u64, u64) {
        let (mut rays, mut tests) = (0, 0);
        let others = self.world.other_lights();
        if others.is_empty() {
            return (rays, tests);
        }
        let mut opened = None;
        for point in self.points {
            let Some(cell) = point.cell else { continue };
            // Neighbours mostly share a cell.
            if !opened.is_some_and(|before| std::ptr::eq(before, cell)) {
                lists.open(&cell.partial, self.world.scene().geometry.shapes());
                opened = Some(cell);
            }
            for list in lists
                .lights
                .iter()
                .filter(|list| others.contains(&list.light))
            {
                let trace = |ray: LightRay| {
                    rays += 1;
                    tests += list.occluders;
                    let packet = RayPacket::new(&[ray.ray]);
                    if lists.blocked(list, &packet, self.world.cutout()) == 0 {
                        sums[point.pixel] += ray.radiance;
                    }
                };
                self.world
                    .for_each_light_ray(list.light, &self.light_points(point), trace);
            }
        }
        (rays, tests)
    }

    /// Rays through the whole scene: those left over, those to doubtful directional lights or
    /// to all where there are no LIEs, and those that follow a lobe. How many, or `None` when
    /// cancelled.
    pub(crate) fn traced(
        &self,
        left: &mut Vec<(usize, LightRay)>,
        sums: &mut [Vec3],
    ) -> Option<u64> {
        let mut queue = ShadowQueue::new(self.world.accel());
        for (pixel, ray) in left.drain(..) {
            queue.push(&ray, pixel, sums);
        }
        let others = self.world.other_lights();
        for &light in others {
            for point in self.points {
                let is_traced = |cell: &LieCell| cell.traced.contains(light);
                if point.cell.is_none_or(is_traced) {
                    let trace = |ray: LightRay| queue.push(&ray, point.pixel, sums);
                    self.world
                        .for_each_light_ray(light, &self.light_points(point), trace);
                }
            }
        }
        let follow = if self.world.has_lobe_lights() {
            self.points
        } else {
            &[]
        };
        let mut directions = vec![];
        for point in follow {
            if self.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let light_points = self.light_points(point);
            light_points.lobe_directions(&mut directions);
            let trace = |ray: LightRay| queue.push(&ray, point.pixel, sums);
            self.world
                .for_each_lobe_ray(&light_points, &directions, trace);
        }
        queue.flush(sums);
        Some(queue.traced)
    }

    /// All lights, by adaptive shadow testing. How many rays, or `None` when cancelled.
    pub(crate) fn ward(&self, threshold: f32, sums: &mut [Vec3]) -> Option<u64> {
        let points = self.points.iter();
        let points = points.map(|point| (point.pixel, self.light_points(point)));
        ward::shade(self.world, threshold, points, sums, self.cancelled)
    }

    fn light_points<'p>(&self, point: &'p ShadingPoint<'_>) -> LightPoints<'p> {
        LightPoints {
            surface: &point.surface,
            brdf: &point.brdf,
            key: point.key,
            strata: self.strata,
        }
    }
}
