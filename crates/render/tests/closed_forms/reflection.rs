//! The reflection model by itself, and smooth surfaces under area lights.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use lie_geom::{RandomKey, Ray};
use lie_render::{Brdf, World};
use lie_scene::{AreaShape, Material, Surface};

use crate::stage::{Estimate, Stage, seen};

/// Dielectric or metal of a roughness.
fn glossy(metallic: f32, roughness: f32) -> Material {
    Material {
        metallic,
        roughness,
        specular: 1.0,
        ..Material::diffuse("glossy", Vec3::new(0.9, 0.6, 0.3))
    }
}

/// A floor of a material, and its surface as seen along `-wo`.
fn floor(material: Material) -> (World, impl Fn(&World, Vec3) -> Surface) {
    let world = Stage::default().floor(material).world();
    let surface = |world: &World, wo: Vec3| {
        let ray = Ray::new(Vec3::new(0.1, 0.0, 0.2) + wo, -wo);
        world.first_surface(&ray).unwrap()
    };
    (world, surface)
}

/// Unit direction with this angle from +y.
fn direction(theta: f32, phi: f32) -> Vec3 {
    Vec3::new(
        theta.sin() * phi.cos(),
        theta.cos(),
        theta.sin() * phi.sin(),
    )
}

#[test]
fn light_may_be_followed_either_way() {
    for material in [
        Material::diffuse("lambert", Vec3::splat(0.7)),
        glossy(0.0, 0.2),
        glossy(0.0, 0.8),
        glossy(0.5, 0.4),
        glossy(1.0, 0.3),
        glossy(1.0, 1.0),
    ] {
        let (world, surface) = floor(material.clone());
        let key = RandomKey::new(5);
        for index in 0..200 {
            let [a, b] = [2 * index, 2 * index + 1].map(|n| {
                let square = key.uniform2(n);
                direction(1.5 * square.x, 2.0 * PI * square.y)
            });
            let brdf = |wo: Vec3, wi: Vec3| {
                Brdf::new(world.scene(), &surface(&world, wo)).times_cosine(wi) / wi.y
            };
            let (there, back) = (brdf(a, b), brdf(b, a));
            let close = (there - back).abs().cmple(2.0e-4 * there + 1.0e-6);
            assert!(close.all(), "{material:?}: {a} {b}: {there} {back}");
        }
    }
}

#[test]
fn nothing_is_reflected_below_the_surface() {
    let (world, surface) = floor(glossy(0.0, 0.6));
    let brdf = Brdf::new(world.scene(), &surface(&world, direction(0.7, 0.0)));
    for theta in [0.5001 * PI, 0.6 * PI, PI] {
        assert_eq!(brdf.times_cosine(direction(theta, 2.0)), Vec3::ZERO);
    }
}

/// GGX with Smith's height-correlated masking and a reflectance of 1, times the cosine, in
/// double precision, around +y.
fn exactly(wo: Vec3, wi: Vec3, alpha: f64) -> f64 {
    let (wo, wi) = (wo.as_dvec3().normalize(), wi.as_dvec3().normalize());
    let half = (wo + wi).normalize();
    let a2 = alpha * alpha;
    let sin2 = half.x * half.x + half.z * half.z;
    let d = half.y * half.y * a2 + sin2;
    let root = |cosine: f64| (cosine * cosine * (1.0 - a2) + a2).sqrt();
    let masking = wo.y * root(wi.y) + wi.y * root(wo.y);
    a2 / (std::f64::consts::PI * d * d) * 0.5 / masking * wi.y
}

