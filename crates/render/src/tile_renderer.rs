use std::{
    cell::Cell,
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use glam::{UVec2, Vec3};
use lie_accel::PACKET;
use lie_geom::sampling::strata;
use lie_scene::{Camera, RenderSettings};

use crate::{
    LieCell, LieLookup, LightRay, RadianceTile, RenderStats, Tile, World,
    area_lanes::AreaLanes,
    cell_sort::CellSort,
    first_hits::{FirstHits, SQUARE, SquareHits},
    groups::Groups,
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
        points: vec![],
        sorted: CellSort::default(),
        cells: vec![],
        scratch: SCRATCH.take().unwrap_or_default(),
        cache: ShadowCache::new(world.scene().lights.len()),
        cancelled,
    };
    let sums = renderer.tile(tile);
    SCRATCH.set(Some(renderer.scratch));
    let radiance =
        RadianceTile::new(tile, sums?).expect("shading gives finite, non-negative radiance");
    Some(TileResult {
        radiance,
        stats: renderer.stats,
    })
}

/// What a tile is worked out in. A thread keeps it for its next tile, for what it has allocated:
/// nothing in it outlives a tile otherwise.
#[derive(Default)]
struct Scratch {
    hits: SquareHits,
    groups: Groups,
    exact: Vec<(usize, LightRay)>,
    samples: Vec<AreaLanes>,
    lists: ListScratch,
}

thread_local! {
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

struct TileRenderer<'a> {
    world: &'a World,
    lies: Option<&'a dyn LieLookup>,
    camera: FirstHits<'a>,
    settings: &'a FrameSettings,
    stats: RenderStats,
    /// What camera rays met, where lights need their points one by one.
    points: Vec<ShadingPoint<'a>>,
    sorted: CellSort<'a>,
    /// Each cell with its groups of points.
    cells: Vec<(&'a LieCell, Range<usize>)>,
    scratch: Box<Scratch>,
    cache: ShadowCache,
    cancelled: &'a AtomicBool,
}

impl TileRenderer<'_> {
    /// Each pixel's radiance; `None` when cancelled.
    fn tile(&mut self, tile: Tile) -> Option<Vec<Vec3>> {
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
                let pixels = self.square(square)?;
                for (index, value) in pixels.into_iter().enumerate() {
                    let (x, y) = (index as u32 % size.x, index as u32 / size.x);
                    sums[((start.y + y) * tile.size.x + start.x + x) as usize] = value;
                }
            }
        }
        Some(sums)
    }

    /// Renders a small square; `None` when cancelled.
    fn square(&mut self, square: Tile) -> Option<Vec<Vec3>> {
        let mut sums = vec![Vec3::ZERO; (square.size.x * square.size.y) as usize];
        for sample in 0..self.settings.samples_per_pixel {
            if self.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let clock = Instant::now();
            let Scratch { hits, .. } = &mut *self.scratch;
            let points = &mut self.points;
            self.stats.primary_rays += self.camera.find(square, sample, hits, points, &mut sums);
            lap(clock, &mut self.stats.visibility_ns);
            self.shade(&mut sums)?;
        }
        let share = 1.0 / self.settings.samples_per_pixel as f32;
        Some(sums.into_iter().map(|sum| finite(sum * share)).collect())
    }

    /// Adds the light of what camera rays met: of lights that LIEs show without a ray, of those
    /// behind their occluders alone, and of all others. `None` when cancelled.
    fn shade(&mut self, sums: &mut [Vec3]) -> Option<()> {
        let clock = Instant::now();
        self.find_cells();
        let strata = strata(self.settings.light_samples);
        let Scratch {
            hits,
            groups,
            exact,
            samples,
            lists,
        } = &mut *self.scratch;
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
            sums,
            exact,
            samples,
        };
        let cells = self.cells.iter();
        let cells = cells.map(|(cell, range)| (*cell, &groups.as_slice()[range.clone()]));
        for (cell, groups) in cells.clone() {
            if self.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            for group in groups {
                group.unoccluded(cell, &mut work);
            }
        }
        one_by_one.unoccluded(work.sums);
        let clock = lap(clock, &mut work.stats.unoccluded_ns);
        for (cell, groups) in cells.clone() {
            if self.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            PointGroup::partial(groups, cell, &mut work, lists);
        }
        let (rays, tests) = one_by_one.partial(&mut lists.lists, work.sums);
        work.stats.list_rays += rays;
        work.stats.occluder_tests += tests;
        let clock = lap(clock, &mut work.stats.partial_ns);
        match (self.lies, self.settings.ward) {
            (None, Some(threshold)) => {
                work.stats.shadow_rays += one_by_one.ward(threshold, work.sums)?;
            }
            (lies, _) => {
                let all = lies.is_none().then(|| (None, hits.blocks.as_slice()));
                let in_cells = cells.map(|(cell, groups)| (Some(cell), groups));
                for (cell, groups) in in_cells.chain(all) {
                    for group in groups {
                        if self.cancelled.load(Ordering::Relaxed) {
                            return None;
                        }
                        group.traced(cell, &mut work);
                    }
                }
                work.stats.shadow_rays += one_by_one.traced(work.exact, work.sums)?;
            }
        }
        lap(clock, &mut self.stats.full_ns);
        Some(())
    }

    /// The LIE of each point, and points of one cell in groups of their own.
    fn find_cells(&mut self) {
        let Scratch {
            hits,
            groups,
            exact,
            ..
        } = &mut *self.scratch;
        groups.clear();
        exact.clear();
        self.cells.clear();
        let blocks = hits.blocks.as_slice();
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
            let first = groups.len();
            for places in points.chunks(PACKET) {
                groups.push().gather(blocks, places);
            }
            self.cells.push((cell, first..groups.len()));
        }
        for (point, cell) in self.points.iter_mut().zip(sorted.in_order()) {
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
