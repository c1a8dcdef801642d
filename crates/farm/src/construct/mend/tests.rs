use std::sync::Arc;

use glam::{UVec2, Vec3};
use lie_geom::Ray;
use lie_octree::Region;
use lie_render::{Audit, FrameSettings, Tile, render_frame};
use lie_scene::{Mosque, mosque};

use super::*;
use crate::{Builder, ConstructSettings, LieReplica, PublishedLies, View};

const SIZE: UVec2 = UVec2::new(48, 32);

fn world() -> Arc<World> {
    let scene = mosque(&Mosque {
        detail: 0.2,
        ..Mosque::default()
    });
    Arc::new(World::new(Arc::new(scene)))
}

fn frame(world: &World) -> FrameSettings {
    FrameSettings {
        size: SIZE,
        samples_per_pixel: 1,
        ..FrameSettings::new(&world.scene().settings)
    }
}

/// LIEs of a pass over a camera's view.
fn construct(world: &Arc<World>, trust: u32, camera: usize) -> Builder {
    let mut settings = ConstructSettings::new(world.scene());
    settings.lie.trust = trust;
    settings.lie.split_samples = 16;
    let mut builder = Builder::new(world.clone(), settings).unwrap();
    let view = View {
        camera: world.scene().cameras[camera].clone(),
        size: SIZE,
    };
    builder.sample(&[view], 1, |_| {});
    builder
}

fn lies(world: &Arc<World>, builder: &Builder) -> PublishedLies {
    LieReplica::of(world.clone(), builder.tree()).publish()
}

fn check(world: &Arc<World>, builder: &Builder, share: f32) -> Audit {
    let tile = Tile {
        origin: UVec2::ZERO,
        size: SIZE,
    };
    let camera = &world.scene().cameras[0];
    let (lies, frame) = (lies(world, builder), frame(world));
    lie_render::audit(world, &lies, camera, &frame, tile, share, 7)
}

/// Root mean square difference from the standard's picture, by its mean.
fn error(world: &Arc<World>, builder: &Builder) -> f32 {
    let camera = &world.scene().cameras[0];
    let frame = frame(world);
    let (standard, _) = render_frame(world, None, camera, &frame, &mut |_| {});
    let lies = lies(world, builder);
    let (picture, _) = render_frame(world, Some(&lies), camera, &frame, &mut |_| {});
    let both = picture.radiance().iter().zip(standard.radiance());
    let squares: f32 = both.map(|(a, b)| (*a - *b).length_squared()).sum();
    let sum: f32 = standard.radiance().iter().map(|all| all.length()).sum();
    (squares * (SIZE.x * SIZE.y) as f32).sqrt() / sum
}

/// Says the contrary of every proof in the cells that are seen. Gives how many.
fn plant(builder: &mut Builder) -> usize {
    let mut planted = 0;
    for key in builder.tree.keys() {
        let bounds = builder.tree.cube().cell_bounds(key);
        if builder.tree.key_at(bounds.center()) != key {
            continue;
        }
        let lie = builder.tree.lie_at(bounds.center());
        let region = lie.region();
        let wrong = region.lights().map(|(light, proof)| {
            let proof = match proof {
                Proof::Hidden => Proof::Unoccluded,
                Proof::Unoccluded => Proof::Hidden,
                other => other.cloned(),
            };
            (light, proof)
        });
        let wrong = Region::new(region.bounds, wrong.collect());
        planted += wrong.len();
        builder.tree.settle(key, wrong);
    }
    planted
}

#[test]
fn planted_wrong_answers_are_found_and_mended() {
    let world = world();
    let mut builder = construct(&world, 512, 0);
    let before = check(&world, &builder, 1.0);
    assert!(before.rays > 1000, "{}", before.rays);
    assert_eq!(before.mismatches, [], "proofs and trust are right here");
    assert!(plant(&mut builder) > 100);
    assert!(error(&world, &builder) > 0.1);
    let found = check(&world, &builder, 1.0);
    assert!(found.mismatches.len() > 100, "{}", found.mismatches.len());
    assert!(builder.mend(&found.mismatches) > 10);
    assert_eq!(builder.mend(&found.mismatches), 0, "once is enough");
    builder.tree().validate().unwrap();
    assert_eq!(check(&world, &builder, 1.0).mismatches, []);
    let error = error(&world, &builder);
    assert!(error < 1.0e-5, "{error}");
}

#[test]
fn a_small_share_finds_them_in_time() {
    let world = world();
    let mut builder = construct(&world, 512, 0);
    plant(&mut builder);
    let first = check(&world, &builder, 0.02);
    let pixels = (SIZE.x * SIZE.y) as f32;
    let lights = world.scene().lights.len() as f32;
    assert!(
        first.rays as f32 <= 0.04 * pixels * lights,
        "{}",
        first.rays
    );
    assert!(!first.mismatches.is_empty());
    builder.mend(&first.mismatches);
    // What one audit has found in a cell is right in all of it.
    let rate = |audit: &Audit| audit.mismatches.len() as f32 / audit.rays as f32;
    let second = check(&world, &builder, 0.02);
    assert!(rate(&second) < 0.1 * rate(&first));
}

#[test]
fn the_papers_mode_gets_better_by_audits_alone() {
    let world = world();
    let mut builder = construct(&world, 0, 1);
    let mut rates = vec![];
    let mut errors = vec![error(&world, &builder)];
    for _ in 0..3 {
        let found = check(&world, &builder, 1.0);
        rates.push(found.mismatches.len() as f32 / found.rays as f32);
        builder.mend(&found.mismatches);
        errors.push(error(&world, &builder));
    }
    assert!(rates[0] > 0.001, "there is something to mend: {rates:?}");
    assert!(rates[2] < 0.2 * rates[0], "{rates:?}");
    assert!(errors[3] < 0.2 * errors[0], "{errors:?}");
}

#[test]
fn nonsense_changes_nothing() {
    let world = world();
    let mut builder = construct(&world, 0, 1);
    let found = check(&world, &builder, 1.0);
    let right = found.mismatches[0];
    let nonsense = [
        Mismatch {
            light: u32::MAX,
            ..right
        },
        Mismatch {
            point: Vec3::NAN,
            ..right
        },
        Mismatch {
            point: right.point + 0.5,
            ..right
        },
        Mismatch {
            ray: Ray::new(right.ray.origin, Vec3::splat(f32::INFINITY)),
            ..right
        },
        Mismatch {
            ray: Ray::new(right.point, Vec3::ZERO),
            ..right
        },
    ];
    let report = builder.batch(&[]);
    let version = report.version;
    assert_eq!(builder.mend(&nonsense), 0);
    assert_eq!(builder.batch(&[]).version, version);
    assert_eq!(builder.mend(&[right]), 1);
    assert!(builder.batch(&[]).version > version);
}
