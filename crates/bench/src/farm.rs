//! What a farm costs: its frames in turn with those of this process, on as many threads.

mod several;
mod show;

use lie_farm::{
    PublishedLies,
    client::{ClientError, Frame, FrameStats},
};
use lie_render::{AccelKind, Precision, compare};

pub use self::{
    several::{SeveralRow, measure_several, several_json, several_table},
    show::{json, section, table},
};
use crate::{
    BenchError, Contender, Progress, Spread, Stage,
    race::{Render, pool, timed},
};

/// How a farm is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FarmConfig {
    /// Threads that render, of the farm and of this process.
    pub threads: usize,
    /// Frames of each.
    pub repeat: u32,
    /// How the farm's pixels travel.
    pub precision: Precision,
}

/// Renders the stage's frame on a farm.
pub type FarmFrame<'a> = dyn FnMut() -> Result<Frame, ClientError> + 'a;

/// A farm beside this process, on so many threads.
#[derive(Clone, Debug, PartialEq)]
pub struct FarmRow {
    /// The scene's name.
    pub scene: String,
    /// What it was loaded from.
    pub path: String,
    /// The camera's name.
    pub camera: String,
    /// What found hits.
    pub accel: AccelKind,
    /// Threads that render, in each of the two.
    pub threads: usize,
    /// Time of a frame in this process.
    pub local_ms: Spread,
    /// Time of the farm's, from the request until the film is full.
    pub farm_ms: Spread,
    /// The farm's time divided by this process's, repetition by repetition.
    pub ratio: Spread,
    /// Where the farm's time went, in the median.
    pub parts: FarmParts,
    /// Bytes of a frame's pixels as they travelled.
    pub pixel_bytes: u64,
    /// Share of the pixels in which the two pictures differ, both rounded alike.
    pub differing: f64,
    /// Share of the light evaluations that LIEs answered.
    pub trusted_fraction: f64,
}

/// What a farm's frame spends its time on, in milliseconds. Of times of the render threads
/// each has its share: with what is left, they add up to the frame's time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FarmParts {
    /// Render threads waited for tiles to render.
    pub idle_ms: f64,
    /// They rendered.
    pub render_ms: f64,
    /// They packed pixels.
    pub pack_ms: f64,
    /// The rest: the first request's way and the last tile's, and threads that had no tile
    /// left when others still had one.
    pub rest_ms: f64,
    /// The client unpacked tiles, meanwhile.
    pub unpack_ms: f64,
    /// From the request until the first tile was on the film.
    pub latency_ms: f64,
}

/// Renders a stage's frame in this process and on a farm, in turn.
///
/// # Errors
/// If threads cannot be started, or the farm has no frame.
pub fn measure(
    stage: &Stage,
    lies: &PublishedLies,
    config: &FarmConfig,
    farm: &mut FarmFrame<'_>,
    progress: &Progress<'_>,
) -> Result<FarmRow, BenchError> {
    let pool = pool(config.threads)?;
    let render: Render<'_> = Box::new(|tell| Contender::Lie.render(stage, Some(lies), tell));
    // The first frame of each is slower than the others.
    let local = timed(&pool, &render, &|_| {}).0.quantized(config.precision);
    let first = farm()?;
    let figures = compare(&first.film, &local, stage.exposure_stops())?;
    drop(local);

    let repeat = config.repeat.max(1);
    let (mut local_ms, mut frames) = (vec![], vec![]);
    for repetition in 0..repeat {
        let what = format!("{}, {} threads", stage.name(), config.threads);
        progress(&what, repetition as f32 / repeat as f32);
        local_ms.push(timed(&pool, &render, &|_| {}).2);
        frames.push(farm()?.stats);
    }
    let farm_ms: Vec<f64> = frames.iter().map(|stats| stats.frame_ms).collect();
    let pairs = farm_ms.iter().zip(&local_ms);
    let ratios: Vec<f64> = pairs.map(|(farm, local)| farm / local).collect();
    let spread = |values: &[f64]| Spread::of(values).unwrap_or(Spread::NONE);
    Ok(FarmRow {
        scene: stage.name().to_owned(),
        path: stage.path().to_owned(),
        camera: stage.camera().name.clone(),
        accel: stage.accel(),
        threads: config.threads,
        local_ms: spread(&local_ms),
        farm_ms: spread(&farm_ms),
        ratio: spread(&ratios),
        parts: FarmParts::median(&frames, config.threads),
        pixel_bytes: first.stats.pixel_bytes,
        differing: figures.differing,
        trusted_fraction: first.stats.trusted_fraction,
    })
}

impl FarmParts {
    fn new(stats: &FrameStats, threads: usize) -> Self {
        let shared = |ms: f64| ms / threads.max(1) as f64;
        let busy_ms = shared(stats.idle_ms + stats.render_ms + stats.pack_ms);
        Self {
            idle_ms: shared(stats.idle_ms),
            render_ms: shared(stats.render_ms),
            pack_ms: shared(stats.pack_ms),
            rest_ms: stats.frame_ms - busy_ms,
            unpack_ms: stats.unpack_ms,
            latency_ms: stats.latency_ms,
        }
    }

    /// The median of each.
    fn median(frames: &[FrameStats], threads: usize) -> Self {
        let all: Vec<Self> = frames
            .iter()
            .map(|stats| Self::new(stats, threads))
            .collect();
        let of = |part: fn(&Self) -> f64| {
            let values: Vec<f64> = all.iter().map(part).collect();
            Spread::of(&values).map_or(0.0, |spread| spread.median)
        };
        Self {
            idle_ms: of(|parts| parts.idle_ms),
            render_ms: of(|parts| parts.render_ms),
            pack_ms: of(|parts| parts.pack_ms),
            rest_ms: of(|parts| parts.rest_ms),
            unpack_ms: of(|parts| parts.unpack_ms),
            latency_ms: of(|parts| parts.latency_ms),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_the_threads_are_shared_out_and_add_up() {
        let frame = |frame_ms: f64| FrameStats {
            frame_ms,
            idle_ms: 2.0,
            render_ms: 16.0,
            pack_ms: 1.0,
            unpack_ms: 0.5,
            ..FrameStats::default()
        };
        let frames = [frame(10.0), frame(12.0), frame(11.0)];
        let parts = FarmParts::median(&frames, 2);
        assert_eq!((parts.idle_ms, parts.render_ms), (1.0, 8.0));
        assert_eq!((parts.pack_ms, parts.rest_ms), (0.5, 1.5));
        assert_eq!(parts.unpack_ms, 0.5);
        assert_eq!(FarmParts::median(&[], 0), FarmParts::default());
    }
}
