//! Sample points on an area light for sixteen surface points at once. Each lane does what
//! [`crate::World::for_each_light_ray`] does for one point, operation by operation, so the
//! sums are the same bits.

use glam::Vec3;
use lie_accel::PACKET;
use lie_geom::{OFFSET_ULPS, RandomKey, sampling::stratified};
use lie_scene::{AreaLight, AreaShape};
use multiversion::multiversion;

use crate::{
    closed_form::{LEAST, NEAR, Outlines},
    light_form::AreaForm,
    light_rays::weight_factor,
    point_lanes::{Lanes, PointLanes, RadianceLanes, add, dot, larger, scale, subtract},
};

/// How a light is sampled from points of one kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AreaSampling {
    /// Columns and rows of the samples over its area.
    pub(crate) strata: (u32, u32),
    /// Samples over its area.
    pub(crate) by_area: u32,
    /// Samples that follow the points' lobe, on smooth surfaces: taken elsewhere, but they
    /// share the weight.
    pub(crate) by_lobe: u32,
}

/// What one sample of the light gives each point if nothing is in the way.
#[derive(Clone)]
pub(crate) struct AreaLanes {
    /// Where its shadow ray ends.
    pub(crate) target: [Lanes; 3],
    /// Of a sample that is weighed but not scaled yet, what the diffuse lobe reflects of the
    /// light's radiance for an irradiance of 1.
    pub(crate) radiance: RadianceLanes,
    /// What the specular lobe reflects of the light.
    specular: RadianceLanes,
    /// Irradiance from a light of radiance 1, in sr.
    weight: Lanes,
    /// [`crate::LightRay::exact`].
    pub(crate) exact: [bool; PACKET],
    /// The lanes that it lights, as far as is known: bit `i` for lane `i`. Not set here.
    pub(crate) lit: u32,
}

/// A sample point for each lane.
struct LightPointLanes {
    position: [Lanes; 3],
    normal: [Lanes; 3],
    extent: Lanes,
}

/// All samples; `keys` are the points' for this light, `irradiance` what the closed form has for
/// them, if it has anything. Of use in these `lanes` only.
pub(crate) fn gather(
    points: &PointLanes,
    form: AreaForm<'_>,
    keys: &[RandomKey; PACKET],
    sampling: AreaSampling,
    (irradiance, lanes): (Option<&Lanes>, u32),
    samples: &mut Vec<AreaLanes>,
) {
    // In place: a sample is too large to be moved.
    samples.resize(sampling.by_area as usize, AreaLanes::NOTHING);
    for (number, sample) in (0..).zip(&mut *samples) {
        let places = places(form.light, keys, sampling.strata, number);
        let weigh = match (points.is_glossy, sampling.by_lobe > 0) {
            (false, _) => weigh_matt,
            (true, false) => weigh_glossy,
            (true, true) => weigh_smooth,
        };
        weigh(points, form.light, &places, sampling, sample);
    }
    let weights = scale_all(samples, irradiance);
    let Some(irradiance) = irradiance else { return };
    let is_missed =
        |lane: &usize| lanes >> lane & 1 == 1 && weights[*lane] == 0.0 && irradiance[*lane] > LEAST;
    let mut missed = (0..PACKET).filter(is_missed).peekable();
    if missed.peek().is_some() {
        let mut only = AreaLanes::NOTHING;
        for lane in missed {
            only.aim(lane, points, form, sampling, irradiance[lane]);
        }
        samples.push(only);
    }
}

/// What the diffuse lobe reflects of a light that nothing hides, by its closed form.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
pub(crate) fn reflect_all(
    points: &PointLanes,
    light: &AreaLight,
    irradiance: &Lanes,
) -> RadianceLanes {
    let mut radiance = [[0.0; PACKET]; 3];
    for channel in 0..3 {
        for lane in 0..PACKET {
            radiance[channel][lane] =
                points.diffuse[channel][lane] * light.radiance[channel] * irradiance[lane];
        }
    }
    radiance
}

