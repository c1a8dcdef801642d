//! What there is to learn of a cell.

use crate::{Lie, Standing};

/// What more samples of a cell may be worth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Doubt {
    /// Share of a pixel's light, in `[0, 1]`, that shaders ask the scene for and may not have to:
    /// each light's contribution times what its evidence lacks.
    pub share: f32,
    /// Lights that could light the cell and are answered for, by proof or by evidence.
    pub answered: u32,
}

/// The least contribution that evidence tells from none.
const LEAST: f32 = 1.0 / 255.0;

impl Doubt {
    /// Of a place that nothing is known of.
    pub const WHOLE: Self = Self {
        share: 1.0,
        answered: 0,
    };
}

impl Lie {
    /// What more samples may be worth, in a scene of so many lights. In the paper's mode, where
    /// `trust` is 0 and every sample counts the same, by the rule of three: all that is
    /// unknown of a cell that was never sampled, and never nothing.
    #[must_use]
    pub fn doubt(&self, trust: u32, lights: u32) -> Doubt {
        if trust == 0 {
            let samples = self.samples() as f32;
            return Doubt {
                share: 3.0 / (samples + 3.0),
                answered: self.lights().count() as u32,
            };
        }
        if self.samples() == 0 && self.region().bounds.is_empty() {
            return Doubt::WHOLE;
        }
        let mut doubt = Doubt::default();
        for light in 0..lights {
            let (share, is_answered) = self.doubt_of(light, trust);
            doubt.share += share;
            doubt.answered += u32::from(is_answered);
        }
        doubt.share = doubt.share.min(1.0);
        doubt
    }

    /// A light's part of it, and whether it is answered for.
    fn doubt_of(&self, light: u32, trust: u32) -> (f32, bool) {
        match (self.standing(light, trust), self.evidence(light)) {
            (Standing::Certain | Standing::Lit(_), _) => (0.0, true),
            (Standing::Hidden, evidence) => (0.0, evidence.is_some()),
            (Standing::Crowded, Some(entry)) if entry.is_past_listing() => (0.0, true),
            (Standing::Crowded | Standing::Doubtful, Some(entry)) => {
                let needed = entry.needed(self.trust_in(light, trust)).max(1.0);
                let lacking = 1.0 - (f32::from(entry.agreed) / needed).min(1.0);
                (f32::from(entry.importance) / 255.0 * lacking, false)
            }
            // No sample so far had anything of it.
            (Standing::Crowded | Standing::Doubtful, None) => {
                (LEAST / (self.dark() as f32 + 1.0), false)
            }
        }
    }
}

#[cfg(test)]
mod tests;
