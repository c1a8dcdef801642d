use std::f64::consts::PI;

use lie_accel::PACKET;
use lie_geom::{RandomKey, sampling::stratified};
use lie_scene::{AreaShape, Surface};
use proptest::prelude::*;

use super::*;
use crate::{Brdf, point_lanes::PointLanes};

/// A rectangle of so many metres at `corner`, which shines along `u × v`.
fn rectangle(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> AreaLight {
    let shape = AreaShape::Rectangle {
        corner,
        edge_u,
        edge_v,
    };
    AreaLight::new(shape, Vec3::ONE, false)
}

fn mesh(triangles: Vec<[Vec3; 3]>) -> AreaLight {
    AreaLight::new(AreaShape::Mesh { triangles }, Vec3::ONE, false)
}

/// The same light, shining from one side or both.
fn sided(light: &AreaLight, double_sided: bool) -> AreaLight {
    AreaLight::new(light.shape().clone(), light.radiance, double_sided)
}

/// Irradiance on a flat surface.
fn on(light: &AreaLight, position: Vec3, normal: Vec3) -> f64 {
    let outlines = Outlines::new(light).unwrap();
    outlines.irradiance(position, normal, normal).into()
}

fn check(found: f64, expected: f64) {
    let room = 1.0e-6 * expected.abs() + 1.0e-12;
    assert!(
        (found - expected).abs() <= room,
        "{found} is not {expected}"
    );
}

/// View factor, times π, from a patch to a parallel rectangle with a corner right above it
/// (Howell, *A catalog of radiation heat transfer configuration factors*, B-3), of sides `a`
/// and `b` times the height.
fn parallel(a: f64, b: f64) -> f64 {
    let (root_a, root_b) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    0.5 * (a / root_a * (b / root_a).atan() + b / root_b * (a / root_b).atan())
}

/// The same to a rectangle that stands upright, with an edge of its own length `b` in the
/// patch's plane, at distance 1, and height `a`: from the patch opposite to its corner
/// (Howell, B-4).
fn upright(a: f64, b: f64) -> f64 {
    let root = (1.0 + a * a).sqrt();
    0.5 * (b.atan() - (b / root).atan() / root)
}

#[test]
fn rectangles_have_the_view_factors_of_the_books() {
    for (a, b) in [(1.0, 1.0), (0.1, 3.0), (30.0, 20.0), (0.01, 0.02)] {
        let (u, v) = (Vec3::X * a as f32, Vec3::Z * b as f32);
        let above = rectangle(Vec3::Y, u, v);
        let (a, b) = (f64::from(a as f32), f64::from(b as f32));
        check(on(&above, Vec3::ZERO, Vec3::Y), parallel(a, b));
        // Faces the patch, along -x, from x = 1.
        let beside = rectangle(Vec3::X, v, Vec3::Y * a as f32);
        check(on(&beside, Vec3::ZERO, Vec3::Y), upright(a, b));
    }
}

#[test]
fn a_sky_is_a_whole_hemisphere() {
    let sky = rectangle(
        Vec3::new(-1.0e6, 1.0, -1.0e6),
        2.0e6 * Vec3::X,
        2.0e6 * Vec3::Z,
    );
    check(on(&sky, Vec3::ZERO, Vec3::Y), PI);
    // Upright patches see half of it.
    let half = on(&sky, Vec3::ZERO, Vec3::X);
    assert!((half - 0.5 * PI).abs() < 1.0e-5, "{half}");
}

#[test]
fn far_lights_go_by_the_inverse_square() {
    for distance in [1.0e3f32, 1.0e5, 1.0e7] {
        let lamp = rectangle(Vec3::Y * distance, Vec3::X, Vec3::Z);
        let expected = f64::from(distance).powi(-2);
        let found = on(&lamp, Vec3::new(0.5, 0.0, 0.5), Vec3::Y);
        assert!(
            (found / expected - 1.0).abs() < 1.0e-5,
            "{found} at {distance}"
        );
    }
}

#[test]
fn the_horizon_cuts() {
    // A wall that faces the patch, half of it below its plane, gives what the upper half does.
    let (v, b) = (2.0 * Vec3::Z, 2.0);
    let wall = rectangle(Vec3::X - 3.0 * Vec3::Y, v, 6.0 * Vec3::Y);
    check(on(&wall, Vec3::ZERO, Vec3::Y), upright(3.0, b));
    // So it does to a surface with a shading normal of its own: both planes cut.
    let outlines = Outlines::new(&wall).unwrap();
    let slanted = Vec3::new(0.6, 0.8, 0.0);
    let whole = rectangle(Vec3::X, v, 3.0 * Vec3::Y);
    let expected = on(&whole, Vec3::ZERO, slanted);
    check(
        outlines.irradiance(Vec3::ZERO, slanted, Vec3::Y).into(),
        expected,
    );
    check(
        outlines.irradiance(Vec3::ZERO, Vec3::Y, slanted).into(),
        upright(3.0, b),
    );
    // All of it below.
    let below = rectangle(Vec3::X - 3.0 * Vec3::Y, v, 3.0 * Vec3::Y);
    check(on(&below, Vec3::ZERO, Vec3::Y), 0.0);
    check(on(&wall, Vec3::ZERO, Vec3::NEG_X), 0.0);
}

#[test]
fn behind_and_in_its_plane_there_is_nothing() {
    let lamp = rectangle(Vec3::Y, Vec3::X, Vec3::Z);
    let both = sided(&lamp, true);
    for place in [Vec3::Y, Vec3::new(0.5, 1.0, 0.5), Vec3::new(3.0, 1.0, 0.0)] {
        for normal in [Vec3::Y, Vec3::NEG_Y, Vec3::X] {
            check(on(&lamp, place, normal), 0.0);
            check(on(&both, place, normal), 0.0);
        }
    }
    let (above, below) = (2.0 * Vec3::Y, Vec3::ZERO);
    check(on(&lamp, above, Vec3::NEG_Y), 0.0);
    check(on(&both, above, Vec3::NEG_Y), parallel(1.0, 1.0));
    check(on(&both, below, Vec3::Y), parallel(1.0, 1.0));
    // Right in front of it, it fills the hemisphere.
    let near = on(&lamp, Vec3::new(0.5, 1.0 - 1.0e-6, 0.5), Vec3::Y);
    assert!((near - PI).abs() < 1.0e-4, "{near}");
}

#[test]
fn holes_and_corners_that_lean_in_are_left_out() {
    let cell = |x: f32, z: f32| {
        let at = |i: f32, j: f32| Vec3::new(x + i, 1.0, z + j);
        let [a, b, c, d] = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        [[a, b, c], [a, c, d]]
    };
    let light = |cells: &[usize]| {
        mesh(
            cells
                .iter()
                .flat_map(|i| cell((i % 3) as f32, (i / 3) as f32))
                .collect(),
        )
    };
    for cells in [&[0, 1, 2, 3, 5, 6, 7, 8][..], &[0, 3, 4], &[0, 2, 3, 4, 5]] {
        // Straight up, and with the horizon through it.
        for normal in [Vec3::Y, Vec3::new(0.8, 0.0, 0.6), Vec3::new(-0.6, 0.3, 0.2)] {
            let position = Vec3::new(1.3, 0.0, 1.1);
            let parts = cells.iter().map(|&i| on(&light(&[i]), position, normal));
            check(on(&light(cells), position, normal), parts.sum());
        }
    }
}

#[test]
fn degenerate_lights_have_no_closed_form_and_big_meshes_neither() {
    assert_eq!(Outlines::new(&mesh(vec![])), None);
    assert_eq!(
        Outlines::new(&mesh(vec![[Vec3::X; 3], [Vec3::X, Vec3::Y, Vec3::X]])),
        None
    );
    let lone = |i: usize| [Vec3::X, Vec3::Y, Vec3::ZERO].map(|corner| corner + 2.0 * i as f32);
    let lights = |count: usize| mesh((0..count).map(lone).collect());
    assert!(Outlines::new(&lights(MAX_EDGES / 3)).is_some());
    assert_eq!(Outlines::new(&lights(MAX_EDGES / 3 + 1)), None);
}

#[test]
fn some_point_is_on_what_shines() {
    // A wall, of which a strip is above the horizon.
    let wall = rectangle(Vec3::X - 3.0 * Vec3::Y, 2.0 * Vec3::Z, 3.01 * Vec3::Y);
    let point = Outlines::some_point(&wall, Vec3::ZERO, Vec3::Y, Vec3::Y).unwrap();
    assert!(point.position.y > 0.0 && point.position.y < 0.01);
    assert!((point.position.x - 1.0).abs() < 1.0e-6);
    assert!(point.position.z > 0.0 && point.position.z < 2.0);
    assert!(Outlines::some_point(&wall, Vec3::ZERO, Vec3::NEG_X, Vec3::NEG_X).is_none());
}

#[test]
fn what_is_far_has_no_near_samples() {
    let light = rectangle(
        Vec3::new(3.0, 4.0, 5.0),
        Vec3::new(2.0, 0.5, 0.0),
        Vec3::new(0.0, 1.0, 3.0),
    );
    let outlines = Outlines::new(&light).unwrap();
    let (mut far, mut near) = (0, 0);
    for index in 0..4000 {
        let key = RandomKey::new(index);
        let random = Vec3::new(key.uniform(0), key.uniform(1), key.uniform(2));
        let position = Vec3::new(3.0, 4.0, 5.0) + 12.0 * (random - 0.5);
        let point = light.point(key.uniform2(3)).unwrap();
        let double = sided(&light, true);
        let Some((_, _, density)) = point.seen_from(position, &double) else {
            continue;
        };
        let is_near = 16.0 * density * NEAR < 1.0;
        let is_far = outlines.is_far(position, 16);
        assert!(!(is_near && is_far), "at {position}");
        far += u32::from(is_far);
        near += u32::from(is_near);
    }
    assert!(far > 1000 && near > 10, "{far} {near}");
}

/// A triangle soup's irradiance by samples: mean and standard error.
fn sampled(light: &AreaLight, position: Vec3, normal: Vec3, flat: Vec3, seed: u64) -> (f64, f64) {
    let side = 48;
    let means = (0..16).map(|round| {
        let key = RandomKey::new(seed).mix(round);
        let values = (0..side * side).map(|index| {
            let square = stratified((side, side), index, key.uniform2(index));
            let seen = light
                .point(square)
                .and_then(|point| point.seen_from(position, light));
            seen.map_or(0.0, |(_, wi, density)| {
                let cosine = f64::from(wi.dot(normal));
                let is_seen = cosine > 0.0 && wi.dot(flat) > 0.0;
                if is_seen {
                    cosine / f64::from(density)
                } else {
                    0.0
                }
            })
        });
        values.sum::<f64>() / f64::from(side * side)
    });
    let means: Vec<f64> = means.collect();
    let mean = means.iter().sum::<f64>() / 16.0;
    let squares: f64 = means.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (16.0 * 15.0)).sqrt())
}

