use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use glam::{UVec2, Vec3};
use lie_accel::{PACKET, RayPacket};
use lie_geom::{RandomKey, Ray, sampling::strata};
use lie_scene::{Camera, RenderSettings, Surface};

use crate::{
    Brdf, LieCell, LieLookup, LightRay, RadianceTile, RenderStats, Tile, World,
    delta_groups::DeltaGroup, light_rays::LightPoints, shadow_queue::ShadowQueue, ward,
};

/// All that a frame's pixels depend on, beside scene, camera and LIEs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSettings {
    /// Columns and rows.
    pub size: UVec2,
    /// Camera rays per pixel; a single one goes through the pixel's centre.
    pub samples_per_pixel: u32,
    /// Sample points on each area light for each camera ray.
    pub light_samples: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Adaptive shadow testing (Ward 1994) where there are no LIEs: the share of a point's
    /// light, in `[0, 1]`, below which the lights that would give least are estimated.
    pub ward: Option<f32>,
}

impl FrameSettings {
    /// The scene's own settings.
    #[must_use]
    pub fn new(settings: &RenderSettings) -> Self {
        Self {
            size: settings.size,
            samples_per_pixel: settings.samples_per_pixel,
            light_samples: settings.light_samples,
            seed: 0,
            ward: None,
        }
    }
}

/// A rendered tile and what it cost.
#[derive(Clone, Debug, PartialEq)]
pub struct TileResult {
    /// The pixels.
    pub radiance: RadianceTile,
    /// The cost.
    pub stats: RenderStats,
}

/// Renders one tile on this thread. With `lies`, visibility of lights is what they say (LIE
/// §4.2); without, a full shadow ray is traced for every light and sample: the standard ray
/// tracer, and the reference. `None` if `cancelled` became true on the way.
///
/// # Panics
/// If the tile has a side of 0 or more than [`RadianceTile::MAX_SIDE`] pixels.
#[must_use]
pub fn render_tile(
    world: &World,
    lies: Option<&dyn LieLookup>,
    camera: &Camera,
    settings: &FrameSettings,
    tile: Tile,
    cancelled: &AtomicBool,
) -> Option<TileResult> {
    let mut renderer = TileRenderer {
        world,
        lies,
        camera,
        settings,
        light_strata: strata(settings.light_samples),
        stats: RenderStats::default(),
        exact: vec![],
        traced: vec![],
        directions: vec![],
        cancelled,
    };
    let mut sums = vec![Vec3::ZERO; (tile.size.x * tile.size.y) as usize];
    // Squares of 16 × 16 pixels: neighbours that share nodes, occluders and lights.
    for start_y in (0..tile.size.y).step_by(SQUARE as usize) {
        for start_x in (0..tile.size.x).step_by(SQUARE as usize) {
            let start = UVec2::new(start_x, start_y);
            let size = (tile.size - start).min(UVec2::splat(SQUARE));
            let square = Tile {
                origin: tile.origin + start,
                size,
            };
            let pixels = renderer.square(square)?;
            for (index, value) in pixels.into_iter().enumerate() {
                let (x, y) = (index as u32 % size.x, index as u32 / size.x);
                sums[((start.y + y) * tile.size.x + start.x + x) as usize] = value;
            }
        }
    }
    let radiance =
        RadianceTile::new(tile, sums).expect("shading gives finite, non-negative radiance");
    Some(TileResult {
        radiance,
        stats: renderer.stats,
    })
}

const SQUARE: u32 = 16;

struct TileRenderer<'a> {
    world: &'a World,
    lies: Option<&'a dyn LieLookup>,
    camera: &'a Camera,
    settings: &'a FrameSettings,
    light_strata: (u32, u32),
    stats: RenderStats,
    /// Exact rays that wait to be traced, with their pixels.
    exact: Vec<(usize, LightRay)>,
    /// Lights that are traced, with the points that they are traced from.
    traced: Vec<(u32, u32)>,
    /// Lobe directions of the point in work.
    directions: Vec<Vec3>,
    cancelled: &'a AtomicBool,
}

/// A camera ray that met a surface, waiting for its light.
pub(crate) struct ShadingPoint<'a> {
    /// Index of its pixel in the square.
    pub(crate) pixel: usize,
    key: RandomKey,
    pub(crate) surface: Surface,
    pub(crate) brdf: Brdf,
    pub(crate) cell: Option<&'a LieCell>,
}

