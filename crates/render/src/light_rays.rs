use glam::{Vec2, Vec3};
use lie_geom::{RandomKey, Ray, sampling::stratified};
use lie_scene::{Light, Surface};

use crate::{Brdf, World, luminance};

/// A shadow ray to be traced, with what it carries if nothing blocks it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightRay {
    /// Number of the light.
    pub light: u32,
    /// From the surface to a point on the light.
    pub ray: Ray,
    /// Reflected radiance towards the eye, in W·sr⁻¹·m⁻².
    pub radiance: Vec3,
}

impl World {
    /// What one sample point of a light would add at a surface; `None` where that is
    /// nothing, whatever the visibility: behind the surface, out of the cone, black.
    #[inline]
    pub(crate) fn light_ray(
        &self,
        index: u32,
        light: &Light,
        surface: &Surface,
        brdf: &Brdf,
        square: Vec2,
    ) -> Option<LightRay> {
        let sample = light.sample(surface.position, square, self.reach())?;
        let radiance = brdf.times_cosine(sample.wi) * sample.normal_irradiance;
        // Not `> 0` on each: a light of one colour on a surface of another gives nothing.
        let lit = radiance.max_element() > 0.0 && radiance.is_finite();
        lit.then(|| LightRay {
            light: index,
            ray: Ray::segment(surface.shadow_origin, sample.target),
            radiance,
        })
    }

    /// One ray to a random point on every light that could light the surface: a
    /// construction sample (LIE §4.1). Each ray's `radiance` is the light's whole.
    pub fn light_rays(&self, surface: &Surface, key: RandomKey, rays: &mut Vec<LightRay>) {
        let brdf = Brdf::new(self.scene(), surface);
        rays.clear();
        for (index, light) in (0u32..).zip(&self.scene().lights) {
            let square = key.mix(u64::from(index)).uniform2(0);
            rays.extend(self.light_ray(index, light, surface, &brdf, square));
        }
    }
}

impl LightRay {
    /// Luminance of what it carries.
    #[must_use]
    pub fn weight(&self) -> f32 {
        luminance(self.radiance)
    }
}

/// The sample points on a light for one camera ray: stratified over the light for an area
/// light, a single one for others. `key` is the camera ray's.
#[inline]
pub(crate) fn light_squares(
    key: RandomKey,
    index: u32,
    light: &Light,
    strata: (u32, u32),
) -> impl Iterator<Item = Vec2> + use<> {
    let key = key.mix(u64::from(index));
    let count = if light.is_delta() {
        1
    } else {
        strata.0 * strata.1
    };
    (0..count).map(move |sample| stratified(strata, sample, key.uniform2(sample)))
}
