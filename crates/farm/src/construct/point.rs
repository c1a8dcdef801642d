use lie_geom::RandomKey;
use lie_render::{Brdf, LightPoints, World};
use lie_scene::Surface;

use super::{pass_rays::PassRays, place::Place};

/// A pixel's surface point.
pub(super) struct Point {
    pub(super) surface: Surface,
    pub(super) brdf: Brdf,
    pub(super) key: RandomKey,
}

impl Point {
    /// The point at a place of a view.
    pub(super) fn new(world: &World, rays: PassRays<'_>, place: &Place) -> Self {
        let (ray, key) = rays.camera_ray(place.pixel);
        let surface = world.scene().surface(&ray, &place.hit);
        Self {
            brdf: Brdf::new(world.scene(), &surface),
            surface,
            key,
        }
    }

    pub(super) fn light_points(&self, strata: (u32, u32)) -> LightPoints<'_> {
        LightPoints {
            surface: &self.surface,
            brdf: &self.brdf,
            key: self.key,
            strata,
        }
    }
}
