//! Holds what LIEs answer against true shadow rays, on a few of a frame's pixels.

use glam::{UVec2, Vec3};
use lie_accel::RayPacket;
use lie_geom::{RandomKey, Ray, sampling::strata};
use lie_scene::Camera;

use crate::{
    Brdf, FrameSettings, LieCell, LieLookup, LightPoints, LightRay, Tile, World,
    occluder_lists::OpenLists,
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

/// What a cell says of a light's rays.
#[derive(Clone, Copy)]
enum Answer {
    Clear,
    /// By the list with this place among the open ones.
    Listed(usize),
    Blocked,
    /// Nothing: they are traced.
    Unknown,
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
    let mut open = OpenLists::default();
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
        open.open(&cell.partial, world.scene().geometry.shapes());
        found.check(world, cell, &open, &points);
    }
    found
}

impl Audit {
    /// Adds another one.
    pub fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.mismatches.extend(other.mismatches);
    }

    /// Traces the rays from one point. `open` are its cell's lists.
    fn check(&mut self, world: &World, cell: &LieCell, open: &OpenLists, points: &LightPoints<'_>) {
        for light in 0..world.scene().lights.len() as u32 {
            let answer = answer(cell, open, light);
            if matches!(answer, Answer::Unknown) {
                continue;
            }
            world.for_each_light_ray(light, points, |ray| {
                let says_clear = match answer {
                    // These are traced, but from cells that no light is said to reach.
                    Answer::Clear | Answer::Listed(_) if ray.exact => return,
                    Answer::Unknown => return,
                    Answer::Clear => true,
                    Answer::Blocked => false,
                    Answer::Listed(place) => {
                        let packet = RayPacket::new(&[ray.ray]);
                        open.blocked(&open.lights[place], &packet, world.cutout()) == 0
                    }
                };
                self.compare(world, points.surface.shadow_origin, &ray, says_clear);
            });
        }
    }

    fn compare(&mut self, world: &World, point: Vec3, ray: &LightRay, says_clear: bool) {
        self.rays += 1;
        let is_clear = world.accel().blocker(&ray.ray).is_none();
        if is_clear != says_clear {
            self.mismatches.push(Mismatch {
                light: ray.light,
                point,
                ray: ray.ray,
            });
        }
    }
}

fn answer(cell: &LieCell, open: &OpenLists, light: u32) -> Answer {
    if cell.traced.contains(light) {
        return Answer::Unknown;
    }
    if cell.unoccluded.contains(light) {
        return Answer::Clear;
    }
    match open.lights.binary_search_by_key(&light, |list| list.light) {
        Ok(place) => Answer::Listed(place),
        Err(_) => Answer::Blocked,
    }
}