/// Scales the weights to the irradiance of the closed form, and finishes the radiances. What
/// the weights add up to.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn scale_all(samples: &mut [AreaLanes], irradiance: Option<&Lanes>) -> Lanes {
    let mut weights = [0.0; PACKET];
    for sample in &*samples {
        for lane in 0..PACKET {
            weights[lane] += sample.weight[lane];
        }
    }
    let mut factors = [1.0; PACKET];
    if let Some(irradiance) = irradiance {
        for lane in 0..PACKET {
            factors[lane] = weight_factor(irradiance[lane], weights[lane]);
        }
    }
    for sample in samples {
        for channel in 0..3 {
            for lane in 0..PACKET {
                let weight = sample.weight[lane] * factors[lane];
                let value =
                    sample.radiance[channel][lane] * weight + sample.specular[channel][lane];
                sample.radiance[channel][lane] = value;
            }
        }
    }
    weights
}

impl AreaLanes {
    const NOTHING: Self = Self {
        target: [[0.0; PACKET]; 3],
        radiance: [[0.0; PACKET]; 3],
        specular: [[0.0; PACKET]; 3],
        weight: [0.0; PACKET],
        exact: [false; PACKET],
        lit: 0,
    };

    /// One ray for all of a light that no sample has found above the horizon.
    #[cold]
    fn aim(
        &mut self,
        lane: usize,
        points: &PointLanes,
        AreaForm {
            light, outlines, ..
        }: AreaForm<'_>,
        sampling: AreaSampling,
        irradiance: f32,
    ) -> Option<()> {
        let at = |axes: &[Lanes; 3]| Vec3::new(axes[0][lane], axes[1][lane], axes[2][lane]);
        let (position, normal) = (at(&points.position), at(&points.normal));
        let point = Outlines::some_point(light, position, normal, at(&points.geometric_normal))?;
        let (target, wi, _) = point.seen_from(position, light)?;
        let reflection = points.reflect::<true, false>(lane, wi.to_array());
        if reflection.cosine > 0.0 {
            for axis in 0..3 {
                self.target[axis][lane] = target[axis];
                self.radiance[axis][lane] =
                    reflection.diffuse[axis] * light.radiance[axis] * irradiance;
            }
            self.exact[lane] = !outlines?.is_far(position, sampling.by_area);
        }
        Some(())
    }
}

