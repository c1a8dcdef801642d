use std::{path::PathBuf, sync::Arc, time::Duration};

use clap::Args;
use glam::UVec2;
use lie_bench::Stage;
use lie_scene::{Camera, Scene};

use crate::{
    args::{self, Accel},
    failure::usage,
};

/// What is looked at.
#[derive(Args)]
pub(crate) struct Subject {
    /// Scenes: .toml, .glb, .gltf or .obj, or folders with a scene.toml.
    #[arg(default_values = ["scenes/science-center", "scenes/bar", "scenes/mosque"], value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Named camera, in every scene; each scene's first by default.
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Size of the pictures in pixels; the paper's by default.
    #[arg(long, default_value = "512x512", value_parser = args::size, value_name = "WxH")]
    size: UVec2,
    /// What finds hits in the scenes.
    #[arg(long, value_enum, default_value = "bvh")]
    accel: Accel,
}

/// A scene that was loaded, and how to look at it.
#[derive(Clone)]
pub(crate) struct LoadedScene {
    path: String,
    scene: Arc<Scene>,
    camera: Camera,
    size: UVec2,
    accel: Accel,
}

impl Subject {
    /// Size of the pictures in pixels.
    pub(crate) fn size(&self) -> UVec2 {
        self.size
    }

    /// All scenes: what is wrong with the last is said before the first is measured.
    pub(crate) fn load(&self) -> anyhow::Result<Vec<LoadedScene>> {
        if let Some(missing) = self.scenes.iter().find(|path| !path.exists()) {
            let message = format!("{}: there is no such scene", missing.display());
            return Err(usage(message).into());
        }
        let mut loaded: Vec<LoadedScene> = vec![];
        for path in &self.scenes {
            let scene = args::load_scene(path)?;
            let path = path.display();
            let camera = args::find_camera(&scene, self.camera.as_deref())
                .map_err(|error| usage(format!("{path}: {error}")))?
                .clone();
            // Rows are told apart by their scenes' names.
            if loaded.iter().any(|other| other.scene.name == scene.name) {
                let message = format!("{path}: another scene is called '{}' too", scene.name);
                return Err(usage(message).into());
            }
            loaded.push(LoadedScene {
                path: path.to_string(),
                scene: Arc::new(scene),
                camera,
                size: self.size,
                accel: self.accel,
            });
        }
        Ok(loaded)
    }
}

impl LoadedScene {
    /// What it was loaded from.
    pub(crate) fn path(&self) -> &str {
        &self.path
    }

    /// The scene.
    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Another scene, looked at as this one.
    pub(crate) fn with_scene(&self, scene: Arc<Scene>) -> Self {
        Self {
            scene,
            ..self.clone()
        }
    }

    /// Ready to be measured.
    pub(crate) fn stage(self) -> Stage {
        let accel = self.accel.into();
        Stage::new(self.path, self.scene, self.camera, self.size, accel)
    }
}

/// Parses a number of seconds.
pub(crate) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds| *seconds > 0.0);
    let expected = "expected a number of seconds above 0, at most 1000000";
    let seconds = seconds.filter(|seconds: &f64| *seconds <= 1.0e6);
    seconds
        .map(Duration::from_secs_f64)
        .ok_or_else(|| expected.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_positive_and_finite() {
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        for wrong in ["", "0", "-1", "NaN", "inf", "1e7", "1s"] {
            assert!(seconds(wrong).is_err(), "{wrong}");
        }
    }
}
