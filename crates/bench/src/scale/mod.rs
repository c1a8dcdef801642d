//! How a farm grows with its shaders, which are simulated: they replay what tiles cost. Everything
//! else is real.

mod record;
mod show;
mod usage;

use std::time::{Duration, Instant};

use lie_farm::{
    client::{ClientError, FrameStats},
    replay::Recording,
};

pub use self::{
    record::record,
    show::{HEADING, json, section, table},
    usage::{Usage, cpu_of},
};
use crate::{Spread, spread::percentile};

/// Frames that are rendered before it is measured: the first two find out what tiles cost.
const WARM_UP: u32 = 3;

/// A farm of so many simulated shaders.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleRow {
    /// How many, of one thread each.
    pub shaders: usize,
    /// How many times as long as recorded a tile took.
    pub slow_down: f64,
    /// While nothing is learnt.
    pub still: Phase,
    /// While the constructor learns what a moving camera sees.
    pub learning: Phase,
}

/// Some frames that followed each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Phase {
    /// How many.
    pub frames: usize,
    /// Tiles of one.
    pub tiles: u64,
    /// Side of a tile, in pixels.
    pub side: u32,
    /// Share of the shaders' time in which they worked: the recorded costs of a frame's tiles,
    /// slowed down, divided by shaders times the frame's time. Of each frame, and the median.
    pub efficiency: f64,
    /// The same with the costs of the largest tiles that there are: speed-up over one shader, which
    /// has those, divided by the number of shaders.
    pub efficiency_of_largest: f64,
    /// Time of a frame.
    pub frame_ms: f64,
    /// That which 95 of 100 frames kept to.
    pub frame_ms_p95: f64,
    /// Until the first tile was there.
    pub latency_ms: f64,
    /// Tiles that came each second.
    pub tiles_per_s: f64,
    /// By how much the simulation's own clock was late with a tile, in the mean.
    pub clock_late_ms: f64,
    /// Tiles that were given to a second shader as well, of a thousand.
    pub reissued_per_mille: f64,
    /// What was used in that time.
    pub used: Used,
}

/// Resources, per second of a phase.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Used {
    /// Processors: seconds of work per second; none where it cannot be known.
    pub client_cpu: Option<f64>,
    /// The same of the constructor.
    pub constructor_cpu: Option<f64>,
    /// The same of the process that simulates the shaders.
    pub shaders_cpu: Option<f64>,
    /// Bytes that the constructor sent to shaders.
    pub sent_bytes_per_s: f64,
    /// Versions of the LIEs that were made.
    pub versions_per_s: f64,
    /// Versions that the last shader was behind at the end, by its own last report.
    pub most_lag: u64,
}

/// How long a phase goes on: until both are reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// Frames.
    pub frames: u32,
    /// Time.
    pub duration: Duration,
}

/// Renders the frame of this number.
pub type SimulatedFrame<'a> = dyn FnMut(u32) -> Result<FrameStats, ClientError> + 'a;

/// Renders frames on a farm of simulated shaders.
///
/// # Errors
/// [`ClientError`].
pub fn measure(
    recording: &Recording,
    (shaders, slow_down): (usize, f64),
    length: Length,
    frame: &mut SimulatedFrame<'_>,
    usage: &mut dyn FnMut() -> Usage,
) -> Result<Phase, ClientError> {
    for number in 0..WARM_UP {
        frame(number)?;
    }
    let before = usage();
    let clock = Instant::now();
    let mut frames = vec![];
    while frames.len() < length.frames as usize || clock.elapsed() < length.duration {
        frames.push(frame(WARM_UP + frames.len() as u32)?);
    }
    let seconds = clock.elapsed().as_secs_f64();
    let used = Used::between(&before, &usage(), seconds);
    let farm = Farm {
        recording,
        shaders,
        slow_down,
    };
    Ok(farm.phase(&frames, seconds, used))
}

/// What is simulated.
struct Farm<'a> {
    recording: &'a Recording,
    shaders: usize,
    slow_down: f64,
}

