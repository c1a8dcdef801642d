//! From a cold start to a converged picture: error and frame time against construction.

mod audit;
mod course;
mod deadline;
mod mode;
mod show;
mod walk;

use std::{collections::BTreeMap, time::Duration};

use lie_farm::{ConstructSettings, LieReplica, PublishedLies};
use lie_render::Film;
use lie_scene::Walkthrough;

use self::{deadline::Deadline, walk::WalkReferences};
pub use self::{
    mode::Mode,
    show::{rows_json, section, summary_json, summary_table, table},
};
use crate::{
    BenchError, Contender, Progress, Spread, Stage,
    race::{Entrant, Runs, pool, race},
};

/// What is measured of each scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergeConfig {
    /// In turn, each from nothing.
    pub modes: Vec<Mode>,
    /// Construction, but for what makes a mode.
    pub construct: ConstructSettings,
    /// Threads that render.
    pub threads: usize,
    /// How often the standard's frame and the first ones are timed, in turn.
    pub repeat: u32,
    /// Pixels sampled after which convergence is given up.
    pub max_samples: u64,
    /// Frames of the walk, after the view from which it starts; 0 is no walk.
    pub walk_frames: u32,
    /// Time for a scene, shared out among the modes: no step begins after it. What a mode
    /// leaves over is for those after it.
    pub limit: Option<Duration>,
}

/// A mark on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergeRow {
    /// The scene's name.
    pub scene: String,
    /// How it is constructed.
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
    /// How it is constructed.
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
    /// Share of its light evaluations that LIEs answered.
    pub last_frame_trusted_fraction: f64,
    /// The largest error of the walk's frames; `None` without a walkthrough or time for it.
    pub worst_walk_relative_rmse: Option<f64>,
    /// Memory of the constructor's tree at the end, evidence included.
    pub lie_bytes: u64,
}

impl ConvergeSummary {
    /// How many frames the standard could have rendered until the view counted as converged;
    /// `None` if it did not.
    #[must_use]
    pub fn converged_standard_frames(&self) -> Option<f64> {
        let frame_ms = self.standard_frame_ms.median.max(f64::MIN_POSITIVE);
        self.converged_ms.map(|time| time / frame_ms)
    }
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
    let deadline = Deadline::new(config.limit, config.modes.len());
    let Starts { standard, firsts } = race_of_first_frames(stage, config, &pool, progress);
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
    for (index, &mode) in config.modes.iter().enumerate() {
        let first = &firsts[&trust(mode, config)];
        let course = course::follow(&bench, mode, first, deadline.of_part(index, 0.6))?;
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

/// Where all modes start.
struct Starts {
    standard: Runs,
    /// LIEs that know nothing, by their trust: it is all that makes a difference then.
    firsts: BTreeMap<u32, Runs>,
}

fn trust(mode: Mode, config: &ConvergeConfig) -> u32 {
    mode.settings(config.construct).lie.trust
}

/// The standard, and LIEs that know nothing, in turn.
fn race_of_first_frames(
    stage: &Stage,
    config: &ConvergeConfig,
    pool: &rayon::ThreadPool,
    progress: &Progress<'_>,
) -> Starts {
    let nothing = |&mode: &Mode| {
        let settings = mode.settings(config.construct).lie;
        let lies = LieReplica::new(stage.world().clone(), settings).publish();
        (settings.trust, lies)
    };
    let nothing: BTreeMap<u32, PublishedLies> = config.modes.iter().map(nothing).collect();
    let entrants = |stage: &Stage, pool, repeat, progress| {
        let entrant = |what: &str, contender: Contender, lies| Entrant {
            name: format!("{}: {what}", stage.name()),
            render: Box::new(move |tell| contender.render(stage, lies, tell)),
        };
        let mut entrants = vec![entrant("standard", Contender::Standard, None)];
        for (trust, lies) in &nothing {
            let what = format!("first frame, trust {trust}");
            entrants.push(entrant(&what, Contender::Lie, Some(lies)));
        }
        race(pool, repeat, &entrants, progress)
    };
    // A small one first, to warm up.
    entrants(&stage.thumbnail(), pool, 1, &|_, _| {});
    let mut all = entrants(stage, pool, config.repeat, progress);
    let firsts = all.split_off(1);
    Starts {
        standard: all.swap_remove(0),
        firsts: nothing.into_keys().zip(firsts).collect(),
    }
}
