//! Lights without extent on sixteen points at once. Each lane does what [`Brdf`] and
//! [`lie_scene::Light::sample`] do for one point, operation by operation, so the sums are the
//! same bits.

use std::f32::consts::PI;

use lie_accel::PACKET;
use lie_scene::{Light, LightKind, Surface, ramp_slope};
use multiversion::multiversion;

use crate::Brdf;

type Lanes = [f32; PACKET];

/// Up to sixteen surface points, one coordinate after the other.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct PointLanes {
    position: [Lanes; 3],
    /// Where shadow rays start.
    pub(crate) origin: [Lanes; 3],
    normal: [Lanes; 3],
    geometric_normal: [Lanes; 3],
    wo: [Lanes; 3],
    diffuse: [Lanes; 3],
    f0: [Lanes; 3],
    f90: Lanes,
    /// GGX α, squared.
    alpha2: Lanes,
    cos_o: Lanes,
    /// What masking on the way to the eye has beside the light's cosine.
    root_o: Lanes,
    /// Whether any lane reflects more than Lambert.
    is_glossy: bool,
}

/// Radiance of each point, by channel.
pub(crate) type RadianceLanes = [Lanes; 3];

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
}

impl PointLanes {
    /// Nothing in any lane: no light reaches such a point.
    pub(crate) fn new() -> Self {
        let zero = [[0.0; PACKET]; 3];
        Self {
            position: zero,
            origin: zero,
            normal: zero,
            geometric_normal: zero,
            wo: zero,
            diffuse: zero,
            f0: zero,
            f90: [0.0; PACKET],
            alpha2: [1.0; PACKET],
            cos_o: [1.0; PACKET],
            root_o: [1.0; PACKET],
            is_glossy: false,
        }
    }

    /// Puts a point into a lane.
    pub(crate) fn set(&mut self, lane: usize, surface: &Surface, brdf: &Brdf) {
        for axis in 0..3 {
            self.position[axis][lane] = surface.position[axis];
            self.origin[axis][lane] = surface.shadow_origin[axis];
            self.normal[axis][lane] = brdf.normal[axis];
            self.geometric_normal[axis][lane] = brdf.geometric_normal[axis];
            self.wo[axis][lane] = brdf.wo[axis];
            self.diffuse[axis][lane] = brdf.diffuse[axis];
            self.f0[axis][lane] = brdf.f0[axis];
        }
        self.f90[lane] = brdf.f90;
        let a2 = brdf.alpha * brdf.alpha;
        self.alpha2[lane] = a2;
        self.cos_o[lane] = brdf.cos_o;
        self.root_o[lane] = (brdf.cos_o * brdf.cos_o * (1.0 - a2) + a2).sqrt();
        self.is_glossy |= !brdf.is_matt();
    }

    /// What a light gives each point if nothing is in the way.
    pub(crate) fn shade(&self, light: &DeltaLight) -> RadianceLanes {
        if self.is_glossy {
            shade_glossy(self, light)
        } else {
            shade_matt(self, light)
        }
    }
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
        let at = |lanes: &[Lanes; 3]| [lanes[0][lane], lanes[1][lane], lanes[2][lane]];
        let to_light = subtract(light.position, at(&points.position));
        let squared = dot(to_light, to_light);
        let reciprocal = 1.0 / squared.sqrt();
        let wi = scale(to_light, reciprocal);
        let cosine = -dot(wi, light.direction);
        let ramp = smaller((cosine - light.cos_outer) * light.ramp_slope, 1.0);
        let falloff = ramp * ramp;

