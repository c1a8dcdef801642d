//! What is seen directly.

use glam::Vec3;
use lie_scene::Material;

use crate::stage::{Stage, seen_exactly};

const RADIANCE: Vec3 = Vec3::new(1.5, 0.25, 40.0);

fn shining(double_sided: bool) -> Material {
    Material {
        emission: RADIANCE,
        double_sided,
        ..Material::default()
    }
}

#[test]
fn emission_is_seen_as_it_is_from_its_front_or_both_sides() {
    let (above, below) = (Vec3::new(0.5, 3.0, 1.0), Vec3::new(0.5, -3.0, 1.0));
    for (double_sided, eye, expected) in [
        (false, above, RADIANCE),
        (false, below, Vec3::ZERO),
        (true, above, RADIANCE),
        (true, below, RADIANCE),
    ] {
        let world = Stage::default().floor(shining(double_sided)).world();
        let found = seen_exactly(&world, eye, Vec3::new(0.3, 0.0, 0.2));
        assert_eq!(found, expected, "double-sided {double_sided}, from {eye}");
    }
}

#[test]
fn the_background_is_seen_where_nothing_else_is_and_lights_nothing() {
    let mut stage = Stage::default().floor(Material::default());
    stage.background.radiance = RADIANCE;
    let world = stage.world();
    let eye = Vec3::new(0.0, 2.0, 0.0);
    assert_eq!(seen_exactly(&world, eye, eye + Vec3::X), RADIANCE);
    assert_eq!(
        seen_exactly(&world, eye, Vec3::new(1.0, 0.0, 0.0)),
        Vec3::ZERO
    );
}

#[test]
fn a_scene_of_nothing_is_its_background() {
    let mut stage = Stage::default();
    stage.background.radiance = RADIANCE;
    assert_eq!(seen_exactly(&stage.world(), Vec3::ZERO, Vec3::X), RADIANCE);
}