#[test]
fn the_smoothest_highlights_keep_their_digits() {
    for roughness in [0.032f32, 0.05, 0.1, 0.3] {
        let mut metal = glossy(1.0, roughness);
        metal.base_color = Vec3::ONE;
        let (world, surface) = floor(metal);
        let key = RandomKey::new(2);
        for sample in 0..500 {
            let square = key.uniform2(2 * sample);
            let surface = surface(&world, direction(1.2 * square.x, 2.0 * PI * square.y));
            let brdf = Brdf::new(world.scene(), &surface);
            // Where the highlight is: the lobe's own samples, but for its far tail.
            let wi = brdf.sample_specular(0.9 * key.uniform2(2 * sample + 1));
            if wi.y < 0.05 {
                continue;
            }
            let alpha = f64::from(roughness * roughness).max(1.0e-3);
            let expected = exactly(surface.wo, wi, alpha);
            let found = f64::from(brdf.times_cosine(wi).x);
            // Directions are off by 1e-7, which a lobe of 0.001 rad turns into 1e-3.
            let error = (found / expected - 1.0).abs();
            assert!(
                error < 1.0e-3,
                "roughness {roughness}, {wi}: {found}, expected {expected}"
            );
        }
    }
}

/// Latitudes and longitudes of the sphere of directions, for histograms.
const BINS: (usize, usize) = (16, 24);

fn bin(wi: Vec3) -> usize {
    let row = (0.5 * (1.0 - wi.y) * BINS.0 as f32) as usize;
    let turn = (wi.z.atan2(wi.x) / (2.0 * PI)).rem_euclid(1.0);
    let column = (turn * BINS.1 as f32) as usize;
    row.min(BINS.0 - 1) * BINS.1 + column.min(BINS.1 - 1)
}

/// The density integrated over each bin, by midpoints.
fn expected_shares(brdf: &Brdf) -> Vec<f64> {
    const FINE: (usize, usize) = (BINS.0 * 64, BINS.1 * 48);
    let solid_angle = 4.0 * std::f64::consts::PI / (FINE.0 * FINE.1) as f64;
    let mut shares = vec![0.0; BINS.0 * BINS.1];
    for row in 0..FINE.0 {
        let cosine = 1.0 - 2.0 * (row as f32 + 0.5) / FINE.0 as f32;
        for column in 0..FINE.1 {
            let phi = 2.0 * PI * (column as f32 + 0.5) / FINE.1 as f32;
            let wi = direction(cosine.acos(), phi);
            shares[bin(wi)] += f64::from(brdf.specular_density(wi)) * solid_angle;
        }
    }
    shares
}

#[test]
fn the_lobes_density_integrates_to_one_and_samples_follow_it() {
    const SAMPLES: u32 = 200_000;
    for (roughness, theta) in [
        (0.35, 0.0),
        (0.35, 0.9),
        (0.5, 1.3),
        (0.8, 0.6),
        (1.0, 1.45),
    ] {
        let (world, surface) = floor(glossy(1.0, roughness));
        let wo = direction(theta, 0.8);
        let brdf = Brdf::new(world.scene(), &surface(&world, wo));
        let shares = expected_shares(&brdf);
        let total: f64 = shares.iter().sum();
        let what = format!("roughness {roughness}, {theta} rad");
        assert!(
            (total - 1.0).abs() < 2.0e-3,
            "{what}: the sphere has {total}"
        );
        let upper: f64 = shares[..shares.len() / 2].iter().sum();
        assert!(upper <= 1.0 + 2.0e-3, "{what}: the hemisphere has {upper}");

        let mut counts = vec![0.0; shares.len()];
        let key = RandomKey::new(11);
        for sample in 0..SAMPLES {
            counts[bin(brdf.sample_specular(key.uniform2(sample)))] += 1.0;
        }
        // Bins with few expected samples are one bin together.
        let (mut chi2, mut freedom) = (0.0, 0.0);
        let mut rest = (0.0, 0.0);
        for (count, share) in counts.iter().zip(&shares) {
            let expected: f64 = share * f64::from(SAMPLES);
            if expected < 20.0 {
                rest = (rest.0 + count, rest.1 + expected);
            } else {
                chi2 += (count - expected).powi(2) / expected;
                freedom += 1.0;
            }
        }
        let limit = freedom + 4.5 * f64::sqrt(2.0 * freedom);
        assert!(chi2 < limit, "{what}: chi-square {chi2} of {freedom} bins");
        assert!(
            (rest.0 - rest.1).abs() < 10.0 + 4.5 * f64::sqrt(rest.1),
            "{what}: {rest:?}"
        );
    }
}

