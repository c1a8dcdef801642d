//! Holds what LIEs answer against true shadow rays, on a few of a frame's pixels.

use glam::{UVec2, Vec3};
use lie_accel::{PACKET, RayPacket};
use lie_geom::{RandomKey, Ray, sampling::strata};
use lie_scene::{Camera, Surface};

use crate::{
    Brdf, FrameSettings, LieCell, LieLookup, LightAnswer, LightPoints, Tile, World,
    cell_answers::{CellAnswers, RayAnswer},
};

/// What an audit came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Audit {
    /// Shadow rays that LIEs answer for, and that were traced to see.
    pub rays: u64,
    /// Those that met something else than the LIEs say.
    pub mismatches: Vec<Mismatch>,
}

/// A shadow ray that a cell answers wrongly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// Number of the light.
    pub light: u32,
    /// Where the ray leaves the surface: the cell around this place is wrong.
    pub point: Vec3,
    /// The ray, from either end.
    pub ray: Ray,
}

/// Keeps the choice of pixels apart from the frames' random numbers.
const CHOICE: u64 = 0x6175_6469_7400;

/// Pixels along a side of what is checked together: their rays to a light go in one packet.
const BLOCK: u32 = 4;

/// Traces the shadow rays of a share of a tile's pixels, in `[0, 1]`, to every light that
/// `lies` answer for there, and compares. Pixels come in blocks of 4 × 4. Which ones depends on
/// `seed`; their rays are those of the frame's first sample.
#[must_use]
pub fn audit(
    world: &World,
    lies: &dyn LieLookup,
    camera: &Camera,
    settings: &FrameSettings,
    tile: Tile,
    share: f32,
    seed: u64,
) -> Audit {
    let choice = RandomKey::new(seed).mix(CHOICE);
    let film = camera.film(settings.size);
    let mut check = Check {
        world,
        light_strata: strata(settings.light_samples),
        points: vec![],
        cells: vec![],
        rays: vec![],
        found: Audit::default(),
    };
    let blocks = tile.size.map(|side| side.div_ceil(BLOCK));
    for index in 0..blocks.x * blocks.y {
        let start = tile.origin + BLOCK * UVec2::new(index % blocks.x, index / blocks.x);
        let number = u64::from(start.x) | u64::from(start.y) << 32;
        if choice.mix(number).uniform(0) >= share {
            continue;
        }
        let size = (tile.origin + tile.size - start).min(UVec2::splat(BLOCK));
        check.points.clear();
        check.cells.clear();
        for place in 0..size.x * size.y {
            let pixel = start + UVec2::new(place % size.x, place / size.x);
            let (ray, key) = settings.camera_ray(&film, pixel, 0);
            let Some(surface) = world.first_surface(&ray) else {
                continue;
            };
            let cell = check.place_of(lies.cell(surface.shadow_origin));
            check.points.push(Point {
                brdf: Brdf::new(world.scene(), &surface),
                surface,
                key,
                cell,
            });
        }
        check.block();
    }
    check.found
}

/// What a pixel shows.
struct Point {
    surface: Surface,
    brdf: Brdf,
    key: RandomKey,
    /// Its cell's place among the block's.
    cell: usize,
}

/// An audit under way.
struct Check<'a> {
    world: &'a World,
    light_strata: (u32, u32),
    /// A block's.
    points: Vec<Point>,
    /// The cells that these lie in.
    cells: Vec<CellAnswers<'a>>,
    /// Rays that are to be traced, from where, and whether LIEs say that they get through.
    rays: Vec<(Mismatch, bool)>,
    found: Audit,
}

impl<'a> Check<'a> {
    /// Where a cell is among the block's, which it is added to.
    fn place_of(&mut self, cell: &'a LieCell) -> usize {
        let known = self.cells.iter().position(|known| known.is_of(cell));
        known.unwrap_or_else(|| {
            self.cells.push(CellAnswers::new(self.world, cell));
            self.cells.len() - 1
        })
    }

    /// Traces the rays from a block's points that their cells answer for, light by light.
    fn block(&mut self) {
        for light in 0..self.world.scene().lights.len() as u32 {
            for point in &self.points {
                let answers = &self.cells[point.cell];
                if answers.of(light) == LightAnswer::Traced {
                    continue;
                }
                let light_points = LightPoints {
                    surface: &point.surface,
                    brdf: &point.brdf,
                    key: point.key,
                    strata: self.light_strata,
                };
                let rays = &mut self.rays;
                answers.for_each_ray(light, &light_points, |ray, answer| {
                    if answer != RayAnswer::Traced {
                        let said = Mismatch {
                            light,
                            point: point.surface.shadow_origin,
                            ray: ray.ray,
                        };
                        rays.push((said, answer == RayAnswer::Shown));
                    }
                });
            }
            self.compare();
        }
    }

    /// Traces what has come together.
    fn compare(&mut self) {
        for chunk in self.rays.chunks(PACKET) {
            let mut rays = [chunk[0].0.ray; PACKET];
            for (place, (said, _)) in rays.iter_mut().zip(chunk) {
                *place = said.ray;
            }
            let packet = RayPacket::new(&rays[..chunk.len()]);
            let blocked = self.world.accel().blocked_packet(&packet);
            for (lane, (said, says_clear)) in chunk.iter().enumerate() {
                let is_clear = blocked >> lane & 1 == 0;
                if is_clear != *says_clear {
                    self.found.mismatches.push(*said);
                }
            }
        }
        self.found.rays += self.rays.len() as u64;
        self.rays.clear();
    }
}
