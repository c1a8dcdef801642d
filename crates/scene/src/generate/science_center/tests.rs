use super::*;
use crate::{
    AreaShape, LightKind, Scene,
    generate::probes::{Probe, assert_faces_are_sound},
};
use glam::{UVec2, Vec2};
use lie_geom::Ray;

fn scene() -> Scene {
    crate::generate::science_center(&ScienceCenter::default())
}

#[test]
fn it_is_as_small_as_promised_and_has_one_light() {
    let scene = scene();
    scene.validate().unwrap();
    let triangles = scene.geometry.len();
    assert!((6_500..8_000).contains(&triangles), "{triangles}");
    assert_eq!(scene.lights.len(), 1);
    let LightKind::Area(light) = &scene.lights[0].kind else {
        panic!("the light is the skylight");
    };
    assert!(matches!(light.shape(), AreaShape::Rectangle { .. }));
    assert!((60.0..100.0).contains(&light.area()), "{} m²", light.area());
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

/// What is in the way to the light from there, at 256 of its points: each triangle, once.
fn occluders(scene: &Scene, from: Vec3) -> (usize, Vec<u32>) {
    let LightKind::Area(light) = &scene.lights[0].kind else {
        panic!("the light is the skylight");
    };
    let AreaShape::Rectangle {
        corner,
        edge_u,
        edge_v,
    } = *light.shape()
    else {
        panic!("it is flat");
    };
    let (mut blocked, mut all) = (0, vec![]);
    for sample in 0..256u32 {
        let [u, v] = [sample % 16, sample / 16].map(|place| (place as f32 + 0.5) / 16.0);
        let ray = Ray::segment(from, corner + u * edge_u + v * edge_v);
        let hits = |index: &u32| scene.geometry.triangle(*index).intersect(&ray).is_some();
        let own: Vec<u32> = (0..scene.geometry.len() as u32).filter(hits).collect();
        blocked += usize::from(!own.is_empty());
        all.extend(own);
    }
    all.sort_unstable();
    all.dedup();
    (blocked, all)
}

#[test]
fn little_is_between_the_light_and_where_one_looks() {
    let scene = scene();
    let probe = Probe::new(&scene);
    let [mut points, mut clear, mut sum] = [0; 3];
    for camera in &scene.cameras {
        for place in 0..24 {
            let film = Vec2::new((place % 6) as f32 + 0.5, (place / 6) as f32 + 0.5);
            let ray = camera.ray(film, UVec2::new(6, 4));
            let hit = probe.nearest(&ray).expect("the house is closed");
            let (blocked, occluders) = occluders(&scene, ray.at(hit - 1.0e-3));
            // Where there is no light at all it doesn't matter how much is in the way.
            if blocked < 256 {
                points += 1;
                clear += usize::from(blocked == 0);
                sum += occluders.len();
            }
        }
    }
    assert!(
        2 * clear > points,
        "{clear} of {points} points see all of it"
    );
    assert!(sum < 12 * points, "{sum} occluders of {points} points");
}
