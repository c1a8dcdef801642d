//! Measurement: what is measured and written is in `lie-bench`; here are its arguments.

mod course;
mod farm;
mod figure4;
mod growth;
mod latency;
mod output;
mod peers;
mod report;
mod scale;
mod subject;
mod threads;

use clap::{Args, Subcommand};
use lie_bench::{
    Contender, Effort, Figure, FramesConfig, Lineup, SceneFrames, Section, Stage,
    converge::{self, ConvergeConfig, Convergence},
    measure_frames, table1, table2,
};
use lie_farm::ConstructSettings;

use self::{
    course::Course,
    farm::Farm,
    figure4::Figure4,
    growth::Growth,
    latency::Latency,
    output::{Output, progress_bar, teller},
    peers::Peers,
    report::Report,
    scale::Scale,
    subject::Subject,
    threads::Threads,
};
use super::render::Construction;
use crate::{args::say, process};

/// Measures frames against the standard ray tracer's, with the error that they have.
///
/// Each command measures some scenes, those made after the paper's by default, prints a
/// table, and writes JSON and a report if asked to. Both are written anew after each scene: what
/// is there is not lost if a later one fails.
#[derive(Subcommand)]
pub(crate) enum BenchCommand {
    Table1(Table1),
    Table2(Table2),
    Figure4(Figure4),
    Converge(Converge),
    Report(Report),
    Peers(Peers),
    Growth(Growth),
    Farm(Farm),
    Scale(Scale),
    Latency(Latency),
}

/// The paper's Table 1: time, speed-up and error of a frame, by each integrator.
///
/// LIEs are constructed first; then the integrators render in turn. The paper's figures stand
/// beside ours.
#[derive(Args)]
pub(crate) struct Table1 {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    frames: Frames,
    #[command(flatten)]
    output: Output,
}

/// The paper's Table 2: what the time of a frame with LIEs goes to.
#[derive(Args)]
pub(crate) struct Table2 {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    frames: Frames,
    #[command(flatten)]
    output: Output,
}

/// Error and frame time from a cold start, while LIEs are constructed: after a quarter of a
/// pass over the picture, a half, one, two, four and so on.
///
/// Once as in the paper, relying on what little is known, and once with trust, which traces
/// what is in doubt; --modes names others, and --ablation takes all of them. The options under
/// Construction hold for every mode, but for what makes it one.
#[derive(Args)]
pub(crate) struct Converge {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    course: Course,
    /// Render the standard's frame and the first ones this often, in turn.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    repeat: u32,
    /// Threads; 0 is one for each core.
    #[arg(long, default_value_t = 0, value_name = "N")]
    threads: usize,
    /// Passes over the picture after which convergence is given up.
    #[arg(long, conflicts_with = "samples", value_parser = clap::value_parser!(u64).range(1..=100_000), value_name = "N")]
    passes: Option<u64>,
    #[command(flatten)]
    construction: Construction,
    #[command(flatten)]
    output: Output,
}

/// How frames are measured.
#[derive(Args)]
struct Frames {
    /// Frames of each integrator, in turn; times are medians.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    repeat: u32,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    learning: Learning,
}

/// How LIEs are constructed before frames are measured, and for how long.
#[derive(Args)]
struct Learning {
    /// Construct for exactly so many passes over the picture instead of until converged.
    #[arg(long, conflicts_with = "samples", value_parser = clap::value_parser!(u64).range(1..=100_000), value_name = "N")]
    passes: Option<u64>,
    /// Passes over the picture after which construction gives up waiting for convergence;
    /// what is then in doubt is traced.
    #[arg(long, conflicts_with_all = ["samples", "passes"], default_value_t = 32, value_parser = clap::value_parser!(u64).range(1..=100_000), value_name = "N")]
    max_passes: u64,
    #[command(flatten)]
    construction: Construction,
}

/// Passes over the picture after which a course is given up that its limit has not ended.
const COURSE_PASSES: u64 = 64;

pub(crate) fn execute(command: &BenchCommand) -> anyhow::Result<()> {
    match command {
        BenchCommand::Table1(arguments) => arguments.execute(),
        BenchCommand::Table2(arguments) => arguments.execute(),
        BenchCommand::Figure4(arguments) => arguments.execute(),
        BenchCommand::Converge(arguments) => arguments.execute(),
        BenchCommand::Report(arguments) => arguments.execute(),
        BenchCommand::Peers(arguments) => arguments.execute(),
        BenchCommand::Growth(arguments) => arguments.execute(),
        BenchCommand::Farm(arguments) => arguments.execute(),
        BenchCommand::Scale(arguments) => arguments.execute(),
        BenchCommand::Latency(arguments) => arguments.execute(),
    }
}

