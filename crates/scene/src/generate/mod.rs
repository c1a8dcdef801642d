//! Scenes made by rule: the same parameters give the same scene, on every machine, but for the last
//! digits of sines and powers.

mod bar;
mod bitmaps;
mod cornell;
mod frame;
mod gallery;
mod mesh;
mod mosque;
#[cfg(test)]
mod probes;
mod rooms;
mod science_center;
mod shapes;
mod sweep;

use crate::{Background, RenderSettings, Scene, draft::Draft};

pub(crate) use bar::draft as bar_draft;
pub(crate) use cornell::draft as cornell_draft;
pub(crate) use gallery::draft as gallery_draft;
pub(crate) use mosque::draft as mosque_draft;
pub use rooms::{Rooms, rooms};
pub(crate) use science_center::draft as science_center_draft;

/// Finest division of round things, relative to the usual.
pub(crate) const MAX_DETAIL: f32 = 4.0;

/// What [`gallery`] is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gallery {
    /// What the paintings and the grain of the materials start from.
    pub seed: u64,
    /// How finely round things are divided, in `(0, 4]`: 1 is the usual, and the number of
    /// triangles grows with the square.
    pub detail: f32,
}

impl Default for Gallery {
    fn default() -> Self {
        Self {
            seed: 1,
            detail: 1.0,
        }
    }
}

/// What [`bar`] is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// What the bottles, the posters and the places of the chairs start from.
    pub seed: u64,
    /// How finely round things are divided, in `(0, 4]`: 1 is the usual, and the number of
    /// triangles grows with the square.
    pub detail: f32,
}

impl Default for Bar {
    fn default() -> Self {
        Self {
            seed: 1,
            detail: 1.0,
        }
    }
}

/// What [`mosque`] is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mosque {
    /// Which marble and which capital each column gets, and the grain of the materials.
    pub seed: u64,
    /// How finely round and carved things are divided, in `(0, 6]` (a scene.toml takes 4): 1 is
    /// the usual, and there are about 0.49 d² + 0.31 d + 0.18 million triangles.
    pub detail: f32,
}

impl Mosque {
    /// Finest division: some 20 million triangles.
    const MAX_DETAIL: f32 = 6.0;
}

impl Default for Mosque {
    fn default() -> Self {
        Self {
            seed: 1,
            detail: 1.0,
        }
    }
}

/// What [`science_center`] is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScienceCenter {
    /// What posters, globe, panels, trees and the café's chairs start from.
    pub seed: u64,
    /// How finely the globe is divided, in `(0, 4]`: 1 is the usual.
    pub detail: f32,
}

impl Default for ScienceCenter {
    fn default() -> Self {
        Self {
            seed: 1,
            detail: 1.0,
        }
    }
}

/// The Cornell box: a closed room without its front, two blocks and one rectangle light.
///
/// # Panics
/// Never: the scene is valid whatever happens, and a test holds that.
#[must_use]
pub fn cornell_box() -> Scene {
    finish(cornell_draft(), "cornell", RenderSettings::default())
}

/// A small museum after closing time: an entrance hall with columns, a corridor with
/// niches, two picture galleries and a sculpture court, under some fifty lights.
///
/// # Panics
/// Never, for any parameters; a test holds that.
#[must_use]
pub fn gallery(parameters: &Gallery) -> Scene {
    let settings = RenderSettings {
        size: glam::UVec2::new(1280, 720),
        ..RenderSettings::default()
    };
    finish(gallery_draft(parameters), "gallery", settings)
}

/// A bar in the evening: bottles behind a long counter, tables under pendants, seventy spots
/// and a polished floor, after the Bar Carta Blanca of the paper (LIE §6).
///
/// # Panics
/// Never, for any parameters; a test holds that.
#[must_use]
pub fn bar(parameters: &Bar) -> Scene {
    let settings = RenderSettings {
        size: glam::UVec2::new(1280, 720),
        ..RenderSettings::default()
    };
    finish(bar_draft(parameters), "bar", settings)
}

/// A hall of columns after the mosque of Córdoba, under a hundred points of light: ten
/// bright ones along the nave and ninety dim ones in the other aisles.
///
/// # Panics
/// Never, for any parameters; a test holds that.
#[must_use]
pub fn mosque(parameters: &Mosque) -> Scene {
    let settings = RenderSettings {
        size: glam::UVec2::new(1280, 720),
        ..RenderSettings::default()
    };
    finish(mosque_draft(parameters), "mosque", settings)
}

/// The atrium of a science centre: stairs, balconies, exhibits, all matt, and one large area
/// light, a flat skylight.
///
/// # Panics
/// Never, for any parameters; a test holds that.
#[must_use]
pub fn science_center(parameters: &ScienceCenter) -> Scene {
    let settings = RenderSettings {
        size: glam::UVec2::new(1280, 720),
        light_samples: 64,
        ..RenderSettings::default()
    };
    finish(science_center_draft(parameters), "science-center", settings)
}

fn finish(draft: Draft, name: &str, settings: RenderSettings) -> Scene {
    match draft.finish(name.into(), Background::default(), settings) {
        Ok((scene, _)) => scene,
        Err(error) => unreachable!("a generated scene is valid: {error}"),
    }
}
