//! White furnaces: everywhere radiance 1.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use lie_render::World;
use lie_scene::{AreaShape, Material};

use crate::stage::{Estimate, Stage, seen};

/// The inside of a box, as triangles that face inwards.
fn shell(half: f32) -> Vec<[Vec3; 3]> {
    let mut triangles = vec![];
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let pick = |offset: usize| Vec3::AXES[(axis + offset) % 3] * half;
            let (normal, u, v) = (pick(0) * side, pick(1), pick(2) * side);
            // u × v points out along `normal`: the other way round it points in.
            let [a, b, c, d] = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
                .map(|(s, t)| normal + s * u + t * v);
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

/// The eight faces of an octahedron.
fn octahedron(radius: f32) -> Vec<[Vec3; 3]> {
    let signs = [-1.0, 1.0];
    let mut triangles = vec![];
    for x in signs {
        for y in signs {
            for z in signs {
                let [a, b, c] =
                    [x * Vec3::X, y * Vec3::Y, z * Vec3::Z].map(|corner| corner * radius);
                triangles.push(if x * y * z > 0.0 {
                    [a, b, c]
                } else {
                    [a, c, b]
                });
            }
        }
    }
    triangles
}

/// `body` of one material inside a box that shines with radiance 1 and reflects nothing.
fn furnace(material: Material, body: &[[Vec3; 3]]) -> World {
    let shining = Material {
        emission: Vec3::ONE,
        ..Material::diffuse("shell", Vec3::ZERO)
    };
    let shell = shell(1.5);
    Stage::default()
        .triangles(shining, &shell)
        .triangles(material, body)
        .area_light(AreaShape::Mesh { triangles: shell }, Vec3::ONE)
        .world()
}

#[test]
fn white_lambert_vanishes_in_a_furnace() {
    let world = furnace(Material::diffuse("body", Vec3::ONE), &octahedron(0.4));
    for target in [
        Vec3::new(0.1, 0.1, 0.1),
        Vec3::new(-0.05, 0.1, 0.15),
        Vec3::new(0.02, -0.2, 0.03),
    ] {
        let eye = Vec3::new(0.9, 0.5, 1.2) * target.signum();
        let found = Estimate::of(32, |seed| seen(&world, eye, target, 576, seed).x);
        found.check(1.0, &format!("towards {target}"));
        assert!(found.error < 0.01, "{found:?}");
    }
}

#[test]
fn the_shell_is_seen_as_it_is() {
    let world = furnace(Material::diffuse("body", Vec3::ONE), &octahedron(0.4));
    let found = seen(
        &world,
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(1.2, 1.0, 0.3),
        16,
        0,
    );
    assert_eq!(found, Vec3::ONE);
}

/// What a surface of GGX microfacets that reflect everything gives back in a furnace after
/// one reflection: the rest would be reflected again by other microfacets, which the model
/// leaves out. By quadrature over the microfacets' normals, in double precision.
fn single_scattering(alpha: f64, cos_o: f64) -> f64 {
    const STEPS: u32 = 600;
    let wo = DVec3::new((1.0 - cos_o * cos_o).sqrt(), 0.0, cos_o);
    let lambda = |cosine: f64| {
        let tan2 = 1.0 / (cosine * cosine) - 1.0;
        0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
    };
    let mut sum = 0.0;
    for i in 0..STEPS {
        // Slope distribution inverted: u is uniform under D cos θ.
        let u = (f64::from(i) + 0.5) / f64::from(STEPS);
        let tan2 = alpha * alpha * u / (1.0 - u);
        let cos_h = 1.0 / (1.0 + tan2).sqrt();
        let sin_h = (1.0 - cos_h * cos_h).max(0.0).sqrt();
        for j in 0..STEPS {
            let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(STEPS);
            let half = DVec3::new(sin_h * phi.cos(), sin_h * phi.sin(), cos_h);
            let wi = 2.0 * wo.dot(half) * half - wo;
            if wo.dot(half) > 0.0 && wi.z > 0.0 {
                let masking = 1.0 / (1.0 + lambda(cos_o) + lambda(wi.z));
                sum += masking * wo.dot(half) / (cos_o * cos_h);
            }
        }
    }
    sum / f64::from(STEPS * STEPS)
}

#[test]
fn a_white_metal_loses_what_a_second_reflection_would_bring_and_no_more() {
    for roughness in [0.03f32, 0.1, 0.2, 0.35, 0.49, 0.5, 0.7, 1.0] {
        let material = Material {
            metallic: 1.0,
            roughness,
            ..Material::diffuse("metal", Vec3::ONE)
        };
        let face = [Vec3::NEG_X, Vec3::Z, Vec3::X - Vec3::Z].map(|corner| 0.2 * corner);
        let world = furnace(material, &[face]);
        for degrees in [0.0f32, 30.0, 60.0, 80.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let eye = 0.8 * Vec3::new(0.6 * sin, cos, 0.8 * sin);
            let found = Estimate::of(32, |seed| seen(&world, eye, Vec3::ZERO, 1024, seed).x);
            let alpha = f64::from(roughness * roughness).max(1.0e-3);
            let expected = single_scattering(alpha, f64::from(cos));
            let what = format!("roughness {roughness} at {degrees}°");
            assert!(
                expected <= 1.0 + 1.0e-6,
                "{what}: the reference gives {expected}"
            );
            found.check(expected, &what);
            assert!(found.error < 0.02, "{what}: {found:?}");
        }
    }
}

#[test]
fn the_loss_is_what_is_known_of_ggx() {
    // α = 1 seen from above: D is 1/π, and what is left, ∫ c/(1 + c) dc, is 1 − ln 2.
    let found = single_scattering(1.0, 1.0);
    let expected = 1.0 - std::f64::consts::LN_2;
    assert!(
        (found - expected).abs() < 1.0e-4,
        "{found}, expected {expected}"
    );
    // Smooth surfaces lose nothing.
    assert!((single_scattering(1.0e-3, 0.7) - 1.0).abs() < 1.0e-4);
}
