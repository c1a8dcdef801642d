//! What there is to learn of a cell.

use crate::{Lie, Standing};

/// What more samples of a cell may be worth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Doubt {
    /// Share of a pixel's light, in `[0, 1]`, that shaders ask the scene for and may not have to:
    /// each light's contribution times what its evidence lacks.
    pub share: f32,
    /// Lights that may light the cell, as far as is known.
    pub evaluated: u32,
    /// How many of them are answered for, by proof or by evidence.
    pub answered: u32,
}

/// The least contribution that evidence tells from none.
const LEAST: f32 = 1.0 / 255.0;

/// What a light is taken to contribute that may reach a cell and was never asked: the least that
/// trust is measured by.
const UNASKED: f32 = 1.0 / 16.0;

impl Doubt {
    /// Of a place that nothing is known of.
    pub const WHOLE: Self = Self {
        share: 1.0,
        evaluated: 0,
        answered: 0,
    };
}

impl Lie {
    /// What samples may be worth that ask some `lights`, in a scene of so many. In the paper's
    /// mode, where `trust` is 0 and every sample counts the same, by the rule of three: all
    /// that is unknown of a cell that was never sampled, and never nothing.
    #[must_use]
    pub fn doubt(&self, trust: u32, lights: u32, asks: impl Fn(u32) -> bool) -> Doubt {
        if trust == 0 {
            let (samples, lit) = (self.samples() as f32, self.lights().count() as u32);
            return Doubt {
                share: 3.0 / (samples + 3.0),
                evaluated: lit,
                answered: lit,
            };
        }
        if self.samples() == 0 && self.region().bounds.is_empty() {
            return Doubt::WHOLE;
        }
        let mut doubt = Doubt::default();
        for light in 0..lights {
            let (share, is_evaluated, is_answered) = self.doubt_of(light, trust);
            doubt.share += if asks(light) { share } else { 0.0 };
            doubt.evaluated += u32::from(is_evaluated);
            doubt.answered += u32::from(is_answered);
        }
        doubt.share = doubt.share.min(1.0);
        doubt
    }

    /// A light's part of it, whether it may light the cell, and whether it is answered for.
    fn doubt_of(&self, light: u32, trust: u32) -> (f32, bool, bool) {
        match (self.standing(light, trust), self.evidence(light)) {
            (Standing::Certain | Standing::Lit(_), _) => (0.0, true, true),
            (Standing::Hidden, evidence) => (0.0, evidence.is_some(), evidence.is_some()),
            (Standing::Crowded, Some(entry)) if entry.is_past_listing() => (0.0, true, true),
            (Standing::Crowded | Standing::Doubtful, Some(entry)) => {
                let needed = entry.needed(self.trust_in(light, trust)).max(1.0);
                let lacking = 1.0 - (f32::from(entry.agreed) / needed).min(1.0);
                (f32::from(entry.importance) / 255.0 * lacking, true, false)
            }
            (Standing::Crowded | Standing::Doubtful, None) => match self.region().proof(light) {
                Some(_) => (UNASKED, true, false),
                // No sample so far had anything of it.
                None => (LEAST / (self.dark() as f32 + 1.0), false, false),
            },
        }
    }
}

#[cfg(test)]
mod tests;
