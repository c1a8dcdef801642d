mod simulation;

use std::{path::PathBuf, time::Duration};

use anyhow::Context;
use clap::Args;
use lie_bench::{
    Contender, Effort, Lineup, Stage,
    scale::{self, Length, ScaleRow},
};
use lie_farm::{
    replay::Recording,
    scene_blob::{self, SceneBlob},
};

use self::simulation::Simulation;
use super::{
    construct_settings,
    output::{self, Output, progress_bar, teller},
    subject::{LoadedScene, Subject, seconds},
};
use crate::{
    args::say,
    cmd::{render::Construction, shader::slow_down},
    failure::{OrUsage, usage},
    process,
};

/// How a farm grows: the real constructor and the real client with so many simulated shaders, which
/// take for each tile the time that was recorded of it.
///
/// First each tile of a frame is rendered and timed, on one thread, in all sizes that tiles may
/// have (or --replay says how long they take). Then, for each number of shaders, frames are measured while the
/// constructor has nothing to do, and while it learns what a moving camera sees.
#[derive(Args)]
pub(crate) struct Scale {
    #[command(flatten)]
    subject: Subject,
    /// Camera rays per pixel of what is recorded; the scene's setting by default.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096), value_name = "N")]
    spp: Option<u32>,
    /// Record the standard ray tracer instead of LIEs.
    #[arg(long)]
    standard: bool,
    /// Times that each tile is rendered for the recording, of which the median counts.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100), value_name = "N")]
    repeat: u32,
    /// Write the recording to this file, and measure nothing else.
    #[arg(long, conflicts_with = "replay", value_name = "FILE")]
    record: Option<PathBuf>,
    /// Take this recording of the scene instead of making one.
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
    /// Numbers of shaders, one measurement for each; a number may come again, slowed down otherwise.
    #[arg(long, value_delimiter = ',', default_value = "1,8,24,64,256", value_parser = clap::value_parser!(u16).range(1..=1024), value_name = "N,N,…")]
    shaders: Vec<u16>,
    /// How many times as long as recorded a tile takes, for each number of shaders; the last
    /// holds for the rest.
    #[arg(long, value_delimiter = ',', default_value = "1", value_parser = slow_down, value_name = "K,K,…")]
    slow_down: Vec<f64>,
    /// Frames of each measurement, at least.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=100_000), value_name = "N")]
    frames: u32,
    /// Seconds of each measurement, at least.
    #[arg(long, default_value = "5", value_parser = seconds, value_name = "S")]
    seconds: Duration,
    /// Put tables and plots into this report, in the place of those that are there:
    /// docs/results.md, say. `lie bench report` leaves them there.
    #[arg(long, value_name = "FILE.md")]
    into: Option<PathBuf>,
    #[command(flatten)]
    construction: Construction,
    #[command(flatten)]
    output: Output,
}

