//! Lights without extent over a Lambertian floor.

use std::f32::consts::PI;

use glam::Vec3;
use lie_scene::{LightKind, Material};

use crate::stage::{Stage, seen_exactly};

const ALBEDO: Vec3 = Vec3::new(0.2, 0.5, 0.8);
const INTENSITY: Vec3 = Vec3::new(5.0, 7.0, 11.0);
const EYE: Vec3 = Vec3::new(1.0, 6.0, 4.0);

fn assert_close(found: Vec3, expected: Vec3, what: &str) {
    let close = (found - expected).abs().cmple(1.0e-4 * expected.abs());
    assert!(close.all(), "{what}: {found}, expected {expected}");
}

/// What a Lambertian floor reflects of a point light: albedo/π · I · cos θ / r².
fn from_point(light: Vec3, point: Vec3) -> Vec3 {
    let to_light = light - point;
    let cosine = to_light.normalize().y.max(0.0);
    ALBEDO / PI * INTENSITY * cosine / to_light.length_squared()
}

#[test]
fn a_point_light_falls_with_the_square_and_the_cosine() {
    let position = Vec3::new(0.3, 2.0, 0.1);
    let world = Stage::default()
        .floor(Material::diffuse("floor", ALBEDO))
        .light(LightKind::Point {
            position,
            radiant_intensity: INTENSITY,
        })
        .world();
    for (x, z) in [(0.3, 0.1), (0.0, 0.0), (1.0, 1.0), (-3.0, 2.0), (8.0, -7.0)] {
        let point = Vec3::new(x, 0.0, z);
        let found = seen_exactly(&world, EYE, point);
        assert_close(found, from_point(position, point), &format!("at {point}"));
    }
}

#[test]
fn lights_add_up_and_those_below_the_floor_give_nothing() {
    let positions = [
        Vec3::new(0.3, 2.0, 0.1),
        Vec3::new(-1.0, 1.0, 0.0),
        Vec3::new(0.0, -1.0, 0.0),
    ];
    let mut stage = Stage::default().floor(Material::diffuse("floor", ALBEDO));
    for position in positions {
        stage = stage.light(LightKind::Point {
            position,
            radiant_intensity: INTENSITY,
        });
    }
    let point = Vec3::new(0.5, 0.0, 0.5);
    let expected = from_point(positions[0], point) + from_point(positions[1], point);
    assert_close(seen_exactly(&stage.world(), EYE, point), expected, "sum");
}

#[test]
fn directional_light_is_the_same_everywhere() {
    let direction = Vec3::new(1.0, -2.0, 0.5).normalize();
    let world = Stage::default()
        .floor(Material::diffuse("floor", ALBEDO))
        .light(LightKind::Directional {
            direction,
            irradiance: INTENSITY,
        })
        .world();
    for (x, z) in [(0.0, 0.0), (5.0, 3.0), (-9.0, 2.0)] {
        let found = seen_exactly(&world, EYE, Vec3::new(x, 0.0, z));
        assert_close(found, ALBEDO / PI * INTENSITY * -direction.y, "directional");
    }
}

/// A spot over the floor, and the point on it that the spot sees at an angle off its axis.
struct Spot {
    position: Vec3,
    inner: f32,
    outer: f32,
}

impl Spot {
    fn world(&self) -> lie_render::World {
        Stage::default()
            .floor(Material::diffuse("floor", ALBEDO))
            .light(LightKind::Spot {
                position: self.position,
                direction: Vec3::NEG_Y,
                radiant_intensity: INTENSITY,
                cos_inner: self.inner.cos(),
                cos_outer: self.outer.cos(),
            })
            .world()
    }

    fn point(&self, angle: f32) -> Vec3 {
        let foot = Vec3::new(self.position.x, 0.0, self.position.z);
        foot + self.position.y * angle.tan() * Vec3::new(0.6, 0.0, 0.8)
    }
}

#[test]
fn a_spot_is_a_point_inside_nothing_outside_and_a_squared_ramp_between() {
    let spot = Spot {
        position: Vec3::new(0.2, 3.0, -0.4),
        inner: 0.3,
        outer: 0.5,
    };
    let world = spot.world();
    for (angle, ramp) in [
        (0.0, Some(1.0)),
        (0.15, Some(1.0)),
        (0.295, Some(1.0)),
        (0.35, None),
        (0.4, None),
        (0.45, None),
        (0.505, Some(0.0)),
        (1.0, Some(0.0)),
    ] {
        let (inner, outer) = (spot.inner.cos(), spot.outer.cos());
        let between = (f32::cos(angle) - outer) / (inner - outer);
        let falloff = ramp.unwrap_or(between * between);
        let point = spot.point(angle);
        let found = seen_exactly(&world, EYE, point);
        // Cosines of single precision, on a ramp of a tenth: one digit less.
        let expected = falloff * from_point(spot.position, point);
        let close = (found - expected).abs().cmple(2.0e-4 * expected);
        assert!(close.all(), "{angle} rad: {found}, expected {expected}");
    }
}

#[test]
fn the_spots_edge_is_at_its_outer_angle() {
    for (inner, outer) in [(0.2, 0.6), (0.599, 0.6), (0.6, 0.6), (0.0, 1.2)] {
        let spot = Spot {
            position: Vec3::new(0.0, 2.0, 0.0),
            inner,
            outer,
        };
        let world = spot.world();
        let is_lit = |angle| seen_exactly(&world, EYE, spot.point(angle)) != Vec3::ZERO;
        let (mut lit, mut dark) = (0.0, 1.4);
        assert!(is_lit(lit) && !is_lit(dark));
        while dark - lit > 1.0e-5 {
            let middle = 0.5 * (lit + dark);
            *(if is_lit(middle) { &mut lit } else { &mut dark }) = middle;
        }
        // A cosine near 1 of single precision tells angles apart to 1e-7 / sin(angle).
        assert!(
            (lit - outer).abs() < 2.0e-5,
            "{inner}..{outer}: edge at {lit}"
        );
    }
}
