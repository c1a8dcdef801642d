//! What construction calls certain is so, and pictures that rest on it are the standard's.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::Arc;

use glam::{UVec2, Vec3};
use lie_farm::{Builder, ConstructSettings, LieReplica, View};
use lie_geom::{Aabb, RandomKey, Ray};
use lie_octree::{Lie, Proof};
use lie_render::{FrameSettings, World, render_frame};
use lie_scene::{Bar, Gallery, Light, LightKind, Mosque, bar, gallery, mosque};

const SIZE: UVec2 = UVec2::new(96, 64);

fn worlds() -> Vec<Arc<World>> {
    let mosque = mosque(&Mosque {
        detail: 0.2,
        ..Mosque::default()
    });
    let bar = bar(&Bar {
        detail: 0.2,
        ..Bar::default()
    });
    let mut gallery = gallery(&Gallery {
        detail: 0.2,
        ..Gallery::default()
    });
    gallery.lights.push(Light {
        name: "sun".to_owned(),
        kind: LightKind::Directional {
            direction: Vec3::new(0.3, -0.9, 0.2).normalize(),
            irradiance: Vec3::ONE,
        },
    });
    [mosque, bar, gallery]
        .map(|scene| Arc::new(World::new(Arc::new(scene))))
        .into()
}

/// Whether no light has an extent.
fn has_points_alone(world: &World) -> bool {
    world.scene().lights.iter().all(|light| light.is_delta())
}

fn view(world: &World) -> View {
    View {
        camera: world.scene().cameras[0].clone(),
        size: SIZE,
    }
}

/// LIEs of a pass over the view. No number of samples is enough to be trusted.
fn construct(world: &Arc<World>, threads: usize, proofs: bool) -> Builder {
    let mut settings = ConstructSettings::new(world.scene());
    settings.lie.trust = u32::MAX;
    settings.lie.split_samples = 16;
    settings.threads = threads;
    settings.proofs = proofs;
    let mut builder = Builder::new(world.clone(), settings).unwrap();
    let samples = u64::from(SIZE.x * SIZE.y);
    builder.sample(&[view(world)], samples, |_| {});
    builder
}

/// The cells that the camera sees.
fn cells(builder: &Builder, world: &World) -> Vec<Lie> {
    let view = view(world);
    let mut keys = vec![];
    for y in 0..SIZE.y {
        for x in 0..SIZE.x {
            let film = UVec2::new(x, y).as_vec2() + 0.5;
            if let Some(surface) = world.first_surface(&view.camera.ray(film, SIZE)) {
                let lie = builder.tree().lie_at(surface.shadow_origin);
                keys.push((builder.tree().key_at(surface.shadow_origin), lie));
            }
        }
    }
    keys.sort_by_key(|(key, _)| *key);
    keys.dedup_by_key(|(key, _)| *key);
    keys.into_iter().map(|(_, lie)| lie).collect()
}

fn place_in(bounds: Aabb, key: RandomKey, n: u32) -> Vec3 {
    let xy = key.uniform2(2 * n);
    // Its corners and faces too.
    let share = 1.4 * Vec3::new(xy.x, xy.y, key.uniform(2 * n + 1)) - 0.2;
    let place = bounds.min + share.clamp(Vec3::ZERO, Vec3::ONE) * bounds.size();
    place.clamp(bounds.min, bounds.max)
}

#[test]
fn what_is_certain_holds_everywhere_in_a_region() {
    for world in worlds() {
        let builder = construct(&world, 0, true);
        let mut seen = [0; 4];
        for (number, lie) in (0..).zip(cells(&builder, &world)) {
            let region = lie.region();
            for (light, proof) in region.lights() {
                let light_form = &world.scene().lights[light as usize];
                let key = RandomKey::new(number).mix(u64::from(light));
                for n in 0..6 {
                    let place = place_in(region.bounds, key, n);
                    let square = key.mix(1).uniform2(n);
                    let Some(sample) = light_form.sample(place, square, world.reach()) else {
                        continue;
                    };
                    let ray = match light_form.kind {
                        LightKind::Point { .. } | LightKind::Spot { .. } => {
                            Ray::segment_from(sample.target, place)
                        }
                        _ => Ray::segment(place, sample.target),
                    };
                    let blocked = world.accel().is_blocked(&ray);
                    let expected = match proof {
                        Proof::Unoccluded => false,
                        Proof::Hidden => true,
                        Proof::Behind(list) => list.iter().any(|triangle| {
                            world.triangle(triangle).unwrap().intersect(&ray).is_some()
                        }),
                        Proof::Open => continue,
                    };
                    assert_eq!(blocked, expected, "light {light}, {proof:?}, {ray:?}");
                }
                seen[match proof {
                    Proof::Unoccluded => 0,
                    Proof::Hidden => 1,
                    Proof::Behind(_) => 2,
                    Proof::Open => 3,
                }] += 1;
            }
        }
        let [clear, hidden, behind, open] = seen;
        assert!(clear > 100 && behind > 100, "{seen:?}");
        // Lights that have an extent are settled where they reach, or not at all.
        assert!(hidden > 100 || !has_points_alone(&world), "{seen:?}");
        assert!(open < clear + hidden + behind, "{seen:?}");
    }
}

#[test]
fn a_picture_that_rests_on_proofs_is_the_standards() {
    for world in worlds() {
        let builder = construct(&world, 0, true);
        let lies = LieReplica::of(world.clone(), builder.tree()).publish();
        let settings = FrameSettings {
            size: SIZE,
            samples_per_pixel: 1,
            ..FrameSettings::new(&world.scene().settings)
        };
        let camera = view(&world).camera;
        let (standard, all) = render_frame(&world, None, &camera, &settings, &mut |_| {});
        let (picture, left) = render_frame(&world, Some(&lies), &camera, &settings, &mut |_| {});
        for (found, expected) in picture.radiance().iter().zip(standard.radiance()) {
            // Lights add up in another order.
            let room = 1.0e-5 * expected.max_element().max(1.0e-3);
            assert!(found.abs_diff_eq(*expected, room), "{found} {expected}");
        }
        let part = if has_points_alone(&world) { 0.5 } else { 0.95 };
        assert!(
            (left.shadow_rays as f64) < part * all.shadow_rays as f64,
            "{} rays of {} are left",
            left.shadow_rays,
            all.shadow_rays
        );
    }
}

#[test]
fn without_proofs_nothing_is_certain() {
    let world = worlds().remove(0);
    let builder = construct(&world, 0, false);
    let cells = cells(&builder, &world);
    assert!(cells.iter().all(|lie| lie.region().is_empty()));
}

#[test]
fn threads_change_nothing() {
    let world = worlds().remove(0);
    let [one, two] = [1, 2].map(|threads| construct(&world, threads, true));
    let keys = one.tree().keys();
    assert_eq!(keys, two.tree().keys());
    one.tree().validate().unwrap();
    for key in keys {
        assert_eq!(one.tree().state(key), two.tree().state(key));
    }
}
