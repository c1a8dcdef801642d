use glam::{Vec2, Vec3};
use lie_geom::{
    RandomKey, Ray,
    sampling::{self, stratified},
};
use lie_scene::{AreaLight, Light, LightKind, LightPoint, Surface};

use crate::{
    Brdf, World,
    closed_form::{LEAST, NEAR, Outlines},
    light_form::{AreaForm, LightForm},
    luminance,
};

/// A shadow ray to be traced, with what it carries if nothing blocks it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightRay {
    /// Number of the light.
    pub light: u32,
    /// Between the surface and a point on the light. Rays to a light without extent, but in
    /// a place, start there ([`Ray::segment_from`]), all others at the surface.
    pub ray: Ray,
    /// Reflected radiance towards the eye, in W·sr⁻¹·m⁻².
    pub radiance: Vec3,
    /// Whether it is traced through the scene even where the light is trusted to reach the
    /// cell, since it carries more than what is known of a whole cell can answer for: it goes where a smooth surface reflects to, or
    /// to a part of an area light that is so near that it fills much of the view.
    pub exact: bool,
    /// Whether the ray starts at the light.
    pub from_light: bool,
}

/// Everything that a light's rays at one surface point depend on.
#[derive(Clone, Copy)]
pub struct LightPoints<'a> {
    /// Where the rays start.
    pub surface: &'a Surface,
    /// How it reflects.
    pub brdf: &'a Brdf,
    /// The camera ray's key.
    pub key: RandomKey,
    /// Sample points on an area light, as columns and rows.
    pub strata: (u32, u32),
}

impl LightPoints<'_> {
    /// Of an area light's samples, how many are spread over its area and how many follow
    /// the surface's specular lobe: half each on smooth surfaces.
    fn split(&self, light: &AreaLight) -> (u32, u32) {
        let count = self.strata.0 * self.strata.1;
        let follow = self.brdf.is_smooth() && is_simple(light);
        let by_lobe = if follow { count / 2 } else { 0 };
        (count - by_lobe, by_lobe)
    }

    /// What finding a light's rays takes: sample points on it that [`World::for_each_light_ray`]
    /// evaluates, and edges where it is integrated in closed form. No sample points if all of
    /// it is `known` to be clear, and this surface wants nothing but the closed form.
    pub(crate) fn evaluations(&self, world: &World, light: u32, known: bool) -> u64 {
        match world.light_form(light) {
            LightForm::Area(AreaForm {
                light, outlines, ..
            }) => {
                let samples = u64::from(self.split(light).0);
                let Some(outlines) = outlines else {
                    return samples;
                };
                let spared = known && self.needs_no_samples(light, outlines)
                    || self.irradiance(outlines) == 0.0;
                outlines.edges() as u64 + if spared { 0 } else { samples }
            }
            LightForm::Delta(_) => 1,
            LightForm::Other => u64::from(world.scene().lights.len() > light as usize),
        }
    }

    /// Whether the closed form is all there is to a light if nothing is in the way: the surface
    /// reflects by Lambert's law alone, and no ray would be exact.
    pub(crate) fn needs_no_samples(&self, light: &AreaLight, outlines: &Outlines) -> bool {
        self.brdf.is_matt() && outlines.is_far(self.surface.position, self.split(light).0)
    }

    fn irradiance(&self, outlines: &Outlines) -> f32 {
        let Brdf {
            normal,
            geometric_normal,
            ..
        } = *self.brdf;
        outlines.irradiance(self.surface.position, normal, geometric_normal)
    }

    /// What comes from a point of an area light. The specular lobe is weighed by the balance
    /// heuristic over both kinds of samples (Veach and Guibas 1995); the diffuse one has those
    /// over the area to itself.
    #[inline]
    fn sample_at(&self, light: &AreaLight, point: LightPoint) -> Option<AreaSample> {
        let (target, wi, area_density) = point.seen_from(self.surface.position, light)?;
        let cosine = self.brdf.cosine(wi)?;
        let (by_area, by_lobe) = self.split(light);
        let lobe_density = if by_lobe > 0 {
            self.brdf.specular_density(wi)
        } else {
            0.0
        };
        let (area_share, lobe_share) =
            (by_area as f32 * area_density, by_lobe as f32 * lobe_density);
        let parts = self.brdf.parts(wi, cosine);
        let sample = AreaSample {
            target,
            weight: cosine / area_share,
            diffuse: parts.diffuse * light.radiance,
            specular: parts.specular * cosine * light.radiance / (area_share + lobe_share),
            exact: lobe_share > area_share || area_share * NEAR < 1.0,
        };
        (sample.weight.is_finite() && sample.specular.is_finite()).then_some(sample)
    }

    /// The ray to a point of an area light, as a sample over its area.
    fn ray_to(&self, index: u32, light: &AreaLight, point: LightPoint) -> Option<LightRay> {
        let sample = self.sample_at(light, point)?;
        self.sample_ray(index, &sample, 1.0)
    }

    fn sample_ray(&self, index: u32, sample: &AreaSample, factor: f32) -> Option<LightRay> {
        let radiance = sample.diffuse * (sample.weight * factor) + sample.specular;
        let ray = LightRay::new(index, self.surface, sample.target, radiance)?;
        Some(LightRay {
            exact: sample.exact,
            ..ray
        })
    }

    /// One ray for all of a light that no sample has found above the horizon.
    #[cold]
    fn only_ray(&self, index: u32, form: AreaForm<'_>, irradiance: f32) -> Option<LightRay> {
        let (position, brdf) = (self.surface.position, self.brdf);
        let AreaForm {
            light, outlines, ..
        } = form;
        let point = Outlines::some_point(light, position, brdf.normal, brdf.geometric_normal)?;
        let (target, wi, _) = point.seen_from(position, light)?;
        let parts = brdf.parts(wi, brdf.cosine(wi)?);
        let sample = AreaSample {
            target,
            weight: irradiance,
            diffuse: parts.diffuse * light.radiance,
            specular: Vec3::ZERO,
            exact: !outlines?.is_far(position, self.split(light).0),
        };
        self.sample_ray(index, &sample, 1.0)
    }

    /// Directions that follow the specular lobe, the same for every light; none on rough
    /// surfaces.
    pub(crate) fn lobe_directions(&self, directions: &mut Vec<Vec3>) {
        directions.clear();
        let count = if self.brdf.is_smooth() {
            self.strata.0 * self.strata.1 / 2
        } else {
            0
        };
        let strata = sampling::strata(count);
        let key = self.key.mix(u64::MAX);
        directions.extend((0..count).map(|sample| {
            let square = stratified(strata, sample, key.uniform2(sample));
            self.brdf.sample_specular(square)
        }));
    }
}

