use super::*;
use crate::{
    LightKind, Scene,
    generate::probes::{Probe, assert_faces_are_sound},
};
use lie_geom::Ray;

/// Coarse, so that brute force takes no time; what stands where does not depend on it.
fn scene() -> Scene {
    with(1, 0.1)
}

fn with(seed: u64, detail: f32) -> Scene {
    crate::generate::mosque(&Mosque { seed, detail })
}

#[test]
fn it_is_as_large_as_promised() {
    let triangles = with(1, 1.0).geometry.len();
    assert!((950_000..1_000_000).contains(&triangles), "{triangles}");
}

#[test]
fn ten_bright_lights_hang_in_the_nave_and_ninety_dim_ones_beside_it() {
    let scene = scene();
    scene.validate().unwrap();
    let probe = Probe::new(&scene);
    let (mut bright, mut dim) = (0, 0);
    for light in &scene.lights {
        let LightKind::Point {
            position,
            radiant_intensity,
        } = light.kind
        else {
            panic!("'{}' is no point", light.name);
        };
        if position.x.abs() < NAVE_HALF {
            bright += 1;
            assert!(radiant_intensity.x > 20.0);
        } else {
            dim += 1;
            assert!(radiant_intensity.x < 10.0);
        }
        // It hangs free: nothing is near, and to the floor there is nothing at all.
        let down = probe.nearest(&Ray::new(position, Vec3::NEG_Y));
        assert_eq!(down, Some(position.y), "below '{}'", light.name);
        assert!(probe.clearance(position) > 0.2, "about '{}'", light.name);
    }
    assert_eq!((bright, dim), (10, 90));
}

#[test]
fn it_is_the_same_every_time_and_any_detail_is_valid() {
    assert_eq!(scene(), scene());
    assert_ne!(with(2, 0.1).geometry, scene().geometry);
    for (seed, detail) in [(7, 0.0), (u64::MAX, 0.2), (0, f32::NAN)] {
        with(seed, detail).validate().unwrap();
    }
    assert!(with(1, 0.3).geometry.len() > scene().geometry.len());
}

#[test]
fn all_faces_are_sound() {
    assert_faces_are_sound(&with(1, 0.5));
}

#[test]
fn cameras_stand_free_and_see_no_void() {
    let scene = scene();
    assert!(scene.cameras.len() >= 3);
    let probe = Probe::new(&scene);
    for camera in &scene.cameras {
        probe.assert_sees_no_void(camera);
    }
}

#[test]
fn the_tour_walks_at_a_human_pace_and_through_nothing() {
    let scene = scene();
    let probe = Probe::new(&scene);
    let walk = &scene.walkthroughs[0];
    assert!(walk.duration_s() >= 20.0);
    let step_s = 0.25;
    for step in 0..(walk.duration_s() / step_s) as u32 {
        let [from, to] = [step, step + 1].map(|step| walk.camera_at(step as f32 * step_s).eye);
        let pace = (to - from).length() / step_s;
        assert!(pace <= 1.5, "{pace} m/s at {from}");
        let free = probe.clearance(from);
        assert!(free > 0.4, "{free} m free at {from}");
    }
}
