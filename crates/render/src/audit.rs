//! Holds what LIEs answer against true shadow rays, on a few of a frame's pixels.

use glam::{UVec2, Vec3};
use lie_geom::{RandomKey, Ray, sampling::strata};
use lie_scene::Camera;

use crate::{
    Brdf, FrameSettings, LieLookup, LightAnswer, LightPoints, Tile, World,
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

/// Traces the shadow rays of a share of a tile's pixels, in `[0, 1]`, to every light that
/// `lies` answer for there, and compares. Which pixels that are depends on `seed`; their rays
/// are those of the frame's first sample.
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
    let light_strata = strata(settings.light_samples);
    let mut found = Audit::default();
    let mut answers: Option<CellAnswers<'_>> = None;
    for index in 0..tile.size.x * tile.size.y {
        let pixel = tile.origin + UVec2::new(index % tile.size.x, index / tile.size.x);
        let number = u64::from(pixel.x) | u64::from(pixel.y) << 32;
        if choice.mix(number).uniform(0) >= share {
            continue;
        }
        let (ray, key) = settings.camera_ray(&film, pixel, 0);
        let Some(surface) = world.first_surface(&ray) else {
            continue;
        };
        let brdf = Brdf::new(world.scene(), &surface);
        let points = LightPoints {
            surface: &surface,
            brdf: &brdf,
            key,
            strata: light_strata,
        };
        let cell = lies.cell(surface.shadow_origin);
        let answers = answers.get_or_insert_with(|| CellAnswers::new(world, cell));
        answers.turn_to(cell);
        found.check(world, answers, &points);
    }
    found
}

impl Audit {
    /// Adds another one.
    pub fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.mismatches.extend(other.mismatches);
    }

    /// Traces the rays from one point that its cell answers for.
    fn check(&mut self, world: &World, answers: &CellAnswers<'_>, points: &LightPoints<'_>) {
        let point = points.surface.shadow_origin;
        for light in 0..world.scene().lights.len() as u32 {
            if answers.of(light) == LightAnswer::Traced {
                continue;
            }
            answers.for_each_ray(light, points, |ray, answer| {
                if answer == RayAnswer::Traced {
                    return;
                }
                self.rays += 1;
                let is_clear = world.accel().blocker(&ray.ray).is_none();
                if is_clear != (answer == RayAnswer::Shown) {
                    self.mismatches.push(Mismatch {
                        light,
                        point,
                        ray: ray.ray,
                    });
                }
            });
        }
    }
}
