use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use glam::{UVec2, Vec3};
use lie_accel::{PACKET, RayPacket};
use lie_geom::{RandomKey, Ray, sampling::strata};
use lie_scene::{Camera, CameraFilm, RenderSettings};

use crate::{
    Brdf, LieLookup, LightRay, RadianceTile, RenderStats, Tile, World,
    area_lanes::AreaLanes,
    one_by_one::OneByOne,
    point_group::{GroupWork, ListScratch, PointGroup},
    shading_point::ShadingPoint,
    shadow_cache::ShadowCache,
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
        film: camera.film(settings.size),
        settings,
        stats: RenderStats::default(),
        points: vec![],
        order: vec![],
        groups: vec![],
        exact: vec![],
        samples: vec![],
        scratch: ListScratch::default(),
        cache: ShadowCache::new(world.scene().lights.len()),
        cancelled,
    };
    let mut sums = vec![Vec3::ZERO; (tile.size.x * tile.size.y) as usize];
    // Squares of neighbours, which share nodes, occluders and lights.
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

/// Pixels along a side of what is rendered together.
const SQUARE: u32 = 64;

/// Pixels along a side of a packet of camera rays.
const BLOCK: u32 = 4;

struct TileRenderer<'a> {
    world: &'a World,
    lies: Option<&'a dyn LieLookup>,
    film: CameraFilm,
    settings: &'a FrameSettings,
    stats: RenderStats,
    /// What a square's camera rays met.
    points: Vec<ShadingPoint<'a>>,
    order: Vec<(usize, u32)>,
    groups: Vec<PointGroup<'a>>,
    exact: Vec<(usize, LightRay)>,
    samples: Vec<AreaLanes>,
    scratch: ListScratch,
    cache: ShadowCache,
    cancelled: &'a AtomicBool,
}

impl TileRenderer<'_> {
    /// Renders a small square; `None` when cancelled.
    fn square(&mut self, square: Tile) -> Option<Vec<Vec3>> {
        let mut sums = vec![Vec3::ZERO; (square.size.x * square.size.y) as usize];
        let ward = self.settings.ward.filter(|_| self.lies.is_none());
        let strata = strata(self.settings.light_samples);
        for sample in 0..self.settings.samples_per_pixel {
            if self.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let clock = Instant::now();
            self.find_points(square, sample, &mut sums);
            let clock = lap(clock, &mut self.stats.visibility_ns);
            self.find_cells();
            if ward.is_none() {
                PointGroup::gather(&self.points, &mut self.order, &mut self.groups);
            }
            let one_by_one = OneByOne {
                world: self.world,
                points: &self.points,
                strata,
                cancelled: self.cancelled,
            };
            let mut work = GroupWork {
                world: self.world,
                strata,
                stats: &mut self.stats,
                cache: &mut self.cache,
                sums: &mut sums,
                exact: &mut self.exact,
                samples: &mut self.samples,
            };
            if self.lies.is_some() {
                self.groups
                    .iter()
                    .for_each(|group| group.unoccluded(&mut work));
                one_by_one.unoccluded(work.sums);
            }
            let clock = lap(clock, &mut work.stats.unoccluded_ns);
            if self.lies.is_some() {
                for run in self.groups.chunk_by(PointGroup::shares_cell) {
                    PointGroup::partial(run, &mut work, &mut self.scratch);
                }
                let (rays, tests) = one_by_one.partial(&mut self.scratch.lists, work.sums);
                work.stats.list_rays += rays;
                work.stats.occluder_tests += tests;
            }
            let clock = lap(clock, &mut work.stats.partial_ns);
            if let Some(threshold) = ward {
                work.stats.shadow_rays += one_by_one.ward(threshold, work.sums)?;
            } else {
                for group in &self.groups {
                    if self.cancelled.load(Ordering::Relaxed) {
                        return None;
                    }
                    group.traced(&mut work);
                }
                work.stats.shadow_rays += one_by_one.traced(work.exact, work.sums)?;
            }
            lap(clock, &mut self.stats.full_ns);
        }
        let share = 1.0 / self.settings.samples_per_pixel as f32;
        Some(sums.into_iter().map(|sum| finite(sum * share)).collect())
    }

    /// Primary visibility: packets of 4 × 4 pixels, in Z order, so that points that follow each
    /// other are near each other. Emission and background are added at once.
    fn find_points(&mut self, square: Tile, sample: u32, sums: &mut [Vec3]) {
        self.points.clear();
        for index in 0..(SQUARE / BLOCK) * (SQUARE / BLOCK) {
            let start = BLOCK * UVec2::new(every_other_bit(index), every_other_bit(index >> 1));
            if start.cmplt(square.size).all() {
                self.find_block(square, start, sample, sums);
            }
        }
    }

    /// Primary visibility of up to 4 × 4 pixels of a square, from `start` on.
    fn find_block(&mut self, square: Tile, start: UVec2, sample: u32, sums: &mut [Vec3]) {
        let scene = self.world.scene();
        let size = (square.size - start).min(UVec2::splat(BLOCK));
        let mut rays = [Ray::new(Vec3::ZERO, Vec3::X); PACKET];
        let mut pixels = [(0, RandomKey::new(0)); PACKET];
        let count = (size.x * size.y) as usize;
        for lane in 0..count {
            let offset = UVec2::new(lane as u32 % size.x, lane as u32 / size.x);
            let pixel = start + offset;
            let place = square.origin + pixel;
            let (ray, key) = self.settings.camera_ray(&self.film, place, sample);
            rays[lane] = ray;
            pixels[lane] = ((pixel.y * square.size.x + pixel.x) as usize, key);
        }
        let packet = RayPacket::new(&rays[..count]);
        let hits = self.world.accel().closest_packet(&packet);
        self.stats.primary_rays += count as u64;
        for lane in 0..count {
            let (pixel, key) = pixels[lane];
            let Some(hit) = &hits[lane] else {
                sums[pixel] += scene.background.radiance;
                continue;
            };
            let surface = scene.surface(&rays[lane], hit);
            sums[pixel] += self.world.emission(&surface);
            self.points.push(ShadingPoint {
                pixel,
                key,
                brdf: Brdf::new(scene, &surface),
                surface,
                cell: None,
            });
        }
    }

    /// The LIE of each point.
    fn find_cells(&mut self) {
        let all_lights = self.world.scene().lights.len();
        let Some(lies) = self.lies else {
            self.stats.evaluations += (self.points.len() * all_lights) as u64;
            return;
        };
        let mut cells = Vec::with_capacity(self.points.len());
        let mut positions = self.points.iter().map(|point| point.surface.shadow_origin);
        lies.for_each_cell(&mut positions, &mut |cell| cells.push(cell));
        for (point, cell) in self.points.iter_mut().zip(cells) {
            point.cell = Some(cell);
            self.stats.trusted += cell.answered() as u64;
            self.stats.evaluations += (cell.answered() + cell.traced.len()) as u64;
        }
    }
}

/// The bits at even places.
fn every_other_bit(number: u32) -> u32 {
    let bits = number & 0x5555;
    let bits = (bits | bits >> 1) & 0x3333;
    let bits = (bits | bits >> 2) & 0x0f0f;
    (bits | bits >> 4) & 0x00ff
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
