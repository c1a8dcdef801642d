use glam::{Vec2, Vec3};
use lie_geom::{
    RandomKey, Ray,
    sampling::{self, stratified},
};
use lie_scene::{Light, LightKind, LightPoint, Surface};

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
    /// Calls `found` with the shadow rays to one light for one camera ray; their radiances
    /// add up to the light's whole. A light without extent gets one ray, an area light
    /// `strata` of them, stratified over its area. On smooth surfaces half of them follow
    /// the specular lobe instead, weighed by the balance heuristic (Veach and Guibas
    /// 1995). Rays that carry nothing, whatever the visibility, are left out: from behind
    /// the surface, out of the cone, black.
    ///
    /// `key` is the camera ray's.
    #[inline]
    pub(crate) fn for_each_light_ray(
        &self,
        (index, light): (u32, &Light),
        surface: &Surface,
        brdf: &Brdf,
        (key, strata): (RandomKey, (u32, u32)),
        mut found: impl FnMut(LightRay),
    ) {
        let key = key.mix(u64::from(index));
        let LightKind::Area(area) = &light.kind else {
            if let Some(sample) = light.sample(surface.position, Vec2::ZERO, self.reach()) {
                let radiance = brdf.times_cosine(sample.wi) * sample.normal_irradiance;
                emit(index, surface, sample.target, radiance, &mut found);
            }
            return;
        };
        let count = strata.0 * strata.1;
        let follow_lobe = brdf.is_smooth() && area.triangles().len() <= MAX_LOBE_TRIANGLES;
        let by_lobe = if follow_lobe { count / 2 } else { 0 };
        let by_area = count - by_lobe;
        let mut add = |point: LightPoint| {
            let Some((target, wi, area_density)) = point.seen_from(surface.position, area) else {
                return;
            };
            let lobe_density = if follow_lobe {
                brdf.specular_density(wi)
            } else {
                0.0
            };
            let density = by_area as f32 * area_density + by_lobe as f32 * lobe_density;
            emit(
                index,
                surface,
                target,
                brdf.times_cosine(wi) * area.radiance / density,
                &mut found,
            );
        };
        let area_strata = sampling::strata(by_area);
        for sample in 0..by_area {
            area.point(stratified(area_strata, sample, key.uniform2(sample)))
                .map(&mut add);
        }
        let lobe_strata = sampling::strata(by_lobe);
        for sample in 0..by_lobe {
            let square = stratified(lobe_strata, sample, key.uniform2(by_area + sample));
            let ray = Ray::new(surface.position, brdf.sample_specular(square));
            area.points_along(&ray, &mut add);
        }
    }

    /// One ray to a random point on every light that could light the surface: a
    /// construction sample (LIE §4.1). Each ray's `radiance` is an estimate of the light's
    /// whole.
    ///
    /// Of several points on an area light the one is taken, by chance, that gives most
    /// (Talbot et al. 2005, *Importance Resampling for Global Illumination*): next to a
    /// lamp, or in a reflection, nearly all light comes from a small part of it, and an
    /// occluder that is missed there is the one that is seen.
    pub fn light_rays(&self, surface: &Surface, key: RandomKey, rays: &mut Vec<LightRay>) {
        let brdf = Brdf::new(self.scene(), surface);
        rays.clear();
        for (index, light) in (0u32..).zip(&self.scene().lights) {
            let mut resampled = Resampled::new(key.mix(u64::from(index)).uniform(u32::MAX));
            self.for_each_light_ray((index, light), surface, &brdf, (key, CANDIDATES), |ray| {
                resampled.add(ray)
            });
            rays.extend(resampled.finish());
        }
    }
}

/// Follow the lobe only to lights of at most so many triangles: each is tested.
const MAX_LOBE_TRIANGLES: usize = 64;

#[inline]
fn emit(
    light: u32,
    surface: &Surface,
    target: Vec3,
    radiance: Vec3,
    found: &mut impl FnMut(LightRay),
) {
    // Not `> 0` on each: a light of one colour on a surface of another gives nothing.
    if radiance.max_element() > 0.0 && radiance.is_finite() {
        let ray = Ray::segment(surface.shadow_origin, target);
        found(LightRay {
            light,
            ray,
            radiance,
        });
    }
}

/// Points on an area light of which a construction sample takes one, as strata.
const CANDIDATES: (u32, u32) = (4, 2);

/// One of many rays to a light, chosen with a chance in proportion to its weight as they
/// come by (reservoir sampling).
struct Resampled {
    random: f32,
    total: f32,
    chosen: Option<LightRay>,
}

impl Resampled {
    fn new(random: f32) -> Self {
        Self {
            random,
            total: 0.0,
            chosen: None,
        }
    }

    fn add(&mut self, ray: LightRay) {
        let weight = ray.weight();
        self.total += weight;
        let chance = weight / self.total;
        // One random number serves all: what a decision leaves of it is uniform again.
        if self.random < chance {
            self.random /= chance;
            self.chosen = Some(ray);
        } else {
            self.random = (self.random - chance) / (1.0 - chance);
        }
    }

    /// The chosen ray, carrying what all of them did.
    fn finish(self) -> Option<LightRay> {
        self.chosen.map(|ray| LightRay {
            radiance: ray.radiance * (self.total / ray.weight()),
            ..ray
        })
    }
}

impl LightRay {
    /// Luminance of what it carries.
    #[must_use]
    pub fn weight(&self) -> f32 {
        luminance(self.radiance)
    }
}