fn places(
    light: &AreaLight,
    keys: &[RandomKey; PACKET],
    strata: (u32, u32),
    sample: u32,
) -> LightPointLanes {
    if let &AreaShape::Rectangle {
        corner,
        edge_u,
        edge_v,
    } = light.shape()
    {
        let extent = edge_u.abs().max(edge_v.abs()).max_element();
        let normal = light.triangles()[0].normal.to_array();
        let edges = [corner, edge_u, edge_v].map(|edge| edge.to_array());
        return LightPointLanes {
            position: on_rectangle(edges, keys, strata, sample),
            normal: normal.map(|axis| [axis; PACKET]),
            extent: [extent; PACKET],
        };
    }
    let mut places = LightPointLanes {
        position: [[0.0; PACKET]; 3],
        normal: [[0.0; PACKET]; 3],
        extent: [0.0; PACKET],
    };
    for lane in 0..PACKET {
        let square = stratified(strata, sample, keys[lane].uniform2(sample));
        // None, and then no normal, for a light without area.
        if let Some(point) = light.point(square) {
            for axis in 0..3 {
                places.position[axis][lane] = point.position[axis];
                places.normal[axis][lane] = point.normal[axis];
            }
            places.extent[lane] = point.extent();
        }
    }
    places
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn on_rectangle(
    [corner, edge_u, edge_v]: [[f32; 3]; 3],
    keys: &[RandomKey; PACKET],
    strata: (u32, u32),
    sample: u32,
) -> [Lanes; 3] {
    let mut position = [[0.0; PACKET]; 3];
    for lane in 0..PACKET {
        let square = stratified(strata, sample, keys[lane].uniform2(sample));
        for axis in 0..3 {
            position[axis][lane] = corner[axis] + square.x * edge_u[axis] + square.y * edge_v[axis];
        }
    }
    position
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn weigh_matt(
    points: &PointLanes,
    light: &AreaLight,
    places: &LightPointLanes,
    sampling: AreaSampling,
    sample: &mut AreaLanes,
) {
    weigh::<false, false>(points, light, places, sampling, sample);
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn weigh_glossy(
    points: &PointLanes,
    light: &AreaLight,
    places: &LightPointLanes,
    sampling: AreaSampling,
    sample: &mut AreaLanes,
) {
    weigh::<true, false>(points, light, places, sampling, sample);
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn weigh_smooth(
    points: &PointLanes,
    light: &AreaLight,
    places: &LightPointLanes,
    sampling: AreaSampling,
    sample: &mut AreaLanes,
) {
    weigh::<true, true>(points, light, places, sampling, sample);
}

/// Fills all of `lanes`. With `SMOOTH`, samples that follow the lobe share the weight.
#[inline(always)]
fn weigh<const GLOSSY: bool, const SMOOTH: bool>(
    points: &PointLanes,
    light: &AreaLight,
    places: &LightPointLanes,
    sampling: AreaSampling,
    lanes: &mut AreaLanes,
) {
    let area = light.area();
    let light_radiance = light.radiance.to_array();
    let double_sided = light.double_sided;
    let (by_area, by_lobe) = (sampling.by_area as f32, sampling.by_lobe as f32);
    for lane in 0..PACKET {
        let at = |axes: &[Lanes; 3]| [axes[0][lane], axes[1][lane], axes[2][lane]];
        let (position, normal) = (at(&places.position), at(&places.normal));
        let to_light = subtract(position, at(&points.position));
        let squared = dot(to_light, to_light);
        let reciprocal = 1.0 / squared.sqrt();
        let wi = scale(to_light, reciprocal);
        let towards = -dot(wi, normal);
        let flip = double_sided & (towards < 0.0);
        let cosine = if flip { -towards } else { towards };
        let side = if flip { scale(normal, -1.0) } else { normal };
        // `offset_origin`.
        let coordinate = larger(
            larger(position[0].abs(), position[1].abs()),
            position[2].abs(),
        );
        let offset = OFFSET_ULPS * (coordinate + places.extent[lane]);
        let target = add(position, scale(side, offset));

        let reflection = points.reflect::<GLOSSY, SMOOTH>(lane, wi);
        let area_share = by_area * (squared / (cosine * area));
        let lobe_share = if SMOOTH {
            by_lobe * reflection.density
        } else {
            0.0
        };
        let share = area_share + lobe_share;
        let weight = reflection.cosine / area_share;
        let mut carries = (cosine > 0.0) & (reciprocal > 0.0) & (reciprocal < f32::INFINITY);
        carries &= (reflection.cosine > 0.0) & (weight < f32::INFINITY);
        let mut specular = [0.0; 3];
        if GLOSSY {
            for channel in 0..3 {
                let reflected = reflection.specular[channel] * reflection.cosine;
                specular[channel] = reflected * light_radiance[channel] / share;
                carries &= specular[channel].abs() < f32::INFINITY;
            }
        }
        for axis in 0..3 {
            let diffuse = reflection.diffuse[axis] * light_radiance[axis];
            lanes.target[axis][lane] = target[axis];
            lanes.radiance[axis][lane] = if carries { diffuse } else { 0.0 };
            lanes.specular[axis][lane] = if carries { specular[axis] } else { 0.0 };
        }
        lanes.weight[lane] = if carries { weight } else { 0.0 };
        lanes.exact[lane] = (lobe_share > area_share) | (area_share * NEAR < 1.0);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{UVec2, Vec2, Vec3};
    use lie_geom::{Ray, sampling};
    use lie_scene::{Gallery, LightKind, Scene, gallery};

    use super::*;
    use crate::{Brdf, LightPoints, LightRay, World, light_form::LightForm, light_rays::is_simple};

    /// Rays that carry something, as lanes and the scalar code have them.
    #[derive(Default)]
    struct Met {
        lit: usize,
        exact: usize,
        smooth: usize,
    }

    #[test]
    fn lanes_do_what_the_scalar_code_does() {
        let mut scene = gallery(&Gallery {
            detail: 0.1,
            ..Gallery::default()
        });
        // Lights of both shapes, shining to both sides and to one.
        let mut rectangles = false;
        for light in &mut scene.lights {
            if let LightKind::Area(area) = &mut light.kind {
                rectangles |= matches!(area.shape(), AreaShape::Rectangle { .. });
                area.double_sided = !area.double_sided;
            }
        }
        if !rectangles {
            let shape = AreaShape::Rectangle {
                corner: Vec3::new(-1.0, 3.0, -1.0),
                edge_u: Vec3::new(2.0, 0.0, 0.5),
                edge_v: Vec3::new(0.0, 0.0, 2.0),
            };
            let kind = LightKind::Area(AreaLight::new(shape, Vec3::ONE, false));
            let name = "panel".into();
            scene.lights.push(lie_scene::Light { name, kind });
        }
        let mut met = Met::default();
        for strata in [(4, 4), (3, 2)] {
            check(scene.clone(), strata, &mut met);
        }
        assert!(met.lit > 1000 && met.exact > 10 && met.smooth > 100);
    }

    fn check(scene: Scene, strata: (u32, u32), met: &mut Met) {
        let world = World::new(Arc::new(scene));
        let scene = world.scene();
        for camera in &scene.cameras {
            let mut points = vec![];
            let mut lanes = PointLanes::new();
            for lane in 0..64 {
                let place: Vec2 = RandomKey::new(3).uniform2(lane) * 64.0;
                let ray = camera.ray(place, UVec2::splat(64));
                let Some(surface) = world.first_surface(&ray) else {
                    continue;
                };
                if points.len() < PACKET {
                    let (brdf, key) = (Brdf::new(scene, &surface), RandomKey::new(lane.into()));
                    lanes.set(points.len(), &surface, &brdf, key);
                    points.push((surface, brdf, key));
                }
            }
            for (index, light) in (0..).zip(&scene.lights) {
                let LightForm::Area(form) = world.light_form(index) else {
                    continue;
                };
                for (lane, (surface, brdf, key)) in points.iter().enumerate() {
                    let light_points = LightPoints {
                        surface,
                        brdf,
                        key: *key,
                        strata,
                    };
                    let mut expected = vec![];
                    world.for_each_light_ray(index, &light_points, |ray| expected.push(ray));
                    let follow = brdf.is_smooth() && is_simple(form.light);
                    let found = in_lane(&lanes, lane, index, form, strata, follow);
                    assert_eq!(found, expected, "light {}", light.name);
                    met.lit += found.len();
                    met.exact += found.iter().filter(|ray| ray.exact).count();
                    met.smooth += if follow { found.len() } else { 0 };
                }
            }
        }
    }

    fn in_lane(
        points: &PointLanes,
        lane: usize,
        index: u32,
        form: AreaForm<'_>,
        strata: (u32, u32),
        follow: bool,
    ) -> Vec<LightRay> {
        let count = strata.0 * strata.1;
        let by_lobe = if follow { count / 2 } else { 0 };
        let sampling = AreaSampling {
            strata: sampling::strata(count - by_lobe),
            by_area: count - by_lobe,
            by_lobe,
        };
        let keys = points.keys.map(|key| key.mix(index.into()));
        let irradiance = form.outlines.map(|outlines| outlines.irradiances(points));
        if irradiance.is_some_and(|irradiance| irradiance[lane] == 0.0) {
            return vec![];
        }
        let mut samples = vec![];
        let at = (irradiance.as_ref(), 1 << lane);
        gather(points, form, &keys, sampling, at, &mut samples);
        samples
            .into_iter()
            .map(|sample| {
                let at = |axes: &[Lanes; 3]| Vec3::from(axes.map(|axis| axis[lane]));
                LightRay {
                    light: index,
                    ray: Ray::segment(at(&points.origin), at(&sample.target)),
                    radiance: at(&sample.radiance),
                    exact: sample.exact[lane],
                    from_light: false,
                }
            })
            .filter(|ray| ray.radiance != Vec3::ZERO)
            .collect()
    }
}
