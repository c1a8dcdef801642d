use std::sync::Arc;

use glam::Vec3;
use lie_accel::Shaft;
use lie_geom::Aabb;
use lie_octree::Between;
use lie_render::World;
use lie_scene::{Light, LightKind};

/// The shafts between a scene's lights and boxes. Only points and spots have one.
pub(super) struct Shafts {
    world: Arc<World>,
    /// Box around the scene.
    bounds: Aabb,
    /// For each light its place, if it has no extent.
    places: Vec<Option<Vec3>>,
}

impl Shafts {
    /// Those of a world.
    pub(super) fn new(world: Arc<World>) -> Self {
        let place = |light: &Light| match light.kind {
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => Some(position),
            LightKind::Directional { .. } | LightKind::Area(_) => None,
        };
        let scene = world.scene();
        Self {
            bounds: scene.geometry.bounds(),
            places: scene.lights.iter().map(place).collect(),
            world,
        }
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.places.iter().all(Option::is_none)
    }

    /// A light's place, if it has no extent.
    pub(super) fn place(&self, light: u32) -> Option<Vec3> {
        self.places[light as usize]
    }

    /// All segments from a light's place to a box.
    pub(super) fn from(&self, place: Vec3, ends: Aabb) -> Shaft {
        Shaft::new(place, ends, self.bounds)
    }
}

impl Between for Shafts {
    fn between(&self, light: u32, ends: Aabb) -> impl Fn(u32) -> bool {
        let shaft = self.place(light).map(|place| self.from(place, ends));
        let shapes = self.world.scene().geometry.shapes();
        move |triangle| shaft.is_none_or(|shaft| shaft.may_hit(&shapes[triangle as usize]))
    }
}
