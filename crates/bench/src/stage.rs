use std::{sync::Arc, time::Instant};

use glam::UVec2;
use lie_farm::View;
use lie_render::{AccelKind, FrameSettings, ToneMap, World};
use lie_scene::{Camera, Scene};

use crate::race::milliseconds;

/// A view of a scene, ready to be measured.
#[derive(Clone)]
pub struct Stage {
    path: String,
    scene: Arc<Scene>,
    world: Arc<World>,
    camera: Camera,
    settings: FrameSettings,
    accel: AccelKind,
    build_ms: f64,
}

impl Stage {
    /// Builds the scene's acceleration structure. `path` is what the scene was loaded from;
    /// all settings but the size are the scene's.
    #[must_use]
    pub fn new(
        path: impl Into<String>,
        scene: Arc<Scene>,
        camera: Camera,
        size: UVec2,
        accel: AccelKind,
    ) -> Self {
        let settings = FrameSettings {
            size,
            ..FrameSettings::new(&scene.settings)
        };
        let clock = Instant::now();
        let world = Arc::new(World::with_accel(scene.clone(), accel));
        Self {
            path: path.into(),
            scene,
            world,
            camera,
            settings,
            accel,
            build_ms: milliseconds(clock.elapsed()),
        }
    }

    /// The same scene from somewhere else.
    #[must_use]
    pub fn seen_from(&self, camera: Camera) -> Self {
        Self {
            camera,
            ..self.clone()
        }
    }

    /// The same, in pixels an eighth as many on each side: enough to warm a machine up.
    pub(crate) fn thumbnail(&self) -> Self {
        let size = (self.settings.size / 8).max(UVec2::ONE);
        Self {
            settings: FrameSettings {
                size,
                ..self.settings
            },
            ..self.clone()
        }
    }

    /// The scene's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.world.scene().name
    }

    /// What the scene was loaded from.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The scene.
    pub(crate) fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The scene with its acceleration structure.
    #[must_use]
    pub fn world(&self) -> &Arc<World> {
        &self.world
    }

    /// From where.
    #[must_use]
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Everything else that decides about its pixels.
    #[must_use]
    pub fn settings(&self) -> &FrameSettings {
        &self.settings
    }

    /// What finds hits in it.
    #[must_use]
    pub fn accel(&self) -> AccelKind {
        self.accel
    }

    /// Time in which that was built, once, on all threads at hand, in milliseconds.
    #[must_use]
    pub fn build_ms(&self) -> f64 {
        self.build_ms
    }

    /// How its pictures are shown.
    #[must_use]
    pub fn tone_map(&self) -> ToneMap {
        ToneMap {
            exposure_stops: self.exposure_stops(),
            curve: lie_render::ToneCurve::Aces,
        }
    }

    /// The exposure at which its pictures are compared.
    pub(crate) fn exposure_stops(&self) -> f32 {
        self.world.scene().settings.exposure_stops
    }

    /// What construction samples for it.
    pub(crate) fn view(&self) -> View {
        View {
            camera: self.camera.clone(),
            size: self.settings.size,
        }
    }

    /// How many pixels: one pass of construction.
    #[must_use]
    pub fn pixels(&self) -> u64 {
        u64::from(self.settings.size.x) * u64::from(self.settings.size.y)
    }
}
