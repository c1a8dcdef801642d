//! From input to picture: what the time between goes to, while somebody moves the camera.

mod show;

use std::{
    panic::resume_unwind,
    time::{Duration, Instant},
};

use lie_farm::{
    client::{Client, ClientError, FrameRequest},
    steer::{Input, SteerConfig, SteeredFrame, steer},
};
use lie_render::ToneMap;
use lie_scene::Walkthrough;
use tokio::sync::watch;

pub use self::show::{HEADING, json, section, table};
use crate::spread::percentile;

/// What is measured.
#[derive(Clone, Debug)]
pub struct LatencyConfig {
    /// Everything about a frame but its camera.
    pub frame: FrameRequest,
    /// The way of the camera.
    pub path: Walkthrough,
    /// Inputs per second.
    pub rate: f64,
    /// Pictures.
    pub pictures: usize,
    /// When frames are given up; see [`SteerConfig::patience`].
    pub patience: Option<Duration>,
    /// How often stale work is stopped.
    pub stops: usize,
    /// How pictures are shown.
    pub tone_map: ToneMap,
}

/// A farm, looked at by somebody who moves.
#[derive(Clone, Debug, PartialEq)]
pub struct LatencyRun {
    /// Milliseconds that everything took longer between two processes, in each direction.
    pub delay_ms: f64,
    /// Milliseconds after which a stale frame was given up.
    pub patience_ms: Option<f64>,
    /// Inputs per second.
    pub rate: f64,
    /// Shaders, of one thread each.
    pub shaders: usize,
    /// What was put in, whether it was asked for or not.
    pub inputs: usize,
    /// Frames that were asked for.
    pub asked: usize,
    /// Pictures that were shown.
    pub pictures: usize,
    /// Milliseconds by stage.
    pub stages: Vec<StageTimes>,
}

/// A stage of the way from input to picture.
#[derive(Clone, Debug, PartialEq)]
pub struct StageTimes {
    /// Its name.
    pub stage: &'static str,
    /// How often it was measured.
    pub count: usize,
    /// Half of all kept to this, in milliseconds.
    pub p50_ms: f64,
    /// 95 of 100 did.
    pub p95_ms: f64,
    /// 99 of 100 did.
    pub p99_ms: f64,
}

/// When things happened to a picture, in milliseconds since its input.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    taken: f64,
    camera_out: f64,
    first_tile: f64,
    last_tile: f64,
    assembled: f64,
    shown: f64,
}

