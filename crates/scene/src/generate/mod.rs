//! Scenes made by rule: the same parameters give the same scene, on every machine.

mod bar;
mod bitmap;
mod cornell;
mod frame;
mod gallery;
mod mesh;
mod shapes;
mod sweep;

use crate::{Background, RenderSettings, Scene, draft::Draft};

pub(crate) use bar::draft as bar_draft;
pub(crate) use cornell::draft as cornell_draft;
pub(crate) use gallery::draft as gallery_draft;

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

fn finish(draft: Draft, name: &str, settings: RenderSettings) -> Scene {
    match draft.finish(name.into(), Background::default(), settings) {
        Ok((scene, _)) => scene,
        Err(error) => unreachable!("a generated scene is valid: {error}"),
    }
}
