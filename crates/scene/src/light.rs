use glam::{Vec2, Vec3};

use crate::AreaLight;

/// A source of light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name from the file, for people.
    pub name: String,
    /// What it is.
    pub kind: LightKind,
}

/// The kinds of light.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// An omnidirectional point.
    Point {
        /// Place.
        position: Vec3,
        /// W·sr⁻¹ in every direction.
        radiant_intensity: Vec3,
    },
    /// A point that shines into a cone; falls off from the inner to the outer angle as
    /// `KHR_lights_punctual` recommends.
    Spot {
        /// Place.
        position: Vec3,
        /// Axis of the cone, unit length, away from the light.
        direction: Vec3,
        /// W·sr⁻¹ inside the inner cone.
        radiant_intensity: Vec3,
        /// Cosine of the angle up to which the light is full; at least `cos_outer`.
        cos_inner: f32,
        /// Cosine of the angle from which on there is none.
        cos_outer: f32,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// The way the light travels, unit length.
        direction: Vec3,
        /// W·m⁻² on a surface that faces the light.
        irradiance: Vec3,
    },
    /// A shining surface.
    Area(AreaLight),
}

/// What a surface point receives from one sample point of a light, if nothing blocks it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Where the shadow ray ends: [`lie_geom::Ray::segment`] to here.
    pub target: Vec3,
    /// Direction to the light, unit length.
    pub wi: Vec3,
    /// Irradiance on a surface that faces the light, in W·m⁻²: the integrand times the
    /// inverse of the sampling density. Reflected radiance is `brdf · |cos θ| · this`.
    pub normal_irradiance: Vec3,
}

impl Light {
    /// Whether one sample is all there is to know: the light has no extent.
    #[must_use]
    pub fn is_delta(&self) -> bool {
        !matches!(self.kind, LightKind::Area(_))
    }

    /// The light's total power in W, per channel; for a directional light its irradiance,
    /// since its power depends on the scene.
    #[must_use]
    pub fn power(&self) -> Vec3 {
        use std::f32::consts::PI;
        match &self.kind {
            LightKind::Point {
                radiant_intensity, ..
            } => 4.0 * PI * *radiant_intensity,
            LightKind::Spot {
                radiant_intensity,
                cos_inner,
                cos_outer,
                ..
            } => {
                // The squared ramp between the cosines integrates to a third of its width.
                2.0 * PI * *radiant_intensity * ((1.0 - cos_inner) + (cos_inner - cos_outer) / 3.0)
            }
            LightKind::Directional { irradiance, .. } => *irradiance,
            LightKind::Area(area) => {
                PI * area.radiance * area.area() * if area.double_sided { 2.0 } else { 1.0 }
            }
        }
    }

    /// Samples what `point` receives. `square` in `[0, 1)²` picks the place on an area
    /// light; lights without extent ignore it. `reach` is a distance in metres that is
    /// outside the scene from everywhere in it, for directional lights.
    ///
    /// `None` where the light gives nothing: outside its cone, behind it, or at its very place.
    #[must_use]
    #[inline]
    pub fn sample(&self, point: Vec3, square: Vec2, reach: f32) -> Option<LightSample> {
        match &self.kind {
            LightKind::Point {
                position,
                radiant_intensity,
            } => from_point(point, *position, *radiant_intensity),
            LightKind::Spot {
                position,
                direction,
                radiant_intensity,
                cos_inner,
                cos_outer,
            } => {
                let sample = from_point(point, *position, *radiant_intensity)?;
                let falloff = spot_falloff(-sample.wi.dot(*direction), *cos_inner, *cos_outer);
                (falloff > 0.0).then(|| LightSample {
                    normal_irradiance: sample.normal_irradiance * falloff,
                    ..sample
                })
            }
            LightKind::Directional {
                direction,
                irradiance,
            } => Some(LightSample {
                target: point - *direction * reach,
                wi: -*direction,
                normal_irradiance: *irradiance,
            }),
            LightKind::Area(area) => {
                let (target, wi, density) = area.point(square)?.seen_from(point, area)?;
                Some(LightSample {
                    target,
                    wi,
                    normal_irradiance: area.radiance / density,
                })
            }
        }
    }
}

#[inline]
fn from_point(point: Vec3, position: Vec3, radiant_intensity: Vec3) -> Option<LightSample> {
    let to_light = position - point;
    let reciprocal = to_light.length_recip();
    (reciprocal > 0.0 && reciprocal.is_finite()).then(|| LightSample {
        target: position,
        wi: to_light * reciprocal,
        normal_irradiance: radiant_intensity * (reciprocal * reciprocal),
    })
}

/// By how much the ramp of a spot's soft edge rises per unit of the cosine.
#[must_use]
#[inline]
pub fn ramp_slope(cos_inner: f32, cos_outer: f32) -> f32 {
    1.0 / (cos_inner - cos_outer).max(1.0e-4)
}

/// `KHR_lights_punctual`: the square of a ramp between the cosines.
#[inline]
fn spot_falloff(cosine: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    if cosine <= cos_outer {
        return 0.0;
    }
    let ramp = ((cosine - cos_outer) * ramp_slope(cos_inner, cos_outer)).min(1.0);
    ramp * ramp
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AreaShape;

    #[test]
    fn the_spot_ends_at_its_outer_angle() {
        let light = Light {
            name: String::new(),
            kind: LightKind::Spot {
                position: Vec3::ZERO,
                direction: Vec3::NEG_Y,
                radiant_intensity: Vec3::ONE,
                cos_inner: 0.3f32.cos(),
                cos_outer: 0.5f32.cos(),
            },
        };
        let at = |angle: f32| {
            let point = 2.0 * Vec3::new(angle.sin(), -angle.cos(), 0.0);
            light
                .sample(point, Vec2::ZERO, 1.0)
                .map(|s| s.normal_irradiance.x)
        };
        assert!((at(0.0).unwrap() - 0.25).abs() < 1.0e-6);
        assert!((at(0.299).unwrap() - 0.25).abs() < 1.0e-4);
        assert!(at(0.4).unwrap() < 0.25 && at(0.4).unwrap() > 0.0);
        assert_eq!(at(0.501), None);
        assert_eq!(at(3.0), None);
    }

    #[test]
    fn degenerate_lights_give_nothing_instead_of_nonsense() {
        let empty = AreaLight::new(AreaShape::Mesh { triangles: vec![] }, Vec3::ONE, true);
        let flat = AreaLight::new(
            AreaShape::Mesh {
                triangles: vec![[Vec3::X; 3]],
            },
            Vec3::ONE,
            true,
        );
        for kind in [
            LightKind::Area(empty),
            LightKind::Area(flat),
            LightKind::Point {
                position: Vec3::ZERO,
                radiant_intensity: Vec3::ONE,
            },
        ] {
            let light = Light {
                name: String::new(),
                kind,
            };
            assert_eq!(light.sample(Vec3::ZERO, Vec2::splat(0.5), 1.0), None);
        }
    }
}