impl ShadingPoint<'_> {
    /// Tells cells apart.
    pub(crate) fn cell_address(&self) -> usize {
        self.cell.map_or(0, |cell| std::ptr::from_ref(cell).addr())
    }
}

impl<'a> TileRenderer<'a> {
    /// Renders a small square; `None` when cancelled.
    fn square(&mut self, square: Tile) -> Option<Vec<Vec3>> {
        let mut sums = vec![Vec3::ZERO; (square.size.x * square.size.y) as usize];
        let mut groups = vec![];
        for sample in 0..self.settings.samples_per_pixel {
            if self.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let clock = Instant::now();
            let mut points = self.shading_points(square, sample, &mut sums);
            // Each pixel's sums keep their order, whatever the order of the points.
            points.sort_by_key(ShadingPoint::cell_address);
            let clock = lap(clock, &mut self.stats.visibility_ns);
            DeltaGroup::gather(&points, &mut groups);
            for group in &groups {
                group.unoccluded(self.world, &mut sums);
            }
            self.unoccluded(&points, &mut sums);
            let clock = lap(clock, &mut self.stats.unoccluded_ns);
            for group in &groups {
                group.partial(self.world, &mut self.stats, &mut sums);
            }
            self.partial(&points, &mut sums)?;
            let clock = lap(clock, &mut self.stats.partial_ns);
            match self.settings.ward.filter(|_| self.lies.is_none()) {
                Some(threshold) => self.ward(threshold, &points, &mut sums)?,
                None => self.full(&points, &mut sums)?,
            }
            lap(clock, &mut self.stats.full_ns);
        }
        let share = 1.0 / self.settings.samples_per_pixel as f32;
        Some(sums.into_iter().map(|sum| finite(sum * share)).collect())
    }

