use std::time::Duration;

use clap::{Args, ValueEnum};
use lie_bench::converge::{self, ConvergeConfig};
use lie_farm::ConstructSettings;

use super::subject;

/// How convergence is followed.
#[derive(Args, Clone)]
pub(crate) struct Course {
    /// Ways to construct LIEs, in turn, each from nothing.
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        default_value = "paper,trust",
        value_name = "MODE,MODE,…"
    )]
    modes: Vec<Mode>,
    /// All modes: those that lack one piece of trust show what the piece is worth.
    #[arg(long, conflicts_with = "modes")]
    ablation: bool,
    /// Seconds for each scene's way to convergence, shared out among the modes, where what one
    /// leaves over is for those after it; no step begins after them. By default 150 for
    /// each mode.
    #[arg(long, value_parser = subject::seconds, value_name = "SECONDS")]
    limit: Option<Duration>,
    /// Frames of a walk along the scene's first walkthrough, whose worst error is told; 0 is
    /// none.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=1000), value_name = "N")]
    walk_frames: u32,
}

/// How LIEs are constructed, and what is relied on before it is known well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Mode {
    /// As in the paper: what little is known is relied on (--trust 0).
    Paper,
    /// What enough samples agree on is relied on; the rest is traced.
    Trust,
    /// As trust, but nothing is settled by geometry (--no-proofs).
    NoProofs,
    /// As trust, but the parts of a cell that splits start from nothing (--from-scratch).
    FromScratch,
    /// As trust, but lists of occluders may have any length (--crowd 4294967295).
    NoCrowd,
    /// As trust, but every point is sampled, in the order of space (--in-order).
    InOrder,
}

impl From<Mode> for converge::Mode {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Paper => Self::Paper,
            Mode::Trust => Self::Trust,
            Mode::NoProofs => Self::NoProofs,
            Mode::FromScratch => Self::FromScratch,
            Mode::NoCrowd => Self::NoCrowd,
            Mode::InOrder => Self::InOrder,
        }
    }
}

/// Time that a mode has for a scene, without `--limit`.
const MODE_LIMIT: Duration = Duration::from_secs(150);

impl Course {
    /// What is the same for every scene; the rest is to be filled in.
    pub(super) fn config(&self, construct: ConstructSettings) -> ConvergeConfig {
        let modes = self.modes();
        let limit = MODE_LIMIT * modes.len() as u32;
        ConvergeConfig {
            modes,
            construct,
            threads: 0,
            repeat: 1,
            max_samples: 0,
            walk_frames: self.walk_frames,
            limit: Some(self.limit.unwrap_or(limit)),
        }
    }

    /// Each once, in the order in which they were named.
    fn modes(&self) -> Vec<converge::Mode> {
        if self.ablation {
            return converge::Mode::ALL.to_vec();
        }
        let mut modes = vec![];
        for &mode in &self.modes {
            if !modes.contains(&mode.into()) {
                modes.push(mode.into());
            }
        }
        modes
    }
}
