//! From a cold start to a converged picture: error and frame time against construction.

mod audit;
mod course;
mod deadline;
mod show;
mod walk;

use std::time::Duration;

use lie_farm::{ConstructSettings, LieReplica};
use lie_octree::LieSettings;
use lie_render::Film;
use lie_scene::Walkthrough;

pub use self::show::{rows_json, section, summary_json, summary_table, table};
use self::{deadline::Deadline, walk::WalkReferences};
use crate::{
    BenchError, Contender, Progress, Spread, Stage,
    race::{Entrant, Runs, pool, race},
};

/// What is relied on before it is known well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Everything: what is not known to be lit is dark (LIE §4.2).
    Paper,
    /// What enough samples agree on; the rest is traced.
    Trust,
}

impl Mode {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Trust];

    /// Its name in tables and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Trust => "trust",
        }
    }

    /// Construction in this mode, otherwise as these settings have it. Where they trust
    /// everything, mode trust has the usual trust.
    fn settings(self, mut settings: ConstructSettings) -> ConstructSettings {
        settings.lie.trust = match (self, settings.lie.trust) {
            (Self::Paper, _) => 0,
            (Self::Trust, 0) => LieSettings::default().trust,
            (Self::Trust, trust) => trust,
        };
        settings
    }
}

/// What is measured of each scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConvergeConfig {
    /// Construction; the modes differ in what is trusted.
    pub construct: ConstructSettings,
    /// Threads that render.
    pub threads: usize,
    /// How often the standard's frame and the first ones are timed, in turn.
    pub repeat: u32,
    /// Pixels sampled after which convergence is given up.
    pub max_samples: u64,
    /// Frames of the walk, after the view from which it starts; 0 is no walk.
    pub walk_frames: u32,
    /// Time for a scene, shared out among the modes: no step begins after it.
    pub limit: Option<Duration>,
}

/// A mark on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergeRow {
    /// The scene's name.
    pub scene: String,
    /// What is relied on.
    pub mode: Mode,
    /// Time of construction so far; frames do not count.
    pub time_ms: f64,
    /// Samples recorded so far.
    pub samples: u64,
    /// Passes over the picture so far.
    pub passes: f64,
    /// Relative RMSE of a frame with the LIEs so far, against the standard's.
    pub relative_rmse: f64,
    /// Mean FLIP of it.
    pub flip_mean: f64,
    /// Share of its light evaluations that LIEs answered.
    pub trusted_fraction: f64,
    /// Its time; measured once.
    pub frame_ms: f64,
    /// What shadow rays in a hundredth of its pixels say of the LIEs; `None` where there are none.
    pub audit: Option<AuditFigures>,
}

/// An audit of a frame's LIEs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AuditFigures {
    /// Shadow rays that LIEs answer for, and that were traced to see.
    pub rays: u64,
    /// How many the LIEs had wrong.
    pub wrong: u64,
    /// Its time, on as many threads as the frame.
    pub time_ms: f64,
}

impl AuditFigures {
    /// Share of the rays that LIEs had wrong, in `[0, 1]`.
    #[must_use]
    pub fn wrong_fraction(&self) -> f64 {
        self.wrong as f64 / self.rays.max(1) as f64
    }
}

/// A scene in one mode.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergeSummary {
    /// The scene's name.
    pub scene: String,
    /// What it was loaded from.
    pub path: String,
    /// The camera's name.
    pub camera: String,
    /// What is relied on.
    pub mode: Mode,
    /// Threads that rendered.
    pub threads: usize,
    /// Times of the standard's frame.
    pub standard_frame_ms: Spread,
    /// Construction until the view counted as converged; `None` if it did not.
    pub converged_ms: Option<f64>,
    /// Times of a frame with nothing known.
    pub first_frame_ms: Spread,
    /// Its error.
    pub first_frame_relative_rmse: f64,
    /// Time of the last frame.
    pub last_frame_ms: f64,
    /// Its error.
    pub last_frame_relative_rmse: f64,
    /// The largest error of the walk's frames; `None` without a walkthrough or time for it.
    pub worst_walk_relative_rmse: Option<f64>,
    /// Memory of the constructor's tree at the end, evidence included.
    pub lie_bytes: u64,
}