impl Scale {
    pub(super) fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        output::prepare(
            self.record.as_deref(),
            self.into.as_ref().and_then(|path| path.parent()),
        )?;
        if self.slow_down.len() > self.shaders.len() {
            return Err(usage("there are more values of --slow-down than of --shaders").into());
        }
        // Without a file to write it to, it lives as long as the measurement.
        let folder = tempfile::tempdir().context("cannot make a folder for the recording")?;
        let kept = self.replay.clone().or_else(|| self.record.clone());
        let path = kept.unwrap_or_else(|| folder.path().join("tiles.json"));
        // What is wrong with it is said before the scene is loaded.
        let given = self.replay.as_deref().map(Recording::read);
        let given = given.transpose().or_usage()?;
        let scene = self.only_scene()?;
        let recording = match given {
            Some(recording) => recording,
            None => {
                let recording = self.make(scene.clone())?;
                let json = serde_json::to_value(&recording)?;
                crate::args::write_json(&path, &json)?;
                recording
            }
        };
        if self.record.is_some() {
            return say(format_args!("{}: written", path.display()));
        }
        let rows = self.measure(&scene, &recording, path)?;
        for table in scale::table(&rows) {
            say(table.text())?;
        }
        self.output.announce("scale")?;
        let Some(path) = &self.into else {
            return Ok(());
        };
        output::put_into_report(path, scale::section(&rows, about(&recording))?)?;
        output::announce(path)
    }

    fn only_scene(&self) -> anyhow::Result<LoadedScene> {
        let mut scenes = self.subject.load()?;
        match (scenes.pop(), scenes.is_empty()) {
            (Some(scene), true) => Ok(scene),
            _ => Err(usage("name the one scene that the farm is to have").into()),
        }
    }

    /// Renders and times.
    fn make(&self, scene: LoadedScene) -> anyhow::Result<Recording> {
        let stage = scene.stage();
        let hash = SceneBlob::new(scene_blob::encode(stage.world().scene())?).hash();
        let bar = progress_bar();
        let lineup = match self.standard {
            true => None,
            false => Some(self.construct(&stage)?),
        };
        let lies = lineup
            .as_ref()
            .and_then(|lineup| lineup.lies(Contender::Lie));
        let samples = self.spp.unwrap_or(stage.settings().samples_per_pixel);
        let tell = teller(&bar);
        let recording = scale::record(&stage, hash, lies, samples, self.repeat, &tell)?;
        bar.finish_and_clear();
        Ok(recording)
    }

    fn construct(&self, stage: &Stage) -> anyhow::Result<Lineup> {
        let until_converged = Effort::UntilConverged { max_passes: 32 };
        let samples = self.construction.samples;
        let effort = samples.map_or(until_converged, Effort::Samples);
        let settings = construct_settings(&self.construction, stage);
        let bar = progress_bar();
        let lineup = Lineup::construct(stage, &[Contender::Lie], settings, effort, &teller(&bar))?;
        bar.finish_and_clear();
        Ok(lineup)
    }

    fn measure(
        &self,
        scene: &LoadedScene,
        recording: &Recording,
        path: PathBuf,
    ) -> anyhow::Result<Vec<ScaleRow>> {
        let runtime = process::runtime()?;
        let length = Length {
            frames: self.frames,
            duration: self.seconds,
        };
        let simulation = Simulation {
            scene,
            recording,
            path,
            construction: self.construction.to_arguments(),
            length,
        };
        let mut rows = vec![];
        let last = self.slow_down.last().copied().unwrap_or(1.0);
        for (index, &shaders) in self.shaders.iter().enumerate() {
            let slow_down = self.slow_down.get(index).copied().unwrap_or(last);
            let shaders = usize::from(shaders);
            let of = |learns| simulation.phase(&runtime, (shaders, slow_down), learns);
            rows.push(ScaleRow {
                shaders,
                slow_down,
                still: of(false)?,
                learning: of(true)?,
            });
            self.output.write_json(&[("rows", scale::json(&rows))])?;
            self.output.write_report("scale", "Scale", || {
                Ok(vec![scale::section(&rows, about(recording))?])
            })?;
        }
        runtime.shutdown_background();
        Ok(rows)
    }
}

/// What was recorded, in a sentence.
fn about(recording: &Recording) -> String {
    let (subject, size) = (&recording.subject, recording.size());
    let totals: Vec<String> = recording
        .totals()
        .map(|(side, total)| {
            format!(
                "{:.0} ms in tiles of {side} pixels",
                1.0e3 * total.as_secs_f64()
            )
        })
        .collect();
    format!(
        "Recorded: {}, camera {}, {}x{}, {} camera rays per pixel, by {} ({:.1} % trusted), on one thread of {}: {}.",
        subject.scene,
        subject.camera,
        size.x,
        size.y,
        subject.samples_per_pixel,
        subject.integrator,
        100.0 * subject.trusted_fraction,
        subject.cpu,
        totals.join(", ")
    )
}