        let (normal, f0, f90) = (at(&points.normal), at(&points.f0), points.f90[lane]);
        let cos_i = dot(normal, wi);
        let (grazing5, lobe) = if GLOSSY {
            glossy(points, lane, wi, cos_i)
        } else {
            (0.0, 0.0)
        };
        let faces = (cos_i > 0.0)
            & (dot(at(&points.geometric_normal), wi) > 0.0)
            & (cosine > light.cos_outer)
            & (reciprocal > 0.0)
            & (reciprocal < f32::INFINITY);
        let diffuse = at(&points.diffuse);
        let matt = !GLOSSY | (f90 == 0.0) & (f0[0] == 0.0) & (f0[1] == 0.0) & (f0[2] == 0.0);
        let mut finite = true;
        let mut value = [0.0; 3];
        for channel in 0..3 {
            let fresnel = f0[channel] + (f90 - f0[channel]) * grazing5;
            let specular = fresnel * lobe;
            let glossy = (diffuse[channel] * (1.0 - fresnel) + specular) * cos_i;
            let reflected = if matt {
                diffuse[channel] * cos_i
            } else {
                glossy
            };
            let irradiance = light.radiant_intensity[channel] * (reciprocal * reciprocal);
            let irradiance = irradiance * falloff;
            value[channel] = reflected * irradiance;
            finite &= value[channel].abs() < f32::INFINITY;
        }
        let carries = faces & finite & ((value[0] > 0.0) | (value[1] > 0.0) | (value[2] > 0.0));
        for channel in 0..3 {
            radiance[channel][lane] = if carries { value[channel] } else { 0.0 };
        }
    }
    radiance
}

/// The fifth power of the grazing angle's complement, and the lobe without its Fresnel term.
#[inline(always)]
fn glossy(points: &PointLanes, lane: usize, wi: [f32; 3], cos_i: f32) -> (f32, f32) {
    let at = |lanes: &[Lanes; 3]| [lanes[0][lane], lanes[1][lane], lanes[2][lane]];
    let (normal, wo) = (at(&points.normal), at(&points.wo));
    let sum = add(wi, wo);
    let reciprocal = 1.0 / dot(sum, sum).sqrt();
    let has_half = reciprocal < f32::INFINITY;
    let half = scale(sum, reciprocal);
    let half = [
        if has_half { half[0] } else { normal[0] },
        if has_half { half[1] } else { normal[1] },
        if has_half { half[2] } else { normal[2] },
    ];
    let grazing = 1.0 - smaller(larger(dot(wo, half), 0.0), 1.0);
    let grazing2 = grazing * grazing;
    let (a2, cos_o) = (points.alpha2[lane], points.cos_o[lane]);
    let masking_i = cos_o * (cos_i * cos_i * (1.0 - a2) + a2).sqrt();
    let masking_o = cos_i * points.root_o[lane];
    let cos_half = larger(dot(normal, half), 0.0);
    let sine = cross(normal, half);
    let spread = cos_half * cos_half * a2 + dot(sine, sine);
    let lobe = 0.5 * a2 / (PI * spread * spread * (masking_i + masking_o));
    (grazing2 * grazing2 * grazing, lobe)
}

#[inline(always)]
fn subtract(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn scale(a: [f32; 3], factor: f32) -> [f32; 3] {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [
        a[1] * b[2] - b[1] * a[2],
        a[2] * b[0] - b[2] * a[0],
        a[0] * b[1] - b[0] * a[1],
    ]
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{UVec2, Vec2, Vec3};
    use lie_geom::RandomKey;
    use lie_scene::{Gallery, gallery};

    use super::*;
    use crate::{LightPoints, World};

    #[test]
    fn lanes_do_what_the_scalar_code_does() {
        let parameters = Gallery {
            detail: 0.1,
            ..Gallery::default()
        };
        let world = World::new(Arc::new(gallery(&parameters)));
        let scene = world.scene();
        let size = UVec2::splat(64);
        let mut lit = 0;
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
                    lanes.set(points.len(), &surface, &brdf);
                    points.push((surface, brdf));
                }
                for (index, light) in (0..).zip(&scene.lights) {
                    let Some(delta) = DeltaLight::new(light) else {
                        continue;
                    };
                    let radiance = lanes.shade(&delta);
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
    }
}