/// A panel of 2 × 1 m that faces down.
const CORNER: Vec3 = Vec3::new(-1.0, 2.0, -0.5);
const EDGES: (Vec3, Vec3) = (Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.0));

/// The panel as a mesh of 2 · n² triangles; as a rectangle for 0.
fn panel(n: u32) -> AreaShape {
    let (u, v) = EDGES;
    if n == 0 {
        return AreaShape::Rectangle {
            corner: CORNER,
            edge_u: u,
            edge_v: v,
        };
    }
    let at = |i: u32, j: u32| CORNER + i as f32 / n as f32 * u + j as f32 / n as f32 * v;
    let triangles = (0..n * n).flat_map(|index| {
        let (i, j) = (index % n, index / n);
        [
            [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
            [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
        ]
    });
    AreaShape::Mesh {
        triangles: triangles.collect(),
    }
}

/// What a surface reflects of the panel with radiance 1: midpoints over its area.
fn by_quadrature(brdf: &Brdf, surface: &Surface) -> f64 {
    const STEPS: u32 = 1200;
    let step = |index: u32| (index as f32 + 0.5) / STEPS as f32;
    let mut sum = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            let at = CORNER + step(i) * EDGES.0 + step(j) * EDGES.1;
            let to_light = at - surface.position;
            let wi = to_light.normalize();
            let differential = wi.y / to_light.length_squared();
            sum += f64::from(brdf.times_cosine(wi).x * differential);
        }
    }
    sum * f64::from(EDGES.0.cross(EDGES.1).length()) / f64::from(STEPS * STEPS)
}

#[test]
fn smooth_surfaces_reflect_area_lights_without_bias() {
    // Looking at the panel's reflection, at its rim, and past it.
    let views = [
        (Vec3::new(0.3, 2.0, -2.0), Vec3::new(0.1, 0.0, -0.9)),
        (Vec3::new(3.2, 2.0, 0.1), Vec3::new(2.1, 0.0, 0.05)),
        (Vec3::new(0.0, 4.0, 6.0), Vec3::new(0.0, 0.0, 3.0)),
    ];
    for (metallic, roughness) in [
        (1.0, 0.1),
        (0.0, 0.1),
        (1.0, 0.3),
        (0.0, 0.3),
        (1.0, 0.49),
        (1.0, 0.6),
    ] {
        // 72 triangles are too many to follow the lobe to: area samples alone.
        for n in [0, 1, 6] {
            if n == 6 && roughness < 0.3 {
                continue;
            }
            let material = glossy(metallic, roughness);
            let world = Stage::default()
                .floor(material)
                .area_light(panel(n), Vec3::ONE)
                .world();
            for (eye, target) in views {
                let surface = world.first_surface(&Ray::new(eye, target - eye)).unwrap();
                let expected = by_quadrature(&Brdf::new(world.scene(), &surface), &surface);
                let found = Estimate::of(32, |seed| seen(&world, eye, target, 1024, seed).x);
                let what = format!("metallic {metallic}, roughness {roughness}, mesh {n}, {eye}");
                found.check(expected, &what);
            }
        }
    }
}

#[test]
fn a_square_of_random_numbers_fills_the_lobe() {
    // The corners of the square are valid numbers too.
    let (world, surface) = floor(glossy(1.0, 0.4));
    for theta in [0.0, 0.7, 1.55] {
        let brdf = Brdf::new(world.scene(), &surface(&world, direction(theta, 0.3)));
        for square in [
            (0.0, 0.0),
            (0.0, 0.999_999_9),
            (0.999_999_9, 0.0),
            (0.5, 0.25),
        ] {
            let wi = brdf.sample_specular(Vec2::from(square));
            assert!(wi.is_normalized(), "{theta} {square:?}: {wi}");
            assert!(brdf.specular_density(wi).is_finite());
        }
    }
}
