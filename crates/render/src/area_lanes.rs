//! Sample points on an area light for sixteen surface points at once. Each lane does what
//! [`crate::World::for_each_light_ray`] does for one point, operation by operation, so the
//! sums are the same bits.

use lie_accel::PACKET;
use lie_geom::{OFFSET_ULPS, RandomKey, sampling::stratified};
use lie_scene::{AreaLight, AreaShape};
use multiversion::multiversion;

use crate::{
    light_rays::NEAR,
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
pub(crate) struct AreaLanes {
    /// Where its shadow ray ends.
    pub(crate) target: [Lanes; 3],
    pub(crate) radiance: RadianceLanes,
    /// [`crate::LightRay::exact`].
    pub(crate) exact: [bool; PACKET],
}

/// A sample point for each lane.
struct LightPointLanes {
    position: [Lanes; 3],
    normal: [Lanes; 3],
    extent: Lanes,
}

/// The sample of this number; `keys` are the points' for this light.
pub(crate) fn sample(
    points: &PointLanes,
    light: &AreaLight,
    keys: &[RandomKey; PACKET],
    sampling: AreaSampling,
    sample: u32,
) -> AreaLanes {
    let places = places(light, keys, sampling.strata, sample);
    if !points.is_glossy {
        weigh_matt(points, light, &places, sampling)
    } else if sampling.by_lobe == 0 {
        weigh_glossy(points, light, &places, sampling)
    } else {
        weigh_smooth(points, light, &places, sampling)
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
) -> AreaLanes {
    weigh::<false, false>(points, light, places, sampling)
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
) -> AreaLanes {
    weigh::<true, false>(points, light, places, sampling)
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
) -> AreaLanes {
    weigh::<true, true>(points, light, places, sampling)
}

/// With `SMOOTH`, samples that follow the lobe share the weight.
#[inline(always)]
fn weigh<const GLOSSY: bool, const SMOOTH: bool>(
    points: &PointLanes,
    light: &AreaLight,
    places: &LightPointLanes,
    sampling: AreaSampling,
) -> AreaLanes {
    let area = light.area();
    let light_radiance = light.radiance.to_array();
    let double_sided = light.double_sided;
    let (by_area, by_lobe) = (sampling.by_area as f32, sampling.by_lobe as f32);
    let mut lanes = AreaLanes {
        target: [[0.0; PACKET]; 3],
        radiance: [[0.0; PACKET]; 3],
        exact: [false; PACKET],
    };
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
        let mut carries = (cosine > 0.0) & (reciprocal > 0.0) & (reciprocal < f32::INFINITY);
        let mut radiance = [0.0; 3];
        for channel in 0..3 {
            radiance[channel] = reflection.reflected[channel] * light_radiance[channel] / share;
            carries &= radiance[channel].abs() < f32::INFINITY;
        }
        for axis in 0..3 {
            lanes.target[axis][lane] = target[axis];
            lanes.radiance[axis][lane] = if carries { radiance[axis] } else { 0.0 };
        }
        lanes.exact[lane] = (lobe_share > area_share) | (share * NEAR < 1.0);
    }
    lanes
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{UVec2, Vec2, Vec3};
    use lie_geom::{Ray, sampling};
    use lie_scene::{Gallery, LightKind, Scene, gallery};

    use super::*;
    use crate::{Brdf, LightPoints, LightRay, World, light_rays::is_simple};

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
                let LightKind::Area(area) = &light.kind else {
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
                    let follow = brdf.is_smooth() && is_simple(area);
                    let found = in_lane(&lanes, lane, index, area, strata, follow);
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
        light: &AreaLight,
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
        let samples =
            (0..sampling.by_area).map(|number| sample(points, light, &keys, sampling, number));
        samples
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
