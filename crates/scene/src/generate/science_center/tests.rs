use super::*;
use crate::{
    LightKind, Scene,
    generate::probes::{Probe, assert_faces_are_sound},
};
use lie_geom::Ray;

fn scene() -> Scene {
    crate::generate::science_center(&ScienceCenter::default())
}

#[test]
fn it_is_as_small_as_promised_and_has_one_light() {
    let scene = scene();
    scene.validate().unwrap();
    let triangles = scene.geometry.len();
    assert!((6_000..8_000).contains(&triangles), "{triangles}");
    assert_eq!(scene.lights.len(), 1);
    assert!(matches!(&scene.lights[0].kind, LightKind::Area(area) if area.area() > 200.0));
    assert!(scene.cameras.len() >= 3);
    assert_eq!(scene.settings.light_samples, 64);
    for material in &scene.materials {
        assert!(material.specular == 0.0 && material.metallic == 0.0);
    }
    assert_faces_are_sound(&scene);
}

#[test]
fn it_is_the_same_every_time_and_any_detail_is_valid() {
    assert_eq!(scene(), scene());
    let with = |seed, detail| crate::generate::science_center(&ScienceCenter { seed, detail });
    assert_ne!(with(2, 1.0).geometry, scene().geometry);
    for (seed, detail) in [(7, 0.0), (u64::MAX, 0.3), (0, f32::NAN), (3, 4.0)] {
        with(seed, detail).validate().unwrap();
    }
    assert!(with(1, 2.0).geometry.len() > scene().geometry.len());
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
fn the_tour_walks_at_a_human_pace_on_the_floor_and_through_nothing() {
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
        assert!(free > 0.35, "{free} m free at {from}");
        let down = probe.nearest(&Ray::new(from, Vec3::NEG_Y)).unwrap();
        assert!(
            (1.4..1.95).contains(&down),
            "{down} m above the floor at {from}"
        );
    }
}
