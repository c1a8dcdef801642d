use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;
use lie_accel::{PACKET, RayPacket};
use lie_geom::{Ray, sampling::strata};

use crate::{
    FrameSettings, LieLight, LightRay, RenderStats, World, light_rays::LightPoints,
    shadow_queue::ShadowQueue, tile_renderer::ShadingPoint, ward,
};

/// Light from area lights and directional ones, point by point: many rays go from each.
pub(crate) struct ExtentLights<'a> {
    world: &'a World,
    strata: (u32, u32),
    /// Rays that must go through the scene whatever the cell says, with their pixels.
    exact: Vec<(usize, LightRay)>,
    cancelled: &'a AtomicBool,
}

impl<'a> ExtentLights<'a> {
    pub(crate) fn new(
        world: &'a World,
        settings: &FrameSettings,
        cancelled: &'a AtomicBool,
    ) -> Self {
        Self {
            world,
            strata: strata(settings.light_samples),
            exact: vec![],
            cancelled,
        }
    }

    /// Unoccluded lights: no rays at all, but for exact ones.
    pub(crate) fn unoccluded(&mut self, points: &[ShadingPoint<'_>], sums: &mut [Vec3]) {
        for point in points {
            let light_points = self.light_points(point);
            for &index in point.cell.map_or(&[][..], |cell| &cell.unoccluded) {
                if self.world.delta_light(index).is_some() {
                    continue;
                }
                self.world.for_each_light_ray(index, &light_points, |ray| {
                    if ray.exact {
                        self.exact.push((point.pixel, ray));
                    } else {
                        sums[point.pixel] += ray.radiance;
                    }
                });
            }
        }
    }

    /// Partially occluded lights: rays against the occluders alone, but for exact ones.
    pub(crate) fn partial(
        &mut self,
        points: &[ShadingPoint<'_>],
        stats: &mut RenderStats,
        sums: &mut [Vec3],
    ) -> Option<()> {
        for point in points {
            if self.is_cancelled() {
                return None;
            }
            for entry in point.cell.map_or(&[][..], |cell| &cell.partial) {
                let rays = self.listed(point, entry, &mut sums[point.pixel]);
                stats.list_rays += rays;
                stats.occluder_tests += rays * entry.occluders.len() as u64;
            }
        }
        Some(())
    }

    /// Adds what one partially occluded light gives a point. How many rays that took.
    fn listed(&mut self, point: &ShadingPoint<'_>, entry: &LieLight, sum: &mut Vec3) -> u64 {
        let world = self.world;
        let light_points = self.light_points(point);
        let mut rays = [Ray::new(Vec3::ZERO, Vec3::X); PACKET];
        let mut radiances = [Vec3::ZERO; PACKET];
        let (mut len, mut count) = (0, 0);
        let mut test = |rays: &[Ray], radiances: &[Vec3; PACKET]| {
            let blocked = world.blocked_by_any(&entry.occluders, &RayPacket::new(rays));
            for (lane, radiance) in radiances[..rays.len()].iter().enumerate() {
                if blocked >> lane & 1 == 0 {
                    *sum += *radiance;
                }
            }
            count += rays.len() as u64;
        };
        world.for_each_light_ray(entry.light, &light_points, |ray| {
            if ray.exact {
                self.exact.push((point.pixel, ray));
                return;
            }
            (rays[len], radiances[len]) = (ray.ray, ray.radiance);
            len += 1;
            if len == PACKET {
                test(&rays, &radiances);
                len = 0;
            }
        });
        if len > 0 {
            test(&rays[..len], &radiances);
        }
        count
    }

    /// Rays through the whole scene: exact ones, those to doubtful lights, and all where there
    /// are no LIEs.
    pub(crate) fn traced(
        &mut self,
        points: &[ShadingPoint<'_>],
        stats: &mut RenderStats,
        sums: &mut [Vec3],
    ) -> Option<()> {
        let mut queue = ShadowQueue::new(self.world.accel());
        for (pixel, ray) in self.exact.drain(..) {
            queue.push(&ray, pixel, sums);
        }
        for (count, (index, point)) in self.to_trace(points).into_iter().enumerate() {
            if count % 256 == 0 && self.is_cancelled() {
                return None;
            }
            let point = &points[point as usize];
            let light_points = self.light_points(point);
            let trace = |ray: LightRay| queue.push(&ray, point.pixel, sums);
            self.world.for_each_light_ray(index, &light_points, trace);
        }
        let mut directions = vec![];
        let follow = if self.world.has_lobe_lights() {
            points
        } else {
            &[]
        };
        for point in follow {
            let light_points = self.light_points(point);
            light_points.lobe_directions(&mut directions);
            let trace = |ray: LightRay| queue.push(&ray, point.pixel, sums);
            self.world
                .for_each_lobe_ray(&light_points, &directions, trace);
        }
        queue.flush(sums);
        stats.shadow_rays += queue.traced;
        Some(())
    }

    /// All lights, without extent too, by adaptive shadow testing.
    pub(crate) fn ward(
        &self,
        threshold: f32,
        points: &[ShadingPoint<'_>],
        stats: &mut RenderStats,
        sums: &mut [Vec3],
    ) -> Option<()> {
        let points = points
            .iter()
            .map(|point| (point.pixel, self.light_points(point)));
        stats.shadow_rays += ward::shade(self.world, threshold, points, sums, self.cancelled)?;
        Some(())
    }

    /// Which lights are traced from which points, light by light, so that neighbouring points'
    /// rays to one light share a packet.
    fn to_trace(&self, points: &[ShadingPoint<'_>]) -> Vec<(u32, u32)> {
        let others = self.world.other_lights();
        let mut pairs = vec![];
        if points.iter().all(|point| point.cell.is_none()) {
            let of_light = |&light| (0..points.len() as u32).map(move |point| (light, point));
            pairs.extend(others.iter().flat_map(of_light));
            return pairs;
        }
        for (index, point) in (0..).zip(points) {
            let traced = point.cell.map_or(others, |cell| &cell.traced);
            let mine = traced.iter().map(|&light| (light, index));
            pairs.extend(mine.filter(|&(light, _)| self.world.delta_light(light).is_none()));
        }
        pairs.sort_unstable();
        pairs
    }

    fn light_points<'p>(&self, point: &'p ShadingPoint<'_>) -> LightPoints<'p> {
        LightPoints {
            surface: &point.surface,
            brdf: &point.brdf,
            key: point.key,
            strata: self.strata,
        }
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}
