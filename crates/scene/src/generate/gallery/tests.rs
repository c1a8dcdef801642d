use super::*;
use crate::{LightKind, Scene};
use lie_geom::Ray;

fn scene() -> Scene {
    crate::generate::gallery(&Gallery::default())
}

/// Distance to the nearest triangle along a ray, by brute force.
fn nearest(scene: &Scene, ray: &Ray) -> Option<f32> {
    (0..scene.geometry.len() as u32)
        .filter_map(|index| scene.geometry.triangle(index).intersect(ray))
        .map(|hit| hit.t)
        .reduce(f32::min)
}

#[test]
fn it_is_as_large_and_as_bright_as_promised() {
    let scene = scene();
    scene.validate().unwrap();
    assert!(
        (60_000..150_000).contains(&scene.geometry.len()),
        "{}",
        scene.geometry.len()
    );
    assert!(
        (40..=65).contains(&scene.lights.len()),
        "{} lights",
        scene.lights.len()
    );
    assert!(scene.cameras.len() >= 3);
    let walk = &scene.walkthroughs[0];
    assert!((18.0..24.0).contains(&walk.duration_s()));
    let count = |is: fn(&LightKind) -> bool| scene.lights.iter().filter(|l| is(&l.kind)).count();
    assert!(count(|kind| matches!(kind, LightKind::Point { .. })) >= 8);
    assert!(count(|kind| matches!(kind, LightKind::Spot { .. })) >= 20);
    assert!(count(|kind| matches!(kind, LightKind::Area(_))) >= 8);
}

#[test]
fn it_is_the_same_every_time_and_any_detail_is_valid() {
    assert_eq!(scene(), scene());
    for (seed, detail) in [(7, 0.0), (u64::MAX, 0.3), (0, f32::NAN), (3, 1.7)] {
        crate::generate::gallery(&Gallery { seed, detail })
            .validate()
            .unwrap();
    }
}

#[test]
fn no_lamp_touches_anything() {
    let scene = scene();
    for light in &scene.lights {
        let (LightKind::Point { position, .. } | LightKind::Spot { position, .. }) = &light.kind
        else {
            continue;
        };
        for axis in [
            Vec3::X,
            Vec3::Y,
            Vec3::Z,
            Vec3::ONE,
            Vec3::new(1.0, -1.0, 0.5),
        ] {
            for direction in [axis.normalize(), -axis.normalize()] {
                let ray = Ray::new(*position, direction);
                let distance = nearest(&scene, &ray).unwrap_or(f32::INFINITY);
                assert!(
                    distance > 0.012,
                    "'{}' is {distance} m from a surface",
                    light.name
                );
            }
        }
    }
}

#[test]
fn the_tour_walks_at_a_human_pace_and_not_through_walls() {
    let scene = scene();
    let walk = &scene.walkthroughs[0];
    let step_s = 0.2;
    let steps = (walk.duration_s() / step_s) as u32;
    let mut length = 0.0;
    for step in 0..steps {
        let from = walk.camera_at(step as f32 * step_s).eye;
        let to = walk.camera_at((step + 1) as f32 * step_s).eye;
        let way = to - from;
        length += way.length();
        assert!(way.length() / step_s < 3.0, "{} m/s", way.length() / step_s);
        for direction in [way, Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
            let Some(direction) = direction.try_normalize() else {
                continue;
            };
            let distance = nearest(&scene, &Ray::new(from, direction)).unwrap_or(0.0);
            assert!(
                distance > 0.3,
                "{distance} m to a wall at {from}, {:.2} s",
                step as f32 * step_s
            );
        }
    }
    assert!((25.0..45.0).contains(&length), "{length} m");
}
