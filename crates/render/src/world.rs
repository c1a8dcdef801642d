use std::sync::Arc;

use lie_accel::{Accel, AccelKind, Cutout};
use lie_geom::{Ray, Triangle};
use lie_scene::{Scene, Surface};

/// A scene that rays can be shot into.
pub struct World {
    scene: Arc<Scene>,
    accel: Box<dyn Accel>,
    triangles: Vec<Triangle>,
    reach: f32,
}

impl World {
    /// Builds the usual acceleration structure, in parallel.
    #[must_use]
    pub fn new(scene: Arc<Scene>) -> Self {
        Self::with_accel(scene, AccelKind::default())
    }

    /// Builds an acceleration structure of some kind, in parallel.
    #[must_use]
    pub fn with_accel(scene: Arc<Scene>, kind: AccelKind) -> Self {
        let cutout: Option<Arc<dyn Cutout>> = if scene.materials.iter().any(|m| m.is_masked()) {
            Some(scene.clone())
        } else {
            None
        };
        let accel = kind.build(&scene.geometry, cutout);
        let triangles = (0..scene.geometry.len() as u32)
            .map(|triangle| scene.geometry.triangle(triangle))
            .collect();
        Self {
            reach: scene.reach(),
            scene,
            accel,
            triangles,
        }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The structure that serves every ray.
    #[must_use]
    pub fn accel(&self) -> &dyn Accel {
        &*self.accel
    }

    /// A distance in metres that leaves the scene from anywhere in it.
    #[must_use]
    pub fn reach(&self) -> f32 {
        self.reach
    }

    /// The closest surface along a ray.
    #[must_use]
    pub fn first_surface(&self, ray: &Ray) -> Option<Surface> {
        self.accel
            .closest(ray)
            .map(|hit| self.scene.surface(ray, &hit))
    }

    /// Whether one triangle blocks a ray, holes considered.
    #[must_use]
    pub fn blocks(&self, triangle: u32, ray: &Ray) -> bool {
        self.triangles
            .get(triangle as usize)
            .and_then(|shape| shape.intersect(ray))
            .is_some_and(|hit| self.scene.is_solid(triangle, hit.u, hit.v))
    }
}
