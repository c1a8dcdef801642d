use glam::{UVec2, Vec2};
use lie_geom::Ray;

use super::*;
use crate::{LightKind, Scene};

fn scene() -> Scene {
    crate::generate::bar(&Bar::default())
}

/// The nearest triangle along a ray and its distance, by brute force.
fn nearest(scene: &Scene, ray: &Ray) -> Option<(u32, f32)> {
    let hit = |index| Some((index, scene.geometry.triangle(index).intersect(ray)?.t));
    let hits = (0..scene.geometry.len() as u32).filter_map(hit);
    hits.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The first triangle whose bounds come into a box.
fn in_the_way(scene: &Scene, min: Vec3, max: Vec3) -> Option<u32> {
    (0..scene.geometry.len() as u32).find(|&index| {
        let bounds = scene.geometry.triangle(index).bounds();
        bounds.min.cmplt(max).all() && bounds.max.cmpgt(min).all()
    })
}

/// How many spots' cones contain a point of a surface that faces them.
fn candidates(scene: &Scene, point: Vec3, normal: Vec3) -> usize {
    let is_candidate = |kind: &LightKind| match kind {
        LightKind::Spot {
            position,
            direction,
            cos_outer,
            ..
        } => {
            let way = (point - position).normalize_or_zero();
            way.dot(*direction) > *cos_outer && way.dot(normal) < 0.0
        }
        _ => false,
    };
    let lights = scene.lights.iter();
    lights.filter(|light| is_candidate(&light.kind)).count()
}

#[test]
fn it_is_as_large_and_as_bright_as_promised() {
    let scene = scene();
    scene.validate().unwrap();
    let count = scene.geometry.len();
    assert!((225_000..=255_000).contains(&count), "{count} triangles");
    assert_eq!(scene.lights.len(), 70);
    for light in &scene.lights {
        let LightKind::Spot {
            cos_inner,
            cos_outer,
            ..
        } = light.kind
        else {
            panic!("'{}' is no spot", light.name);
        };
        assert!(
            cos_inner > cos_outer + 0.03,
            "'{}' has a hard edge",
            light.name
        );
    }
    assert_eq!(scene.cameras.len(), 3);
    assert!(scene.walkthroughs[0].duration_s() >= 20.0);
}

#[test]
fn no_triangle_is_degenerate() {
    let scene = scene();
    for index in 0..scene.geometry.len() as u32 {
        let triangle = scene.geometry.triangle(index);
        assert!(triangle.area() > 1.0e-10, "{index}: {triangle:?}");
    }
}

#[test]
fn it_is_the_same_every_time_and_any_detail_is_valid() {
    assert_eq!(scene(), scene());
    for (seed, detail) in [(7, 0.0), (u64::MAX, 0.3), (0, f32::NAN), (3, 1.7)] {
        let bar = crate::generate::bar(&Bar { seed, detail });
        bar.validate().unwrap();
        assert_eq!(bar.lights.len(), 70);
    }
}

#[test]
fn many_cones_overlap_where_one_looks() {
    let scene = scene();
    let mut counts = vec![];
    let size = UVec2::new(8, 5);
    for camera in &scene.cameras {
        for index in 0..size.x * size.y {
            let film = UVec2::new(index % size.x, index / size.x).as_vec2() + Vec2::splat(0.5);
            let ray = camera.ray(film, size);
            let (index, t) = nearest(&scene, &ray).expect("the room is closed");
            let normal = scene.geometry.triangle(index).normal;
            let towards = if normal.dot(ray.direction) > 0.0 {
                -normal
            } else {
                normal
            };
            counts.push(candidates(&scene, ray.at(t), towards));
        }
    }
    counts.sort_unstable();
    let median = counts[counts.len() / 2];
    assert!((12..=20).contains(&median), "{median} spots for a point");
}

#[test]
fn no_light_touches_anything_and_every_camera_stands_free() {
    let scene = scene();
    let check = |name: &str, place: Vec3, radius: f32| {
        let is_near = |index: u32| {
            let triangle = scene.geometry.triangle(index);
            let bounds = triangle.bounds();
            bounds.min.cmplt(place + radius).all()
                && bounds.max.cmpgt(place - radius).all()
                && (place - triangle.a).dot(triangle.normal).abs() < radius
        };
        let hit = (0..scene.geometry.len() as u32).find(|&index| is_near(index));
        assert_eq!(hit, None, "'{name}' is within {radius} m of a triangle");
    };
    for light in &scene.lights {
        if let LightKind::Spot { position, .. } = light.kind {
            check(&light.name, position, 0.015);
        }
    }
    for camera in &scene.cameras {
        check(&camera.name, camera.eye, 0.2);
    }
}

#[test]
fn the_tour_walks_at_a_human_pace_and_not_through_things() {
    let scene = scene();
    let walk = &scene.walkthroughs[0];
    let step_s = 0.1;
    let steps = (walk.duration_s() / step_s) as u32;
    let mut length = 0.0;
    for step in 0..steps {
        let time_s = step as f32 * step_s;
        let eye = walk.camera_at(time_s).eye;
        let way = walk.camera_at(time_s + step_s).eye - eye;
        length += way.length();
        let speed = way.length() / step_s;
        assert!(speed <= 1.5, "{speed} m/s at {time_s} s");
        // The guest's body too: from the ankles up, and as wide as shoulders.
        let (feet, head) = (eye.with_y(0.15), eye.with_y(eye.y + 0.15));
        let wide = Vec3::new(0.22, 0.0, 0.22);
        let hit = in_the_way(&scene, feet - wide, head + wide);
        assert_eq!(hit, None, "at {eye}, {time_s} s");
    }
    assert!((22.0..32.0).contains(&length), "{length} m");
}
