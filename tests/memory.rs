//! Memory of the LIEs over a whole walkthrough, on a shader and on the constructor. Prints it
//! view by view: run with `--ignored --nocapture`.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(clippy::print_stdout, reason = "the figures are what one runs it for")]

use std::{path::Path, sync::Arc};

use glam::UVec2;
use lie_farm::{Builder, ConstructSettings, LieReplica, View};
use lie_octree::LieSettings;
use lie_render::World;

/// Seconds of the walkthrough from one view to the next.
const STEP_S: f32 = 2.0;

/// Passes over the picture that each view gets.
const PASSES: u64 = 4;

/// Columns and rows: the paper's.
const SIZE: UVec2 = UVec2::splat(512);

/// Bytes that a shader's cells may hold when it has seen the whole walkthrough: the paper's
/// 50 MB.
const SHADER_LIMIT: u64 = 50_000_000;

/// Bytes that the constructor's cells may hold then, with all evidence, by default.
const CONSTRUCTOR_LIMIT: u64 = 80_000_000;

#[test]
#[ignore = "takes many minutes"]
fn the_mosque_over_its_tour() {
    let bytes = walk(LieSettings::default().trust);
    assert!(bytes <= CONSTRUCTOR_LIMIT, "{bytes} bytes");
}

#[test]
#[ignore = "takes many minutes"]
fn the_mosque_over_its_tour_in_the_papers_mode() {
    walk(0);
}

/// Bytes that the constructor's cells hold in the end.
fn walk(trust: u32) -> u64 {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/mosque");
    let scene = Arc::new(lie_scene::load(&folder).unwrap().scene);
    let world = Arc::new(World::new(scene.clone()));
    let mut settings = ConstructSettings::new(&scene);
    settings.lie.trust = trust;
    let mut builder = Builder::new(world.clone(), settings).unwrap();
    let tour = &scene.walkthroughs[0];
    println!(" time  cells   lights  occluders   tree MB  shader MB");
    let (mut shader_bytes, mut constructor_bytes) = (0, 0);
    for step in 0..=(tour.duration_s() / STEP_S) as u32 {
        let time_s = step as f32 * STEP_S;
        let view = View {
            camera: tour.camera_at(time_s),
            size: SIZE,
        };
        let pixels = u64::from(SIZE.x) * u64::from(SIZE.y);
        builder.sample(&[view], PASSES * pixels, |_| {});
        let stats = builder.tree().stats();
        constructor_bytes = stats.bytes;
        shader_bytes = LieReplica::of(world.clone(), builder.tree())
            .publish()
            .bytes();
        println!(
            "{time_s:5.1} {:6} {:8} {:10} {:9.1} {:10.1}",
            stats.cells,
            stats.entries,
            stats.occluders,
            stats.bytes as f64 * 1.0e-6,
            shader_bytes as f64 * 1.0e-6,
        );
    }
    assert!(shader_bytes <= SHADER_LIMIT, "{shader_bytes} bytes");
    constructor_bytes
}
