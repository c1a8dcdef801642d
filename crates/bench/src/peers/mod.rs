//! Other programs beside ours: the same view of the same plain scene, in turn.
//!
//! A program is measured through its command line ([`Harness`]), from a file in a flat format
//! ([`write_flat`]). What it renders is a [`plain`] scene; ours are timed with that scene, which
//! is a comparison, and with the scene as it is, which says what the rest costs.

mod closest_hits;
mod difference;
mod flat_file;
mod harness;
mod plain;
mod ratios;
mod round;
mod show;

use lie_scene::LightKind;

pub use self::{
    difference::Difference,
    flat_file::{SIDE_STEP, write_flat},
    harness::{Clean, Harness, PeerError},
    plain::{PlainScene, plain},
    show::{json, ratio_table, ratios_json, section, table},
};
use self::{
    difference::References,
    round::{Peer, Rounds},
};
use crate::{BenchError, Contender, Lineup, Progress, Spread, Stage, race::pool};

/// Who of ours takes part.
pub const CONTENDERS: &[Contender] = &[Contender::Standard, Contender::Lie];

/// What is measured.
#[derive(Clone, Debug)]
pub struct PeersConfig {
    /// The other program.
    pub harness: Harness,
    /// Its variants, by name.
    pub variants: Vec<String>,
    /// Numbers of threads, one measurement for each.
    pub threads: Vec<usize>,
    /// Rounds, in each of which every one renders a frame.
    pub repeat: u32,
}

/// Which scene a picture is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// The [`plain`] one.
    Plain,
    /// As it was loaded.
    AsItIs,
}

impl Version {
    /// Its name in tables and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::AsItIs => "as it is",
        }
    }
}

/// A view in one version, with what ours need for it.
#[derive(Clone, Copy)]
pub struct Show<'a> {
    /// Which.
    pub version: Version,
    /// The view.
    pub stage: &'a Stage,
    /// [`CONTENDERS`], with their LIEs.
    pub lineup: &'a Lineup,
}

/// One of ours, or a variant of the other program, on so many threads.
#[derive(Clone, Debug, PartialEq)]
pub struct PeerRow {
    /// The scene's name.
    pub scene: String,
    /// Which scene.
    pub version: Version,
    /// `embree` and a variant, or one of ours.
    pub who: String,
    /// Whether it is the other program's fastest variant with packets of shadow rays.
    pub is_best: bool,
    /// Threads.
    pub threads: usize,
    /// Times of the frame alone.
    pub frame_ms: Spread,
    /// Shadow rays, or primary ones of those that trace no others.
    pub rays: u64,
    /// Frames that the other program counted as undisturbed; `None` of ours.
    pub clean: Option<Clean>,
    /// How far it is from the other program's picture; `None` of another scene's.
    pub from_peer: Option<Difference>,
    /// Relative RMSE against our standard's picture of that scene; `None` for others than ours.
    pub relative_rmse: Option<f64>,
}

/// One time divided by another, round by round.
#[derive(Clone, Debug, PartialEq)]
pub struct PeerRatio {
    /// The scene's name.
    pub scene: String,
    /// Which scene ours are of.
    pub version: Version,
    /// Threads.
    pub threads: usize,
    /// Whose time is divided.
    pub over: String,
    /// By whose.
    pub under: String,
    /// Whether the former is the other program's fastest variant with packets of shadow rays.
    pub is_best: bool,
    /// The ratio.
    pub ratio: Spread,
    /// How far our picture is from the other program's; `None` of another scene's.
    pub from_peer: Option<Difference>,
    /// Relative RMSE of our picture against our standard's; `None` for primary rays.
    pub relative_rmse: Option<f64>,
}

/// All that was measured of a view.
#[derive(Clone, Debug, Default)]
pub struct SceneContest {
    /// Times and errors.
    pub rows: Vec<PeerRow>,
    /// Ratios.
    pub ratios: Vec<PeerRatio>,
}

/// Lets the other program and ours render a view in turn. The first of `shows` is the plain
/// scene, which the other program gets.
///
/// # Errors
/// [`BenchError::Peer`] if the other program cannot be run, fails or is not understood; if threads
/// cannot be started.
pub fn measure(
    plain: Show<'_>,
    as_it_is: Show<'_>,
    config: &PeersConfig,
    progress: &Progress<'_>,
) -> Result<SceneContest, BenchError> {
    let peer = Peer::new(plain.stage, config)?;
    progress(
        &format!("{}: the other program's pictures", plain.stage.name()),
        0.0,
    );
    let references = References::render(&peer, config)?;
    let mut contest = SceneContest::default();
    for &threads in &config.threads {
        let pool = pool(threads)?;
        let rounds = Rounds::run(&peer, [plain, as_it_is], &pool, config, progress)?;
        let mut judged = rounds.judge(&references)?;
        ratios::mark_best(&mut judged);
        contest.ratios.extend(ratios::of(&judged));
        contest
            .rows
            .extend(judged.into_iter().map(|judged| judged.row));
    }
    Ok(contest)
}

/// Sample points along each side of an area light.
fn area_side(stage: &Stage) -> u32 {
    stage.settings().light_samples.isqrt()
}

/// Whether samples on lights make its pictures noisy.
fn has_area_lights(stage: &Stage) -> bool {
    let lights = &stage.world().scene().lights;
    lights
        .iter()
        .any(|light| matches!(light.kind, LightKind::Area(_)))
}
