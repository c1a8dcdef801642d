//! What a frame's pixels show and take, beside their light: arbitrary output variables.

mod count;
mod exr_file;
mod work;

use std::sync::Mutex;

use glam::{UVec2, Vec3};
use lie_geom::sampling::strata;
use lie_scene::{Camera, CameraFilm, Surface};
use rayon::prelude::*;

pub use self::{
    exr_file::write_aovs,
    work::{CostModel, Work},
};
use crate::{
    Brdf, ExpectedError, FrameSettings, LieCell, LieLookup, LightPoints, RayOdds, World,
    cell_answers::CellAnswers,
};

/// A frame's arbitrary output variables, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Aovs {
    size: UVec2,
    pixels: Vec<AovPixel>,
}

/// What is known of one pixel.
///
/// `work` is the sum over the pixel's camera rays; everything else is the mean over those
/// that met a surface, and zero if none did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AovPixel {
    /// What its light takes.
    pub work: Work,
    /// Shading normal in world space, on the side of the eye; unit length on flat surfaces.
    pub normal: Vec3,
    /// Share of light that is reflected at normal incidence: the diffuse part and the
    /// specular together, in `[0, 1]` per channel.
    pub albedo: Vec3,
    /// The cell around what is seen; `None` for a frame without LIEs.
    pub cell: Option<CellAov>,
}

/// What a pixel's cell knows, as means over the pixel's camera rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellAov {
    /// Lights that are evaluated without a ray.
    pub unoccluded: f32,
    /// Lights whose rays are tested against an occluder list.
    pub partial: f32,
    /// Lights whose rays go through the scene.
    pub traced: f32,
    /// Lights that others outshine: left out (LIE §5).
    pub masked: f32,
    /// Lights that do not reach the cell.
    pub hidden: f32,
    /// Levels below the root of the octree.
    pub depth: f32,
    /// Samples that the cell's LIE rests on.
    pub samples: f32,
    /// Root mean square of the error to be expected, as luminance, if anybody asked: the mean
    /// over all of the pixel's camera rays, as if all were wrong together.
    pub expected_error: f32,
}

/// What a shader does not know of a cell and its constructor does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellFacts {
    /// Levels below the root.
    pub depth: u32,
    /// Samples taken in it.
    pub samples: u32,
    /// Lights that are masked there.
    pub masked: u32,
}

/// LIEs, and what is known of them beside.
#[derive(Clone, Copy)]
pub struct AovLies<'a> {
    /// As a frame asks them.
    pub lookup: &'a dyn LieLookup,
    /// The smallest cell around a place where shadow rays start.
    pub facts: &'a (dyn Fn(Vec3) -> CellFacts + Sync),
    /// What may be wrong; `None` if nobody wants to know what error is to be expected.
    pub odds: Option<&'a OddsOf<'a>>,
}

/// Adds how likely it is, for every light, that shadow rays from a place are answered wrongly.
pub type OddsOf<'a> = dyn Fn(Vec3, &mut Vec<RayOdds>) + Sync + 'a;

impl Aovs {
    /// Shoots a frame's camera rays once more, on rayon's current threads, and counts what
    /// [`crate::render_frame`] does for each pixel. `progress` is told the share done, in
    /// `[0, 1]`, after every row.
    #[must_use]
    pub fn render(
        world: &World,
        lies: Option<AovLies<'_>>,
        camera: &Camera,
        settings: &FrameSettings,
        progress: &mut (dyn FnMut(f32) + Send),
    ) -> Self {
        let progress = Mutex::new((0u32, progress));
        let pass = Pass {
            world,
            lies,
            film: camera.film(settings.size),
            settings,
            light_strata: strata(settings.light_samples),
        };
        let rows: Vec<Vec<AovPixel>> = (0..settings.size.y)
            .into_par_iter()
            .map(|y| {
                // Neighbours mostly share a cell.
                let mut doubts = Doubts::default();
                let row = (0..settings.size.x).map(|x| pass.pixel(UVec2::new(x, y), &mut doubts));
                let row = row.collect();
                if let Ok(mut progress) = progress.lock() {
                    progress.0 += 1;
                    let share = progress.0 as f32 / settings.size.y as f32;
                    (progress.1)(share);
                }
                row
            })
            .collect();
        Self {
            size: settings.size,
            pixels: rows.into_iter().flatten().collect(),
        }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The pixels, row by row.
    #[must_use]
    pub fn pixels(&self) -> &[AovPixel] {
        &self.pixels
    }

    /// Root mean square of the error to be expected of the whole picture, as luminance; 0
    /// without LIEs, or if nobody asked.
    #[must_use]
    pub fn expected_rmse(&self) -> f64 {
        let square = |pixel: &AovPixel| {
            let error = pixel.cell.map_or(0.0, |cell| cell.expected_error);
            f64::from(error) * f64::from(error)
        };
        let sum: f64 = self.pixels.iter().map(square).sum();
        (sum / self.pixels.len().max(1) as f64).sqrt()
    }

    /// The work of all pixels.
    #[must_use]
    pub fn total(&self) -> Work {
        let mut total = Work::default();
        for pixel in &self.pixels {
            total += pixel.work;
        }
        total
    }
}

/// What all pixels share.
struct Pass<'a> {
    world: &'a World,
    lies: Option<AovLies<'a>>,
    film: CameraFilm,
    settings: &'a FrameSettings,
    light_strata: (u32, u32),
}