/// All that was measured of a scene.
pub struct Convergence {
    /// The marks of each mode.
    pub rows: Vec<ConvergeRow>,
    /// One for each mode.
    pub summary: Vec<ConvergeSummary>,
    /// The standard's picture.
    pub reference: Film,
}

/// Follows error and frame time of a view in each [`Mode`] while LIEs are constructed from
/// nothing, and then the error along the beginning of a walkthrough.
///
/// # Errors
/// If threads cannot be started.
pub fn converge(
    stage: &Stage,
    walkthrough: Option<&Walkthrough>,
    config: &ConvergeConfig,
    progress: &Progress<'_>,
) -> Result<Convergence, BenchError> {
    let pool = pool(config.threads)?;
    let deadline = Deadline::new(config.limit, Mode::ALL.len());
    let mut starts = race_of_first_frames(stage, config, &pool, progress);
    let firsts = starts.split_off(1);
    let standard = starts.swap_remove(0);
    let mut rows = vec![];
    let mut summary = vec![];
    let bench = Bench {
        stage,
        config,
        pool: &pool,
        standard: &standard,
        progress,
    };
    let mut references = walkthrough.map(WalkReferences::new);
    for ((index, mode), first) in Mode::ALL.into_iter().enumerate().zip(firsts) {
        let course = course::follow(&bench, mode, &first, deadline.of_part(index, 0.6))?;
        let worst = match &mut references {
            None => None,
            Some(references) => {
                walk::worst_error(&bench, mode, references, deadline.of_part(index, 1.0))?
            }
        };
        let mut summed = course.summary;
        summed.worst_walk_relative_rmse = worst;
        rows.extend(course.rows);
        summary.push(summed);
    }
    Ok(Convergence {
        rows,
        summary,
        reference: standard.film,
    })
}

/// What all parts of a measurement share.
struct Bench<'a> {
    stage: &'a Stage,
    config: &'a ConvergeConfig,
    pool: &'a rayon::ThreadPool,
    standard: &'a Runs,
    progress: &'a Progress<'a>,
}

impl Bench<'_> {
    /// Tells how far a part of the work in some mode has come.
    fn tell(&self, mode: Mode, what: &str, share: f32) {
        let name = self.stage.name();
        (self.progress)(&format!("{name}, {}: {what}", mode.name()), share);
    }
}

/// The standard, and after it LIEs that know nothing in each mode.
fn race_of_first_frames(
    stage: &Stage,
    config: &ConvergeConfig,
    pool: &rayon::ThreadPool,
    progress: &Progress<'_>,
) -> Vec<Runs> {
    let nothing = Mode::ALL.map(|mode| {
        let settings = mode.settings(config.construct).lie;
        LieReplica::new(stage.world().clone(), settings).publish()
    });
    let entrants = |stage: &Stage, pool, repeat, progress| {
        let entrant = |what: &str, contender: Contender, lies| Entrant {
            name: format!("{}: {what}", stage.name()),
            render: Box::new(move |tell| contender.render(stage, lies, tell)),
        };
        let mut entrants = vec![entrant("standard", Contender::Standard, None)];
        for (mode, lies) in Mode::ALL.iter().zip(&nothing) {
            let what = format!("first frame, {}", mode.name());
            entrants.push(entrant(&what, Contender::Lie, Some(lies)));
        }
        race(pool, repeat, &entrants, progress)
    };
    // A small one first, to warm up.
    entrants(&stage.thumbnail(), pool, 1, &|_, _| {});
    entrants(stage, pool, config.repeat, progress)
}
