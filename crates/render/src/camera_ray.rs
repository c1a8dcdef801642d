use glam::{UVec2, Vec2};
use lie_geom::{
    RandomKey, Ray,
    sampling::{strata, stratified},
};
use lie_scene::CameraFilm;

use crate::FrameSettings;

impl FrameSettings {
    /// The ray of a pixel's sample and the key of its random numbers.
    pub(crate) fn camera_ray(
        &self,
        film: &CameraFilm,
        pixel: UVec2,
        sample: u32,
    ) -> (Ray, RandomKey) {
        let (place, key) = self.film_place(pixel, sample);
        (film.ray(place), key)
    }

    /// The place on the film that a pixel's sample goes through, and the key of its random numbers.
    pub(crate) fn film_place(&self, pixel: UVec2, sample: u32) -> (Vec2, RandomKey) {
        let key = RandomKey::new(self.seed)
            .mix(u64::from(pixel.x) | u64::from(pixel.y) << 32)
            .mix(u64::from(sample));
        let count = self.samples_per_pixel;
        let offset = if count == 1 {
            Vec2::splat(0.5)
        } else {
            stratified(strata(count), sample, key.uniform2(0))
        };
        (pixel.as_vec2() + offset, key.mix(1))
    }
}
