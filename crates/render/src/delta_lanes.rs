//! Lights without extent on sixteen points at once. Each lane does what
//! [`lie_scene::Light::sample`] does for one point, operation by operation, so the sums are
//! the same bits.

use lie_accel::PACKET;
use lie_scene::{Light, LightKind, ramp_slope};
use multiversion::multiversion;

use crate::point_lanes::{PointLanes, RadianceLanes, dot, scale, smaller, subtract};

/// A light that the lanes serve: a point, or a spot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DeltaLight {
    pub(crate) position: [f32; 3],
    radiant_intensity: [f32; 3],
    direction: [f32; 3],
    cos_outer: f32,
    ramp_slope: f32,
}

impl DeltaLight {
    /// `None` for a light with extent, or without a place.
    pub(crate) fn new(light: &Light) -> Option<Self> {
        match light.kind {
            // A cone so wide that everything is well within.
            LightKind::Point {
                position,
                radiant_intensity,
            } => Some(Self {
                position: position.to_array(),
                radiant_intensity: radiant_intensity.to_array(),
                direction: [0.0; 3],
                cos_outer: -2.0,
                ramp_slope: 1.0,
            }),
            LightKind::Spot {
                position,
                direction,
                radiant_intensity,
                cos_inner,
                cos_outer,
            } => Some(Self {
                position: position.to_array(),
                radiant_intensity: radiant_intensity.to_array(),
                direction: direction.to_array(),
                cos_outer,
                ramp_slope: ramp_slope(cos_inner, cos_outer),
            }),
            LightKind::Directional { .. } | LightKind::Area(_) => None,
        }
    }

    /// Whether any point faces it and is in its cone: one that none does gives nothing.
    pub(crate) fn reaches_any(&self, points: &PointLanes) -> bool {
        reaches_any(points, self)
    }

    /// What it gives each point if nothing is in the way.
    pub(crate) fn shade(&self, points: &PointLanes) -> RadianceLanes {
        if points.is_glossy {
            shade_glossy(points, self)
        } else {
            shade_matt(points, self)
        }
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn reaches_any(points: &PointLanes, light: &DeltaLight) -> bool {
    let mut any = false;
    for lane in 0..PACKET {
        let position = &points.position;
        let position = [position[0][lane], position[1][lane], position[2][lane]];
        let to_light = subtract(light.position, position);
        let along = -dot(to_light, light.direction);
        // Without a root, and so with some room: the squares decide where both are positive.
        let outer = light.cos_outer;
        let squared = outer * outer * dot(to_light, to_light) * (1.0 - 1.0e-4);
        let is_outside = (outer > 0.0) & ((along <= 0.0) | (along * along < squared));
        any |= points.faces(lane, to_light) & !is_outside;
    }
    any
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn shade_glossy(points: &PointLanes, light: &DeltaLight) -> RadianceLanes {
    shade::<true>(points, light)
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn shade_matt(points: &PointLanes, light: &DeltaLight) -> RadianceLanes {
    shade::<false>(points, light)
}

/// Without `GLOSSY` all lanes are Lambert.
#[inline(always)]
fn shade<const GLOSSY: bool>(points: &PointLanes, light: &DeltaLight) -> RadianceLanes {
    let mut radiance = [[0.0; PACKET]; 3];
    for lane in 0..PACKET {
        let position = &points.position;
        let position = [position[0][lane], position[1][lane], position[2][lane]];
        let to_light = subtract(light.position, position);
        let reciprocal = 1.0 / dot(to_light, to_light).sqrt();
        let wi = scale(to_light, reciprocal);
        let cosine = -dot(wi, light.direction);
        let ramp = smaller((cosine - light.cos_outer) * light.ramp_slope, 1.0);
        let falloff = ramp * ramp;
        let reflected = points.reflect::<GLOSSY, false>(lane, wi);
        let mut carries =
            (cosine > light.cos_outer) & (reciprocal > 0.0) & (reciprocal < f32::INFINITY);
        let mut value = [0.0; 3];
        for channel in 0..3 {
            let irradiance = light.radiant_intensity[channel] * (reciprocal * reciprocal);
            value[channel] = reflected.times_cosine(channel) * (irradiance * falloff);
            carries &= value[channel].abs() < f32::INFINITY;
        }
        for channel in 0..3 {
            radiance[channel][lane] = if carries { value[channel] } else { 0.0 };
        }
    }
    radiance
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{UVec2, Vec2, Vec3};
    use lie_geom::RandomKey;
    use lie_scene::{Gallery, gallery};

    use super::*;
    use crate::{Brdf, LightPoints, World};

    #[test]
    fn lanes_do_what_the_scalar_code_does() {
        let parameters = Gallery {
            detail: 0.1,
            ..Gallery::default()
        };
        let world = World::new(Arc::new(gallery(&parameters)));
        let scene = world.scene();
        let size = UVec2::splat(64);
        let (mut lit, mut passed_by) = (0, 0);
        for camera in &scene.cameras {
            for start in 0..16 {
                let mut lanes = PointLanes::new();
                let mut points = vec![];
                for lane in 0..PACKET {
                    let place = RandomKey::new(start).uniform2(lane as u32) * 64.0;
                    let ray = camera.ray(Vec2::new(place.x, place.y), size);
                    let Some(surface) = world.first_surface(&ray) else {
                        continue;
                    };
                    let brdf = Brdf::new(scene, &surface);
                    lanes.set(points.len(), &surface, &brdf, RandomKey::new(0));
                    points.push((surface, brdf));
                }
                for (index, light) in (0..).zip(&scene.lights) {
                    let Some(delta) = DeltaLight::new(light) else {
                        continue;
                    };
                    let radiance = delta.shade(&lanes);
                    let gives = radiance.iter().flatten().any(|&value| value > 0.0);
                    assert!(delta.reaches_any(&lanes) || !gives, "light {}", light.name);
                    passed_by += usize::from(!delta.reaches_any(&lanes));
                    for (lane, (surface, brdf)) in points.iter().enumerate() {
                        let light_points = LightPoints {
                            surface,
                            brdf,
                            key: RandomKey::new(0),
                            strata: (1, 1),
                        };
                        let mut expected = Vec3::ZERO;
                        world.for_each_light_ray(index, &light_points, |ray| {
                            expected = ray.radiance;
                        });
                        let found = Vec3::from(radiance.map(|channel| channel[lane]));
                        assert_eq!(found, expected, "light {}", light.name);
                        lit += usize::from(expected != Vec3::ZERO);
                    }
                    for channel in radiance {
                        assert!(channel[points.len()..].iter().all(|&value| value == 0.0));
                    }
                }
            }
        }
        assert!(lit > 1000, "{lit} lanes were lit");
        assert!(passed_by > 10, "{passed_by} lights passed by");
    }
}
