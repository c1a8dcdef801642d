use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use glam::{UVec2, Vec3};
use lie_accel::PACKET;
use lie_geom::sampling::strata;
use lie_scene::{Camera, RenderSettings};

use crate::{
    LieLookup, LightRay, RadianceTile, RenderStats, Tile, World,
    area_lanes::AreaLanes,
    cell_sort::CellSort,
    first_hits::{FirstHits, SQUARE, SquareHits},
    groups::Groups,
    one_by_one::OneByOne,
    point_group::{GroupWork, ListScratch, PointGroup},
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
        camera: FirstHits {
            world,
            film: camera.film(settings.size),
            settings,
            is_one_by_one: settings.ward.is_some()
                || world.has_lobe_lights()
                || !world.other_lights().is_empty(),
        },
        settings,
        stats: RenderStats::default(),
        hits: SquareHits::default(),
        sorted: CellSort::default(),
        groups: Groups::default(),
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

struct TileRenderer<'a> {
    world: &'a World,
    lies: Option<&'a dyn LieLookup>,
    camera: FirstHits<'a>,
    settings: &'a FrameSettings,
    stats: RenderStats,
    hits: SquareHits<'a>,
    sorted: CellSort<'a>,
    groups: Groups<'a>,
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
            let rays = self.camera.find(square, sample, &mut self.hits, &mut sums);
            self.stats.primary_rays += rays;
            let clock = lap(clock, &mut self.stats.visibility_ns);
            self.groups.clear();
            self.find_cells();
            let groups = match self.lies {
                Some(_) => self.groups.as_slice(),
                None => self.hits.blocks.as_slice(),
            };
            let one_by_one = OneByOne {
                world: self.world,
                points: &self.hits.points,
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
                groups.iter().for_each(|group| group.unoccluded(&mut work));
                one_by_one.unoccluded(work.sums);
            }
            let clock = lap(clock, &mut work.stats.unoccluded_ns);
            if self.lies.is_some() {
                for run in groups.chunk_by(PointGroup::shares_cell) {
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
                for group in groups {
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

    /// The LIE of each point, and points of one cell in groups of their own.
    fn find_cells(&mut self) {
        let blocks = self.hits.blocks.as_slice();
        let Some(lies) = self.lies else {
            let points: usize = blocks.iter().map(|block| block.lanes().count()).sum();
            let all_lights = self.world.scene().lights.len();
            self.stats.evaluations += (points * all_lights) as u64;
            return;
        };
        let sorted = &mut self.sorted;
        sorted.find(lies, blocks);
        for (cell, points) in sorted.cells() {
            let (answered, traced) = (cell.answered(), cell.traced.len());
            self.stats.trusted += (points.len() * answered) as u64;
            self.stats.evaluations += (points.len() * (answered + traced)) as u64;
            for places in points.chunks(PACKET) {
                self.groups.push().gather(cell, blocks, places);
            }
        }
        for (point, cell) in self.hits.points.iter_mut().zip(sorted.in_order()) {
            point.cell = Some(cell);
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
