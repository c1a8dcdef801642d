//! Other programs beside ours: the same view of the same plain scene, in turn.
//!
//! An [`Opponent`] is measured through its command line ([`Harness`]), from a file in a flat format
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

/// The other program, with its scene and what it makes of it.
pub struct Opponent<'a> {
    config: &'a PeersConfig,
    peer: Peer<'a>,
    references: References,
}

impl<'a> Opponent<'a> {
    /// Writes the view of a [`plain`] scene for the other program, and lets that render its
    /// pictures, which are not timed: what is wrong with it shows here.
    ///
    /// # Errors
    /// [`BenchError::Peer`] if the other program cannot be run, fails or is not understood, or if
    /// the scene cannot be written.
    pub fn new(
        stage: &'a Stage,
        config: &'a PeersConfig,
        progress: &Progress<'_>,
    ) -> Result<Self, BenchError> {
        progress(&format!("{}: embree's pictures", stage.name()), 0.0);
        let peer = Peer::new(stage)?;
        let references = References::render(&peer, config)?;
        Ok(Self {
            config,
            peer,
            references,
        })
    }

    /// Lets the other program and ours render in turn: the plain view that the former has, and
    /// the scene as it is.
    ///
    /// # Errors
    /// [`BenchError::Peer`] if the other program fails; if threads cannot be started.
    pub fn measure(
        &self,
        plain: Show<'_>,
        as_it_is: Show<'_>,
        progress: &Progress<'_>,
    ) -> Result<SceneContest, BenchError> {
        let mut contest = SceneContest::default();
        for &threads in &self.config.threads {
            let pool = pool(threads)?;
            let shows = [plain, as_it_is];
            let rounds = Rounds::run(&self.peer, shows, &pool, self.config, progress)?;
            let mut judged = rounds.judge(&self.references)?;
            ratios::mark_best(&mut judged);
            contest.ratios.extend(ratios::of(&judged));
            contest
                .rows
                .extend(judged.into_iter().map(|judged| judged.row));
        }
        Ok(contest)
    }
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