/// What one point of an area light gives, lobe by lobe.
struct AreaSample {
    target: Vec3,
    /// Irradiance from a light of radiance 1, in sr.
    weight: f32,
    /// What of it the diffuse lobe reflects of the light's own radiance.
    diffuse: Vec3,
    /// Radiance that the specular lobe reflects.
    specular: Vec3,
    exact: bool,
}

/// By what the weights of samples are multiplied so that they add up to the irradiance that
/// the closed form finds: a ratio estimator for what is in the way (Heitz, Hill and McGuire 2018,
/// *Combining Analytic Direct Illumination and Stochastic Shadows*).
#[inline(always)]
pub(crate) fn weight_factor(irradiance: f32, weights: f32) -> f32 {
    let factor = irradiance / weights;
    if (weights > 0.0) & (factor < f32::INFINITY) {
        factor
    } else {
        1.0
    }
}

impl World {
    /// Calls `found` with the shadow rays to sample points on one light: one to a light
    /// without extent, stratified over the area of others. Their radiances, with those of
    /// the rays that follow a smooth surface's lobe, add up to the light's whole: what the
    /// diffuse lobe reflects of it does so exactly, if the light is integrated in closed form.
    /// Rays that carry nothing, whatever the visibility, are left out: from behind the surface,
    /// out of the cone, black.
    #[inline]
    pub fn for_each_light_ray(
        &self,
        index: u32,
        points: &LightPoints<'_>,
        mut found: impl FnMut(LightRay),
    ) {
        let Some(light) = self.scene().lights.get(index as usize) else {
            return;
        };
        if light.is_delta() {
            let sample = light.sample(points.surface.position, Vec2::ZERO, self.reach());
            let ray = sample.and_then(|sample| {
                let radiance = points.brdf.times_cosine(sample.wi) * sample.normal_irradiance;
                LightRay::between(index, light, points.surface, sample.target, radiance)
            });
            ray.map(found);
            return;
        }
        if let LightForm::Area(form) = self.light_form(index) {
            area_rays(index, form, points, &mut found);
        }
    }