/// A matt surface.
fn matt(position: Vec3, normal: Vec3, flat: Vec3) -> (Surface, Brdf) {
    let surface = Surface {
        position,
        shadow_origin: position,
        wo: normal,
        geometric_normal: flat,
        shading_normal: normal,
        front: true,
        triangle: 0,
        material: 0,
        base_color: Vec3::ONE,
        metallic: 0.0,
        roughness: 1.0,
    };
    let brdf = Brdf {
        normal,
        geometric_normal: flat,
        wo: normal,
        diffuse: Vec3::ONE,
        f0: Vec3::ZERO,
        f90: 0.0,
        alpha: 1.0,
        cos_o: 1.0,
    };
    (surface, brdf)
}

fn vector(size: f32) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-size..size).prop_map(Vec3::from)
}

fn direction() -> impl Strategy<Value = Vec3> {
    vector(1.0).prop_filter_map("no direction", |vector| vector.try_normalize())
}

/// Rectangles, and triangles that may share edges, as they may come.
fn light() -> impl Strategy<Value = AreaLight> {
    let rectangles =
        (vector(2.0), vector(2.0), vector(2.0)).prop_map(|(corner, u, v)| rectangle(corner, u, v));
    let corners = prop::array::uniform5(vector(2.0));
    let meshes = (
        corners,
        prop::collection::vec([0..5usize, 0..5, 0..5], 1..7),
    )
        .prop_map(|(corners, indices)| {
            mesh(
                indices
                    .iter()
                    .map(|index| index.map(|i| corners[i]))
                    .collect(),
            )
        });
    let lights = prop_oneof![rectangles, meshes];
    (lights, any::<bool>()).prop_map(|(light, double_sided)| sided(&light, double_sided))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn samples_converge_to_it(
        light in light(),
        position in vector(3.0),
        normal in direction(),
        lean in vector(0.7),
        seed: u64,
    ) {
        let flat = (normal + lean).normalize_or(normal);
        let Some(outlines) = Outlines::new(&light) else { return Ok(()) };
        let found = f64::from(outlines.irradiance(position, normal, flat));
        let (mean, error) = sampled(&light, position, normal, flat, seed);
        // Points so near that samples rarely find what gives most say nothing.
        prop_assume!(error < 0.02 * mean + 1.0e-3);
        prop_assert!((found - mean).abs() <= 5.0 * error + 1.0e-5 * (1.0 + mean),
            "{} is not {} ± {}", found, mean, error);
    }

    #[test]
    fn it_is_never_negative_and_never_too_much(
        light in light(),
        scale in -12.0f32..12.0,
        position in vector(3.0),
        normal in direction(),
        at_corner: bool,
    ) {
        let scale = scale.exp2();
        let corners = light.triangles().iter().map(|t| [t.a, t.b, t.c].map(|p| scale * p));
        let light = sided(&mesh(corners.collect()), light.double_sided);
        let position = if at_corner { light.triangles()[0].b } else { scale * position };
        let Some(outlines) = Outlines::new(&light) else { return Ok(()) };
        let found = f64::from(outlines.irradiance(position, normal, normal));
        let most = PI * light.triangles().len() as f64 * (1.0 + 1.0e-6);
        prop_assert!((0.0..=most).contains(&found), "{}", found);
    }

    #[test]
    fn lanes_are_the_same_bits(
        light in light(),
        points in prop::collection::vec((vector(3.0), direction(), vector(0.7)), PACKET),
    ) {
        let Some(outlines) = Outlines::new(&light) else { return Ok(()) };
        let mut lanes = PointLanes::new();
        let mut expected = [0.0; PACKET];
        for (lane, (position, normal, lean)) in points.iter().enumerate() {
            let flat = (*normal + *lean).normalize_or(*normal);
            expected[lane] = outlines.irradiance(*position, *normal, flat);
            let (surface, brdf) = matt(*position, *normal, flat);
            lanes.set(lane, &surface, &brdf, RandomKey::new(0));
        }
        prop_assert_eq!(outlines.irradiances(&lanes).map(f32::to_bits), expected.map(f32::to_bits));
        let far = outlines.far(&lanes, 16);
        for (lane, (position, ..)) in points.iter().enumerate() {
            prop_assert_eq!(far >> lane & 1 == 1, outlines.is_far(*position, 16));
        }
    }
}