/// What a pixel's cell answers, and what the error to be expected is worked out in.
#[derive(Default)]
struct Doubts<'a> {
    answers: Option<CellAnswers<'a>>,
    odds: Vec<RayOdds>,
}

impl<'a> Pass<'a> {
    fn pixel(&self, pixel: UVec2, doubts: &mut Doubts<'a>) -> AovPixel {
        let mut sum = AovPixel {
            cell: self.lies.map(|_| CellAov::default()),
            ..AovPixel::default()
        };
        let mut hits = 0;
        for sample in 0..self.settings.samples_per_pixel {
            let (ray, key) = self.settings.camera_ray(&self.film, pixel, sample);
            sum.work.primary_rays += 1;
            let Some(surface) = self.world.first_surface(&ray) else {
                continue;
            };
            hits += 1;
            let brdf = Brdf::new(self.world.scene(), &surface);
            let cell = self
                .lies
                .map(|lies| lies.lookup.cell(surface.shadow_origin));
            let points = LightPoints {
                surface: &surface,
                brdf: &brdf,
                key,
                strata: self.light_strata,
            };
            if let Some(cell) = cell {
                let new = || CellAnswers::new(self.world, cell);
                doubts.answers.get_or_insert_with(new).turn_to(cell);
            }
            let answers = doubts.answers.as_ref();
            count::count_point(self.world, self.settings, answers, &points, &mut sum.work);
            sum.normal += surface.shading_normal;
            sum.albedo += albedo(&brdf);
            if let (Some(total), Some(cell)) = (&mut sum.cell, cell) {
                total.add(&self.cell_aov(cell, &surface));
                total.expected_error += self.expected_error(&points, doubts);
            }
        }
        sum.mean(hits, self.settings.samples_per_pixel)
    }

    /// Root mean square of the error to be expected at a point, as luminance.
    fn expected_error(&self, points: &LightPoints<'_>, doubts: &mut Doubts<'_>) -> f32 {
        let odds = self.lies.and_then(|lies| lies.odds);
        let (Some(odds), Some(answers)) = (odds, &doubts.answers) else {
            return 0.0;
        };
        doubts.odds.clear();
        odds(points.surface.shadow_origin, &mut doubts.odds);
        ExpectedError::of_point(self.world, answers, points, &doubts.odds).rms() as f32
    }

    fn cell_aov(&self, cell: &LieCell, surface: &Surface) -> CellAov {
        let facts = self
            .lies
            .map(|lies| (lies.facts)(surface.shadow_origin))
            .unwrap_or_default();
        let lights = self.world.scene().lights.len();
        let masked = facts.masked as usize;
        let seen = cell.answered() + cell.traced.len() + masked;
        CellAov {
            unoccluded: cell.unoccluded.len() as f32,
            partial: cell.partial.len() as f32,
            traced: cell.traced.len() as f32,
            masked: masked as f32,
            hidden: lights.saturating_sub(seen) as f32,
            depth: facts.depth as f32,
            samples: facts.samples as f32,
            expected_error: 0.0,
        }
    }
}

/// Reflectance at normal incidence: what is not reflected by the surface is by what lies
/// under it.
fn albedo(brdf: &Brdf) -> Vec3 {
    let diffuse = brdf.diffuse * std::f32::consts::PI;
    (diffuse * (Vec3::ONE - brdf.f0) + brdf.f0).clamp(Vec3::ZERO, Vec3::ONE)
}

impl AovPixel {
    /// From sums over some hits, of so many camera rays.
    fn mean(mut self, hits: u32, rays: u32) -> Self {
        let share = 1.0 / hits.max(1) as f32;
        self.normal *= share;
        self.albedo *= share;
        if let Some(cell) = &mut self.cell {
            let expected_error = cell.expected_error / rays.max(1) as f32;
            for value in cell.values_mut() {
                *value *= share;
            }
            cell.expected_error = expected_error;
        }
        self
    }
}

impl CellAov {
    fn add(&mut self, other: &Self) {
        let mut other = *other;
        for (sum, value) in self.values_mut().into_iter().zip(other.values_mut()) {
            *sum += *value;
        }
    }

    fn values_mut(&mut self) -> [&mut f32; 8] {
        [
            &mut self.unoccluded,
            &mut self.partial,
            &mut self.traced,
            &mut self.masked,
            &mut self.hidden,
            &mut self.depth,
            &mut self.samples,
            &mut self.expected_error,
        ]
    }
}

#[cfg(test)]
mod tests;
