//! A small scene with a light of every kind, and what was learnt of it.

use std::sync::Arc;

use glam::UVec2;
use lie_farm::{Builder, ConstructSettings, View, snapshot::scene_hash};
use lie_protocol::SceneHash;
use lie_render::World;
use lie_scene::Scene;

use crate::scenes;

/// The scene as processes have it.
pub(crate) struct Fixture {
    pub(crate) world: Arc<World>,
    pub(crate) hash: SceneHash,
}

impl Fixture {
    /// The scene that the first seed of scene files makes.
    pub(crate) fn new() -> Self {
        let scene = scenes::of_every_kind();
        let hash = scene_hash(&scene).unwrap();
        Self {
            world: Arc::new(World::new(Arc::new(scene))),
            hash,
        }
    }

    pub(crate) fn scene(&self) -> &Scene {
        self.world.scene()
    }

    /// What a constructor would start with.
    pub(crate) fn builder(&self) -> Builder {
        let mut settings = ConstructSettings::new(self.scene());
        settings.threads = 1;
        // Some is certain, some trusted and some in doubt after a few passes.
        settings.lie.trust = 32;
        settings.lie.split_samples = 16;
        settings.lie.max_depth = 5;
        Builder::new(self.world.clone(), settings).unwrap()
    }

    /// What a constructor has after some passes.
    pub(crate) fn learnt(&self) -> Builder {
        let mut builder = self.builder();
        let size = UVec2::new(24, 16);
        let camera = self.scene().cameras[0].clone();
        let passes = 3 * u64::from(size.element_product());
        builder.sample(&[View { camera, size }], passes, |_| {});
        builder
    }
}