/// The columns of [`Way`].
type Column = (&'static str, fn(&Way) -> f64);

const STAGES: [Column; 6] = [
    ("taken up", |way| way.taken),
    ("camera out", |way| way.camera_out),
    ("first tile", |way| way.first_tile),
    ("last tile", |way| way.last_tile),
    ("assembled", |way| way.assembled),
    ("shown", |way| way.shown),
];

/// Moves the camera and sees when pictures of it are there; then gives up frames and sees when
/// shaders have stopped.
///
/// # Errors
/// [`ClientError`].
pub async fn measure(
    client: &mut Client,
    config: &LatencyConfig,
    delay: Duration,
) -> Result<LatencyRun, ClientError> {
    // The first frames are slower than the others.
    for _ in 0..3 {
        client.render_frame(&config.frame).await?;
    }
    let (inputs, newest) = watch::channel(None);
    let (enough, is_enough) = watch::channel(false);
    let hand = tokio::spawn(put_in(config.path.clone(), config.rate, inputs, is_enough));
    let steering = SteerConfig {
        frame: config.frame.clone(),
        patience: config.patience,
    };
    let mut ways = vec![];
    let mut given_up = 0;
    let mut shown_at: Vec<(Instant, Instant)> = vec![];
    let show = |steered: SteeredFrame| {
        given_up += steered.given_up as usize;
        let way = Way::of(&steered, &config.tone_map);
        shown_at.push((steered.input.at, Instant::now()));
        ways.push(way);
        if ways.len() == config.pictures {
            enough.send_replace(true);
        }
    };
    steer(client, newest, &steering, show).await?;
    // Nobody calls it off: if it fails, it has panicked.
    let put_in = hand
        .await
        .unwrap_or_else(|error| resume_unwind(error.into_panic()));
    let mut stages: Vec<StageTimes> = STAGES
        .iter()
        .map(|(stage, time)| StageTimes::of(stage, ways.iter().map(time)))
        .collect();
    stages.push(StageTimes::of("any input, shown", ages(&put_in, &shown_at)));
    let stopped = stops(client, config).await?;
    stages.push(StageTimes::of("stale work stopped", stopped));
    Ok(LatencyRun {
        delay_ms: milliseconds(delay),
        patience_ms: config.patience.map(milliseconds),
        rate: config.rate,
        shaders: client.shaders(),
        inputs: put_in.len(),
        asked: ways.len() + given_up,
        pictures: ways.len(),
        stages,
    })
}

/// Moves along a path, to and fro, until it is enough. Gives when each input was made.
async fn put_in(
    path: Walkthrough,
    rate: f64,
    inputs: watch::Sender<Option<Input>>,
    mut is_enough: watch::Receiver<bool>,
) -> Vec<Instant> {
    let mut ticks = tokio::time::interval(Duration::from_secs_f64(1.0 / rate));
    let (start, duration) = (Instant::now(), path.duration_s().max(1.0e-3));
    let mut all = vec![];
    loop {
        tokio::select! {
            _ = ticks.tick() => {}
            _ = is_enough.wait_for(|&enough| enough) => return all,
        }
        let at = Instant::now();
        let along = (at - start).as_secs_f32() % (2.0 * duration);
        let time_s = duration - (along - duration).abs();
        let camera = path.camera_at(time_s);
        inputs.send_replace(Some(Input { camera, at }));
        all.push(at);
    }
}

impl Way {
    /// Shows a picture.
    fn of(steered: &SteeredFrame, tone_map: &ToneMap) -> Self {
        let stats = &steered.frame.stats;
        let taken = milliseconds(steered.asked - steered.input.at);
        // The frame's own clock begins with the call; between that and the last look at it nothing waits.
        let assembled = taken + stats.frame_ms;
        let clock = Instant::now();
        std::hint::black_box(tone_map.bytes(&steered.frame.film));
        Self {
            taken,
            camera_out: taken + stats.asked_ms,
            first_tile: taken + stats.latency_ms,
            last_tile: taken + stats.last_tile_ms,
            assembled,
            shown: assembled + milliseconds(clock.elapsed()),
        }
    }
}

/// How old each input was when a picture was shown that is as new as it, or newer.
fn ages(inputs: &[Instant], shown: &[(Instant, Instant)]) -> Vec<f64> {
    let mut pictures = shown.iter().peekable();
    let mut ages = vec![];
    for &input in inputs {
        while pictures.next_if(|&&(newest, _)| newest < input).is_some() {}
        if let Some(&&(_, at)) = pictures.peek() {
            ages.push(milliseconds(at - input));
        }
    }
    ages
}

/// Gives up frames in work, each for one of a single tile: how long that waited at its shader, from
/// its arrival on, in milliseconds.
async fn stops(client: &mut Client, config: &LatencyConfig) -> Result<Vec<f64>, ClientError> {
    let long = FrameRequest {
        samples_per_pixel: 256,
        ..config.frame.clone()
    };
    let short = FrameRequest {
        size: glam::UVec2::splat(16),
        ..config.frame.clone()
    };
    let mut waits = vec![];
    for stop in 0..config.stops {
        // At another moment of the work each time.
        let until = Duration::from_micros(20_000 + 1_370 * (stop as u64 % 20));
        let ended = tokio::time::timeout(until, client.render_frame(&long)).await;
        if let Ok(frame) = ended {
            // It was not long enough to be given up: there is nothing to see.
            frame?;
            continue;
        }
        let frame = client.render_frame(&short).await?;
        waits.push(frame.stats.queued_ms);
    }
    Ok(waits)
}

impl StageTimes {
    fn of(stage: &'static str, times: impl IntoIterator<Item = f64>) -> Self {
        let times: Vec<f64> = times.into_iter().collect();
        let at = |share| percentile(&times, share).unwrap_or(f64::NAN);
        Self {
            stage,
            count: times.len(),
            p50_ms: at(0.5),
            p95_ms: at(0.95),
            p99_ms: at(0.99),
        }
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1.0e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_is_as_old_as_it_is_when_its_picture_or_a_newer_one_is_shown() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let inputs = [0, 10, 20, 30, 40].map(at);
        let shown = [(at(0), at(15)), (at(20), at(35))];
        let ages: Vec<u64> = ages(&inputs, &shown)
            .iter()
            .map(|age| age.round() as u64)
            .collect();
        // What nothing was shown of does not count.
        assert_eq!(ages, [15, 25, 15]);
    }
}
