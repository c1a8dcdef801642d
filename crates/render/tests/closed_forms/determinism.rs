//! Pixels depend on what is rendered, not on who renders it in which order.

use std::sync::{Arc, atomic::AtomicBool};

use glam::UVec2;
use lie_render::{AccelKind, Film, FrameSettings, Tile, World, render_frame, render_tile};

const SETTINGS: FrameSettings = FrameSettings {
    size: UVec2::new(117, 83),
    samples_per_pixel: 2,
    light_samples: 5,
    seed: 3,
    ward: None,
};

fn scenes() -> Vec<World> {
    scenes_with(AccelKind::default())
}

fn scenes_with(accel: AccelKind) -> Vec<World> {
    let gallery = lie_scene::gallery(&lie_scene::Gallery {
        detail: 0.25,
        ..lie_scene::Gallery::default()
    });
    [lie_scene::cornell_box(), gallery]
        .map(|scene| World::with_accel(Arc::new(scene), accel))
        .into()
}

fn frame(world: &World, threads: usize) -> Film {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    let camera = &world.scene().cameras[0];
    pool.install(|| render_frame(world, None, camera, &SETTINGS, &mut |_| {}).0)
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for world in scenes() {
        let alone = frame(&world, 1);
        assert!(
            alone
                .radiance()
                .iter()
                .any(|value| value.max_element() > 0.0)
        );
        for threads in [2, 3] {
            assert!(frame(&world, threads) == alone, "{threads} threads");
        }
    }
}

#[test]
fn the_structure_that_finds_hits_changes_no_bit() {
    for (hierarchy, grid) in scenes().iter().zip(&scenes_with(AccelKind::Grid)) {
        let name = &hierarchy.scene().name;
        assert!(frame(hierarchy, 2) == frame(grid, 2), "{name}");
    }
}

#[test]
fn a_tile_is_the_same_alone_however_the_frame_is_cut() {
    for world in scenes() {
        let whole = frame(&world, 2);
        let camera = &world.scene().cameras[0];
        for (x, y, width, height) in [
            (0, 0, 32, 32),
            (96, 64, 21, 19),
            (5, 7, 33, 50),
            (60, 41, 1, 1),
        ] {
            let tile = Tile {
                origin: UVec2::new(x, y),
                size: UVec2::new(width, height),
            };
            let never = AtomicBool::new(false);
            let alone = render_tile(&world, None, camera, &SETTINGS, tile, &never).unwrap();
            for (index, value) in alone.radiance.radiance().iter().enumerate() {
                let pixel = tile.origin + UVec2::new(index as u32 % width, index as u32 / width);
                let of_frame = whole.radiance()[(pixel.y * SETTINGS.size.x + pixel.x) as usize];
                assert_eq!(*value, of_frame, "pixel {pixel} of {tile:?}");
            }
        }
    }
}
