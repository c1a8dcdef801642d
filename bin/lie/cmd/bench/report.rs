use std::path::PathBuf;

use clap::Args;
use lie_bench::{
    Contender, Figure, FrameRow, Panel, Stage,
    builds::{self, BuildRow},
    converge::{self, ConvergeConfig, ConvergeRow, ConvergeSummary},
    figure4::{self, CostRow},
    growth, latency, scale, table1, table2,
};

use super::{
    COURSE_PASSES, Frames, construct_settings, course::Course, figure4::measure as measure_costs,
    follow, gallery, output, subject::Subject,
};
use crate::{
    args::{self, say},
    process,
};

/// Sections that other commands write.
const KEPT: [&str; 3] = [growth::HEADING, scale::HEADING, latency::HEADING];

/// All tables and plots in one report, as Markdown with its pictures in a folder beside it.
#[derive(Args)]
pub(crate) struct Report {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    frames: Frames,
    #[command(flatten)]
    course: Course,
    /// The report.
    #[arg(long, default_value = "docs/results.md", value_name = "FILE.md")]
    out: PathBuf,
    /// Write all rows to this file as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What has been measured so far.
#[derive(Default)]
struct Results {
    builds: Vec<BuildRow>,
    frames: Vec<FrameRow>,
    costs: Vec<CostRow>,
    panels: Vec<Panel>,
    marks: Vec<ConvergeRow>,
    summary: Vec<ConvergeSummary>,
    pictures: Vec<Figure>,
}

impl Report {
    pub(super) fn execute(&self) -> anyhow::Result<()> {
        output::prepare(self.json.as_deref(), self.out.parent())?;
        let mut results = Results::default();
        for scene in self.subject.load()? {
            self.measure(&scene.stage(), &mut results)?;
        }
        say(table1::table(&results.frames).text())?;
        say(table2::table(&results.frames).text())?;
        say(figure4::table(&results.costs).text())?;
        say(converge::summary_table(&results.summary).text())?;
        say(builds::table(&results.builds).text())?;
        output::announce(&self.out)
    }

    /// Measures a scene, and writes what there is after each part of it.
    fn measure(&self, stage: &Stage, results: &mut Results) -> anyhow::Result<()> {
        let most = self.frames.threads()?.into_iter().max();
        let threads = most.unwrap_or_else(process::cores);
        // LIEs of frames and costs are gone before others are constructed.
        {
            let learning = &self.frames.learning;
            let lineup = learning.construct(stage, Contender::ALL)?;
            let frames = self.frames.race(stage, &lineup)?;
            results
                .pictures
                .push(Figure::of_frame(stage, frames.picture));
            results.frames.extend(frames.rows);
            self.write(results)?;
            let costs = measure_costs(stage, &lineup, threads)?;
            results.panels.push(figure4::panel(stage, &costs));
            results.costs.extend(costs.rows);
            self.write(results)?;
        }
        let followed = follow(stage, &self.course(stage, threads))?;
        results.marks.extend(followed.rows);
        results.summary.extend(followed.summary);
        results.builds.push(self.rebuild(stage)?);
        self.write(results)
    }

    /// Builds the stage's structure anew, on all cores.
    fn rebuild(&self, stage: &Stage) -> anyhow::Result<BuildRow> {
        let bar = output::progress_bar();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(process::cores())
            .build()?;
        let tell = output::teller(&bar);
        let row = pool.install(|| builds::measure(stage, self.frames.repeat, &tell));
        bar.finish_and_clear();
        Ok(row)
    }

    fn course(&self, stage: &Stage, threads: usize) -> ConvergeConfig {
        let learning = &self.frames.learning;
        let samples = learning.samples(stage);
        ConvergeConfig {
            repeat: self.frames.repeat,
            threads,
            max_samples: samples.unwrap_or(COURSE_PASSES * stage.pixels()),
            ..self
                .course
                .config(construct_settings(&learning.construction, stage))
        }
    }

    fn write(&self, results: &Results) -> anyhow::Result<()> {
        let Results {
            builds,
            frames,
            costs,
            marks,
            summary,
            ..
        } = results;
        if let Some(path) = &self.json {
            let parts = [
                ("table1", table1::json(frames)),
                ("table2", table2::json(frames)),
                ("figure4", figure4::json(costs)),
                ("converge", converge::rows_json(marks)),
                ("converge_summary", converge::summary_json(summary)),
                ("builds", builds::json(builds)),
            ];
            args::write_json(path, &output::envelope(&parts))?;
        }
        let sections = vec![
            table1::section(frames)?,
            table2::section(frames)?,
            figure4::section(costs, results.panels.clone()),
            converge::section(marks, summary)?,
            builds::section(builds),
            gallery(&results.pictures),
        ];
        // Growth is measured by a command of its own, and takes far longer.
        output::rewrite_report(&self.out, "Results", sections, &KEPT)
    }
}
