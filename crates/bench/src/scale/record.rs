use std::{sync::atomic::AtomicBool, time::Instant};

use lie_farm::{
    PublishedLies, pixels,
    replay::{RecordedSubject, Recording, RecordingFlaw},
};
use lie_protocol::{Compression, PixelFormat, SceneHash};
use lie_render::{FrameSettings, LieLookup, RenderStats, TILE_SIDES, Tile, render_tile, tiles_of};

use crate::{Machine, Progress, Spread, Stage};

/// Renders each tile of a stage's frame on this thread, in all sizes that tiles may have, with
/// these LIEs or by the standard ray tracer, and says what a shader would have had to do for it:
/// rendering and packing. Each time is the median of so many.
///
/// # Errors
/// If the frame cannot be recorded.
pub fn record(
    stage: &Stage,
    hash: SceneHash,
    lies: Option<&PublishedLies>,
    samples_per_pixel: u32,
    repeat: u32,
    progress: &Progress<'_>,
) -> Result<Recording, RecordingFlaw> {
    let settings = FrameSettings {
        samples_per_pixel,
        ..*stage.settings()
    };
    let mut all = RenderStats::default();
    let mut tile_us = |tile| {
        let (stats, us) = timed(stage, lies, &settings, tile);
        all += stats;
        us
    };
    let mut cuts = vec![];
    for (index, side) in TILE_SIDES.into_iter().enumerate() {
        let tiles = tiles_of(settings.size, side);
        let mut times: Vec<Vec<f64>> = vec![vec![]; tiles.len()];
        for repetition in 0..repeat.max(1) {
            let done = (index as u32 * repeat + repetition) as f32;
            let what = format!("{}: tiles of {side} pixels", stage.name());
            progress(&what, done / (TILE_SIDES.len() as u32 * repeat) as f32);
            for (tile, times) in tiles.iter().zip(&mut times) {
                times.push(tile_us(*tile));
            }
        }
        let medians = times.iter().map(|times| {
            let median = Spread::of(times).unwrap_or(Spread::NONE).median;
            // To a tenth of a microsecond: more would be noise.
            (10.0 * median).round() * 0.1
        });
        cuts.push((side, medians.collect()));
    }
    let subject = RecordedSubject {
        scene: stage.name().to_owned(),
        hash: hash.to_string(),
        camera: stage.camera().name.clone(),
        integrator: if lies.is_some() { "lie" } else { "standard" }.to_owned(),
        samples_per_pixel,
        trusted_fraction: all.trusted_fraction(),
        cpu: Machine::here().cpu,
    };
    Recording::new(subject, settings.size, cuts)
}

/// What a tile counts, and its time in microseconds.
fn timed(
    stage: &Stage,
    lies: Option<&PublishedLies>,
    settings: &FrameSettings,
    tile: Tile,
) -> (RenderStats, f64) {
    let lookup = lies.map(|lies| lies as &dyn LieLookup);
    let never = AtomicBool::new(false);
    let clock = Instant::now();
    let rendered = render_tile(
        stage.world(),
        lookup,
        stage.camera(),
        settings,
        tile,
        &never,
    );
    // Nobody cancels it.
    let Some(rendered) = rendered else {
        return (RenderStats::default(), 0.0);
    };
    let radiance = rendered.radiance.radiance();
    let packed = pixels::pack(radiance, PixelFormat::F16, Compression::None);
    std::hint::black_box(&packed);
    (rendered.stats, 1.0e6 * clock.elapsed().as_secs_f64())
}