    /// A shadow ray to a light that passes through `place`. To an area light it starts at the
    /// surface point, and there is none where no part of the light lies behind the place; or
    /// if the light has too many triangles to look for one. To a light without extent it
    /// starts where the surface, were it flat, has the place between it and the light.
    #[must_use]
    pub fn light_ray_past(
        &self,
        index: u32,
        points: &LightPoints<'_>,
        place: Vec3,
    ) -> Option<LightRay> {
        let light = self.scene().lights.get(index as usize)?;
        let surface = points.surface;
        let LightKind::Area(area) = &light.kind else {
            let sample = light.sample(surface.position, Vec2::ZERO, self.reach())?;
            let along = match light.kind {
                LightKind::Directional { direction, .. } => direction,
                _ => place - sample.target,
            };
            let toward = along.dot(surface.geometric_normal);
            let t = (surface.position - place).dot(surface.geometric_normal) / toward;
            let shift = place + t * along - surface.position;
            // In front of the light, and behind the place.
            let moved = Surface {
                position: surface.position + shift,
                shadow_origin: surface.shadow_origin + shift,
                ..*surface
            };
            let sample = light.sample(moved.position, Vec2::ZERO, self.reach())?;
            let radiance = points.brdf.times_cosine(sample.wi) * sample.normal_irradiance;
            return (t > 0.0)
                .then(|| LightRay::between(index, light, &moved, sample.target, radiance))
                .flatten();
        };
        if !is_simple(area) {
            return None;
        }
        let direction = (place - surface.shadow_origin).try_normalize()?;
        let mut found = None;
        area.points_along(&Ray::new(surface.shadow_origin, direction), |point| {
            found = points.ray_to(index, area, point).or(found);
        });
        found
    }

    /// Calls `found` with the shadow rays to the area lights that lie in directions of
    /// [`LightPoints::lobe_directions`].
    #[inline]
    pub(crate) fn for_each_lobe_ray(
        &self,
        points: &LightPoints<'_>,
        directions: &[Vec3],
        mut found: impl FnMut(LightRay),
    ) {
        for (index, light) in (0u32..).zip(&self.scene().lights) {
            let LightKind::Area(area) = &light.kind else {
                continue;
            };
            if points.split(area).1 == 0 {
                continue;
            }
            for &direction in directions {
                area.points_along(&Ray::new(points.surface.position, direction), |point| {
                    let sample = points.sample_at(area, point);
                    // The diffuse lobe has its samples.
                    let ray = sample.and_then(|sample| points.sample_ray(index, &sample, 0.0));
                    ray.map(&mut found);
                });
            }
        }
    }
}

/// The rays to sample points over an area light.
fn area_rays(
    index: u32,
    form: AreaForm<'_>,
    points: &LightPoints<'_>,
    found: &mut impl FnMut(LightRay),
) {
    let irradiance = form.outlines.map(|outlines| points.irradiance(outlines));
    if irradiance == Some(0.0) {
        return;
    }
    let key = points.key.mix(u64::from(index));
    let (count, _) = points.split(form.light);
    let strata = sampling::strata(count);
    let mut samples = Vec::with_capacity(count as usize);
    samples.extend((0..count).filter_map(|sample| {
        let square = stratified(strata, sample, key.uniform2(sample));
        points.sample_at(form.light, form.light.point(square)?)
    }));
    let weights = samples.iter().fold(0.0, |sum, sample| sum + sample.weight);
    let factor = irradiance.map_or(1.0, |irradiance| weight_factor(irradiance, weights));
    for sample in &samples {
        points.sample_ray(index, sample, factor).map(&mut *found);
    }
    match irradiance {
        Some(irradiance) if weights == 0.0 && irradiance > LEAST => {
            points.only_ray(index, form, irradiance).map(found);
        }
        _ => {}
    }
}

/// Follow the lobe only to lights of at most so many triangles: each is tested.
const MAX_LOBE_TRIANGLES: usize = 64;

pub(crate) fn is_simple(light: &AreaLight) -> bool {
    light.triangles().len() <= MAX_LOBE_TRIANGLES
}

/// Whether smooth surfaces follow their lobe to a light.
pub(crate) fn follows_lobe(light: &Light) -> bool {
    matches!(&light.kind, LightKind::Area(area) if is_simple(area))
}

impl LightRay {
    /// A ray from a surface; `None` if it carries nothing.
    #[inline]
    fn new(light: u32, surface: &Surface, target: Vec3, radiance: Vec3) -> Option<Self> {
        // Not `> 0` on each: a light of one colour on a surface of another gives nothing.
        let carries = radiance.max_element() > 0.0 && radiance.is_finite();
        carries.then(|| Self {
            light,
            ray: Ray::segment(surface.shadow_origin, target),
            radiance,
            exact: false,
            from_light: false,
        })
    }

    /// A ray between a surface and a light without extent.
    #[inline]
    fn between(
        index: u32,
        light: &Light,
        surface: &Surface,
        target: Vec3,
        radiance: Vec3,
    ) -> Option<Self> {
        let mut ray = Self::new(index, surface, target, radiance)?;
        if !matches!(light.kind, LightKind::Directional { .. }) {
            ray.ray = Ray::segment_from(target, surface.shadow_origin);
            ray.from_light = true;
        }
        Some(ray)
    }

    /// Its end at the surface.
    #[must_use]
    pub fn surface_end(&self) -> Vec3 {
        if self.from_light {
            self.ray.at(1.0)
        } else {
            self.ray.origin
        }
    }

    /// Luminance of what it carries.
    #[must_use]
    pub fn weight(&self) -> f32 {
        luminance(self.radiance)
    }
}