impl Farm<'_> {
    fn phase(&self, frames: &[FrameStats], seconds: f64, used: Used) -> Phase {
        let tiles = frames.first().map_or(0, |stats| stats.tiles);
        let total_tiles: u64 = frames.iter().map(|stats| stats.tiles).sum();
        let median = |value: &dyn Fn(&FrameStats) -> f64| {
            let values: Vec<f64> = frames.iter().map(value).collect();
            Spread::of(&values).map_or(0.0, |spread| spread.median)
        };
        let sum = |value: fn(&FrameStats) -> f64| frames.iter().map(value).sum::<f64>();
        let times: Vec<f64> = frames.iter().map(|stats| stats.frame_ms).collect();
        let (side, cost_ms) = self.cost(|side| self.count(side) == tiles);
        let (_, largest_ms) = self.cost(|_| true);
        let efficiency = |cost_ms: f64| {
            median(&|stats| cost_ms / (self.shaders as f64 * stats.frame_ms.max(1.0e-9)))
        };
        Phase {
            frames: frames.len(),
            tiles,
            side,
            efficiency: efficiency(cost_ms),
            efficiency_of_largest: efficiency(largest_ms),
            frame_ms: median(&|stats| stats.frame_ms),
            frame_ms_p95: percentile(&times, 0.95).unwrap_or(0.0),
            latency_ms: median(&|stats| stats.latency_ms),
            tiles_per_s: total_tiles as f64 / seconds,
            clock_late_ms: sum(|stats| stats.pack_ms) / total_tiles.max(1) as f64,
            reissued_per_mille: 1.0e3 * sum(|stats| stats.reissued_tiles as f64)
                / total_tiles.max(1) as f64,
            used,
        }
    }

    /// The first side of tiles of which this holds, and what all its tiles cost.
    fn cost(&self, is_it: impl Fn(u32) -> bool) -> (u32, f64) {
        let mut totals = self.recording.totals();
        let found = totals.find(|&(side, _)| is_it(side));
        found.map_or((0, 0.0), |(side, total)| {
            (side, 1.0e3 * self.slow_down * total.as_secs_f64())
        })
    }

    fn count(&self, side: u32) -> u64 {
        let across = self.recording.size().map(|size| size.div_ceil(side));
        u64::from(across.x) * u64::from(across.y)
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use lie_farm::replay::RecordedSubject;

    use super::*;

    pub(super) fn recording() -> Recording {
        let subject = RecordedSubject {
            scene: "a".to_owned(),
            hash: "0a".repeat(32),
            camera: "b".to_owned(),
            integrator: "lie".to_owned(),
            samples_per_pixel: 1,
            trusted_fraction: 1.0,
            cpu: "c".to_owned(),
        };
        // 8 ms as one tile, 10 ms as four.
        let cuts = [
            (64, vec![8000.0]),
            (32, vec![1000.0, 2000.0, 3000.0, 4000.0]),
        ];
        Recording::new(subject, UVec2::splat(64), cuts).unwrap()
    }

    #[test]
    fn efficiency_is_work_divided_by_the_time_of_all_shaders() {
        let frames = [4.0, 5.0, 8.0].map(|frame_ms| FrameStats {
            frame_ms,
            tiles: 4,
            pack_ms: 2.0,
            ..FrameStats::default()
        });
        let recording = recording();
        let farm = Farm {
            recording: &recording,
            shaders: 5,
            slow_down: 2.0,
        };
        let phase = farm.phase(&frames, 0.5, Used::default());
        assert_eq!((phase.side, phase.tiles, phase.frames), (32, 4, 3));
        // 20 ms of work by five shaders in 5 ms, and 16 as one tile.
        assert!((phase.efficiency - 0.8).abs() < 1.0e-9);
        assert!((phase.efficiency_of_largest - 0.64).abs() < 1.0e-9);
        assert_eq!((phase.frame_ms, phase.frame_ms_p95), (5.0, 8.0));
        assert!((phase.tiles_per_s - 24.0).abs() < 1.0e-9);
        assert!((phase.clock_late_ms - 0.5).abs() < 1.0e-9);
    }
}
