//! From where a scene is looked at, and how.

use clap::Args;
use glam::UVec2;
use lie_scene::{Camera, RenderSettings, Scene};

use crate::{
    args::{self, Accel},
    failure::Usage,
};

/// What a frame and one of its pixels have in common.
#[derive(Args)]
pub(crate) struct ViewOptions {
    /// What finds hits in the scene.
    #[arg(long, value_enum, default_value = "bvh")]
    pub(crate) accel: Accel,
    /// Named camera; the scene's first by default.
    #[arg(long, conflicts_with = "walk", value_name = "NAME")]
    camera: Option<String>,
    /// Look from a walkthrough instead, at the time given by `--at`.
    #[arg(long, value_name = "NAME")]
    walk: Option<String>,
    /// Seconds from the walkthrough's start.
    #[arg(long, requires = "walk", default_value_t = 0.0, value_name = "SECONDS")]
    at: f32,
    /// Sample points on each area light per camera ray; the scene's setting by default.
    #[arg(long, value_name = "N")]
    light_samples: Option<u32>,
    /// Size of the picture in pixels; the scene's setting by default.
    #[arg(long, value_parser = args::size, value_name = "WxH")]
    size: Option<UVec2>,
    /// Threads; 0 is one for each core.
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub(crate) threads: usize,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub(crate) seed: u64,
}

impl ViewOptions {
    /// The camera.
    pub(crate) fn camera(&self, scene: &Scene) -> Result<Camera, Usage> {
        match &self.walk {
            Some(name) => Ok(args::find_walkthrough(scene, Some(name))?.camera_at(self.at)),
            None => Ok(args::find_camera(scene, self.camera.as_deref())?.clone()),
        }
    }

    /// The scene's settings, with what the command line says; not yet validated.
    pub(crate) fn settings(&self, scene: &Scene) -> RenderSettings {
        let settings = scene.settings;
        RenderSettings {
            size: self.size.unwrap_or(settings.size),
            light_samples: self.light_samples.unwrap_or(settings.light_samples),
            ..settings
        }
    }
}
