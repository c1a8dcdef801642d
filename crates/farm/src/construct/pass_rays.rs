use glam::{UVec2, Vec2};
use lie_geom::{RandomKey, Ray};
use lie_scene::Camera;

/// The camera rays of one pass over a view, one for each pixel.
#[derive(Clone, Copy)]
pub(super) struct PassRays<'a> {
    pub(super) camera: &'a Camera,
    /// Columns and rows of the picture.
    pub(super) size: UVec2,
    /// What the view's random numbers depend on.
    pub(super) key: RandomKey,
    /// Passes before it.
    pub(super) pass: u64,
}

impl PassRays<'_> {
    /// The camera ray of a pixel, and the key of its random numbers. The first pass
    /// and every other go through the pixels' centres, where a frame with one sample per pixel
    /// looks: what only a single pixel shows is found as well. The passes between go through
    /// random places.
    pub(super) fn camera_ray(&self, pixel: UVec2) -> (Ray, RandomKey) {
        let key = self
            .key
            .mix(self.pass)
            .mix(u64::from(pixel.x) | u64::from(pixel.y) << 32);
        let offset = if self.goes_through_centres() {
            Vec2::splat(0.5)
        } else {
            key.uniform2(0)
        };
        let film = pixel.as_vec2() + offset;
        (self.camera.ray(film, self.size), key.mix(1))
    }

    /// Whether the pass looks where a frame with one sample per pixel does.
    pub(super) fn goes_through_centres(&self) -> bool {
        self.pass.is_multiple_of(2)
    }
}
