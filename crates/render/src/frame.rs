use std::sync::{Mutex, atomic::AtomicBool};

use lie_scene::Camera;
use rayon::prelude::*;

use crate::{Film, FrameSettings, LieLookup, RenderStats, World, render_tile, tiles};

/// Renders a whole frame on rayon's current threads. `progress` is told the share done, in
/// `[0, 1]`, after every tile, by whichever thread finished it.
pub fn render_frame(
    world: &World,
    lies: Option<&dyn LieLookup>,
    camera: &Camera,
    settings: &FrameSettings,
    progress: &mut (dyn FnMut(f32) + Send),
) -> (Film, RenderStats) {
    let tiles = tiles(settings.size);
    let never = AtomicBool::new(false);
    let progress = Mutex::new((0usize, progress));
    let rendered: Vec<_> = tiles
        .par_iter()
        .filter_map(|&tile| {
            let result = render_tile(world, lies, camera, settings, tile, &never);
            if let Ok(mut progress) = progress.lock() {
                progress.0 += 1;
                let share = progress.0 as f32 / tiles.len() as f32;
                (progress.1)(share);
            }
            result
        })
        .collect();
    let mut film = Film::new(settings.size);
    let mut stats = RenderStats::default();
    for tile in rendered {
        assert!(film.put(&tile.radiance), "tiles lie inside their film");
        stats += tile.stats;
    }
    (film, stats)
}