impl Table1 {
    fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        let mut rows = vec![];
        let mut pictures = vec![];
        for scene in self.subject.load()? {
            let stage = scene.stage();
            let frames = self.frames.measure(&stage, Contender::ALL)?;
            pictures.push(Figure::of_frame(&stage, frames.picture));
            rows.extend(frames.rows);
            self.output.write_json(&[("rows", table1::json(&rows))])?;
            self.output.write_report("table1", "Table 1", || {
                Ok(vec![table1::section(&rows)?, gallery(&pictures)])
            })?;
        }
        say(table1::table(&rows).text())?;
        self.output.announce("table1")
    }
}

impl Table2 {
    fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        let mut rows = vec![];
        let mut pictures = vec![];
        for scene in self.subject.load()? {
            let stage = scene.stage();
            let frames = self.frames.measure(&stage, &[Contender::Lie])?;
            pictures.push(Figure::of_frame(&stage, frames.picture));
            rows.extend(frames.rows);
            self.output.write_json(&[("rows", table2::json(&rows))])?;
            self.output.write_report("table2", "Table 2", || {
                Ok(vec![table2::section(&rows)?, gallery(&pictures)])
            })?;
        }
        say(table2::table(&rows).text())?;
        self.output.announce("table2")
    }
}

impl Converge {
    fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        let mut rows = vec![];
        let mut summary = vec![];
        let mut pictures = vec![];
        for scene in self.subject.load()? {
            let stage = scene.stage();
            let samples = self.construction.samples;
            let config = ConvergeConfig {
                repeat: self.repeat,
                threads: process::threads(self.threads)?,
                max_samples: samples
                    .unwrap_or(self.passes.unwrap_or(COURSE_PASSES) * stage.pixels()),
                ..self
                    .course
                    .config(construct_settings(&self.construction, &stage))
            };
            let followed = follow(&stage, &config)?;
            rows.extend(followed.rows);
            summary.extend(followed.summary);
            pictures.push(Figure::of_frame(&stage, followed.reference));
            self.output.write_json(&[
                ("rows", converge::rows_json(&rows)),
                ("summary", converge::summary_json(&summary)),
            ])?;
            self.output.write_report("converge", "Convergence", || {
                Ok(vec![
                    converge::section(&rows, &summary)?,
                    gallery(&pictures),
                ])
            })?;
        }
        say(converge::table(&rows).text())?;
        say(converge::summary_table(&summary).text())?;
        self.output.announce("converge")
    }
}

impl Frames {
    /// Constructs LIEs of the view on all cores, and renders it by these integrators.
    fn measure(&self, stage: &Stage, contenders: &[Contender]) -> anyhow::Result<SceneFrames> {
        let lineup = self.learning.construct(stage, contenders)?;
        self.race(stage, &lineup)
    }

    /// Renders a view by this line-up.
    fn race(&self, stage: &Stage, lineup: &Lineup) -> anyhow::Result<SceneFrames> {
        let config = FramesConfig {
            threads: self.threads()?,
            repeat: self.repeat,
        };
        race(stage, lineup, &config)
    }

    fn threads(&self) -> anyhow::Result<Vec<usize>> {
        self.threads.counts()
    }
}

/// Renders a view by a line-up, with a bar.
fn race(stage: &Stage, lineup: &Lineup, config: &FramesConfig) -> anyhow::Result<SceneFrames> {
    let bar = progress_bar();
    let frames = measure_frames(stage, lineup, config, &teller(&bar))?;
    bar.finish_and_clear();
    Ok(frames)
}

impl Learning {
    /// Constructs on all cores what these integrators need of a view.
    fn construct(&self, stage: &Stage, contenders: &[Contender]) -> anyhow::Result<Lineup> {
        let max_passes = self.max_passes;
        let until_converged = Effort::UntilConverged { max_passes };
        let effort = self.samples(stage).map_or(until_converged, Effort::Samples);
        let bar = progress_bar();
        let settings = construct_settings(&self.construction, stage);
        let lineup = Lineup::construct(stage, contenders, settings, effort, &teller(&bar))?;
        bar.finish_and_clear();
        if !lineup.has_converged() && effort == until_converged {
            let name = stage.name();
            tracing::warn!("{name}: the view has not converged after {max_passes} passes");
        }
        Ok(lineup)
    }

    /// How many pixels to sample, if that was said.
    fn samples(&self, stage: &Stage) -> Option<u64> {
        let passes = self.passes.map(|passes| passes * stage.pixels());
        passes.or(self.construction.samples)
    }
}

fn follow(stage: &Stage, config: &ConvergeConfig) -> anyhow::Result<Convergence> {
    let bar = progress_bar();
    let walkthrough = stage.world().scene().walkthroughs.first();
    let followed = converge::converge(stage, walkthrough, config, &teller(&bar))?;
    bar.finish_and_clear();
    Ok(followed)
}

fn construct_settings(construction: &Construction, stage: &Stage) -> ConstructSettings {
    ConstructSettings {
        threads: process::cores(),
        ..construction.settings(stage.world().scene())
    }
}

/// The scenes as they were seen.
fn gallery(figures: &[Figure]) -> Section {
    Section {
        heading: "The views".to_owned(),
        figures: figures.to_vec(),
        ..Section::default()
    }
}