    /// Primary visibility: packets of 4 × 4 pixels. Emission and background are added at once.
    fn shading_points(
        &mut self,
        square: Tile,
        sample: u32,
        sums: &mut [Vec3],
    ) -> Vec<ShadingPoint<'a>> {
        let mut points = Vec::with_capacity(sums.len());
        for y in (0..square.size.y).step_by(4) {
            for x in (0..square.size.x).step_by(4) {
                let start = UVec2::new(x, y);
                let size = (square.size - start).min(UVec2::splat(4));
                let mut rays = [Ray::new(Vec3::ZERO, Vec3::X); PACKET];
                let mut pixels = [(0, RandomKey::new(0)); PACKET];
                let count = (size.x * size.y) as usize;
                for lane in 0..count {
                    let offset = UVec2::new(lane as u32 % size.x, lane as u32 / size.x);
                    let pixel = start + offset;
                    let (ray, key) =
                        self.settings
                            .camera_ray(self.camera, square.origin + pixel, sample);
                    rays[lane] = ray;
                    pixels[lane] = ((pixel.y * square.size.x + pixel.x) as usize, key);
                }
                let hits = self
                    .world
                    .accel()
                    .closest_packet(&RayPacket::new(&rays[..count]));
                self.stats.primary_rays += count as u64;
                for lane in 0..count {
                    let (pixel, key) = pixels[lane];
                    match hits[lane] {
                        None => sums[pixel] += self.world.scene().background.radiance,
                        Some(hit) => {
                            let surface = self.world.scene().surface(&rays[lane], &hit);
                            sums[pixel] += self.emission(&surface);
                            points.push(self.shading_point(pixel, key, surface));
                        }
                    }
                }
            }
        }
        points
    }

    fn shading_point(
        &mut self,
        pixel: usize,
        key: RandomKey,
        surface: Surface,
    ) -> ShadingPoint<'a> {
        let cell = self.lies.map(|lies| lies.cell(surface.position));
        let answered = cell.map_or(0, LieCell::answered);
        let traced = cell.map_or(self.world.scene().lights.len(), |cell| cell.traced.len());
        self.stats.trusted += answered as u64;
        self.stats.evaluations += (answered + traced) as u64;
        let brdf = Brdf::new(self.world.scene(), &surface);
        ShadingPoint {
            pixel,
            key,
            surface,
            brdf,
            cell,
        }
    }

    fn emission(&self, surface: &Surface) -> Vec3 {
        let material = self.world.scene().material_at(surface);
        if surface.front || material.double_sided {
            material.emission
        } else {
            Vec3::ZERO
        }
    }

    /// Unoccluded lights with extent: no rays at all, but for exact ones.
    fn unoccluded(&mut self, points: &[ShadingPoint<'_>], sums: &mut [Vec3]) {
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

    /// Partially occluded lights with extent: rays against the occluders alone, but for
    /// exact ones.
    fn partial(&mut self, points: &[ShadingPoint<'_>], sums: &mut [Vec3]) -> Option<()> {
        let cutout = self.world.scene();
        for point in points {
            if self.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let light_points = self.light_points(point);
            for entry in point.cell.map_or(&[][..], |cell| &cell.partial) {
                let mut rays = 0;
                self.world
                    .for_each_light_ray(entry.light, &light_points, |ray| {
                        if ray.exact {
                            self.exact.push((point.pixel, ray));
                            return;
                        }
                        rays += 1;
                        if !entry.occluders.is_blocked(&ray.ray, Some(cutout)) {
                            sums[point.pixel] += ray.radiance;
                        }
                    });
                self.stats.list_rays += rays;
                self.stats.occluder_tests += rays * entry.occluders.len() as u64;
            }
        }
        Some(())
    }

    /// Rays through the whole scene: exact ones, those to doubtful lights, and all where
    /// there are no LIEs. Light by light, so that neighbouring points' rays to one light
    /// share a packet.
    fn full(&mut self, points: &[ShadingPoint<'_>], sums: &mut [Vec3]) -> Option<()> {
        let mut queue = ShadowQueue::new(self.world.accel());
        for (pixel, ray) in self.exact.drain(..) {
            queue.push(&ray, pixel, sums);
        }
        self.gather_traced(points);
        for (count, &(index, point)) in self.traced.iter().enumerate() {
            if count % 1024 == 0 && self.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let point = &points[point as usize];
            let light_points = self.light_points(point);
            let trace = |ray: LightRay| queue.push(&ray, point.pixel, sums);
            self.world.for_each_light_ray(index, &light_points, trace);
        }
        let follow = if self.world.has_lobe_lights() {
            points
        } else {
            &[]
        };
        for point in follow {
            let light_points = self.light_points(point);
            light_points.lobe_directions(&mut self.directions);
            let trace = |ray: LightRay| queue.push(&ray, point.pixel, sums);
            self.world
                .for_each_lobe_ray(&light_points, &self.directions, trace);
        }
        queue.flush(sums);
        self.stats.shadow_rays += queue.traced;
        Some(())
    }

    /// Which lights are traced from which points, light by light.
    fn gather_traced(&mut self, points: &[ShadingPoint<'_>]) {
        self.traced.clear();
        let lights = 0..self.world.scene().lights.len() as u32;
        if self.lies.is_none() {
            let of_light = |light| (0..points.len() as u32).map(move |point| (light, point));
            self.traced.extend(lights.flat_map(of_light));
            return;
        }
        for (index, point) in (0..).zip(points) {
            let traced = point.cell.map_or(&[][..], |cell| &cell.traced);
            self.traced
                .extend(traced.iter().map(|&light| (light, index)));
        }
        self.traced.sort_unstable();
    }

    /// All lights, by adaptive shadow testing.
    fn ward(
        &mut self,
        threshold: f32,
        points: &[ShadingPoint<'_>],
        sums: &mut [Vec3],
    ) -> Option<()> {
        let points = points
            .iter()
            .map(|point| (point.pixel, self.light_points(point)));
        let traced = ward::shade(self.world, threshold, points, sums, self.cancelled)?;
        self.stats.shadow_rays += traced;
        Some(())
    }

    fn light_points<'p>(&self, point: &'p ShadingPoint<'_>) -> LightPoints<'p> {
        LightPoints {
            surface: &point.surface,
            brdf: &point.brdf,
            key: point.key,
            strata: self.light_strata,
        }
    }
}

/// Adds the time since `clock` and starts anew.
fn lap(clock: Instant, total: &mut u64) -> Instant {
    let now = Instant::now();
    *total += now.duration_since(clock).as_nanos() as u64;
    now
}

/// A sum that overflowed is cut to the largest number: a lamp touching a surface must not
/// make the picture undefined.
fn finite(value: Vec3) -> Vec3 {
    value.clamp(Vec3::ZERO, Vec3::splat(f32::MAX))
}
