//! How likely it is that what samples say is wrong.

use crate::{Lie, LightEvidence, Mask, Standing};

/// How likely it is that shadow rays from a cell to a light are answered wrongly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Odds {
    /// Probability that the next one is.
    pub one: f32,
    /// Probability that the next two are.
    pub two: f32,
}

impl Lie {
    /// Rays that must agree on a light before shaders rely on it, by its importance so far; on
    /// one without evidence, samples that it carried nothing to.
    #[must_use]
    pub fn needed(&self, light: u32, trust: u32) -> u32 {
        match self.evidence(light) {
            Some(entry) => entry.needed(self.trust_in(light, trust)).ceil() as u32,
            None => trust,
        }
    }

    /// How likely it is that shadow rays from the cell to a light are answered wrongly, as far
    /// as samples answer them: 0 for what is certain, or traced since it is in doubt or crowded.
    ///
    /// Laplace's rule of succession: (k + 1) / (n + 2), where k of n rays were wrong. Of what is
    /// relied on k is 0, of what is masked mostly not. It takes rays for independent draws of
    /// one kind, and every share of wrong ones for as likely as any other before the first.
    #[must_use]
    pub fn odds(&self, light: u32, trust: u32) -> Odds {
        match self.standing(light, trust) {
            Standing::Certain | Standing::Crowded | Standing::Doubtful => Odds::default(),
            Standing::Lit(entry) => entry.odds(),
            // No ray that could have carried anything was ever cast.
            Standing::Hidden => self
                .evidence(light)
                .map_or(succession(0, 0), LightEvidence::odds),
        }
    }
}

impl LightEvidence {
    /// How likely it is that the next rays meet something else than shaders make of it.
    fn odds(&self) -> Odds {
        match self.mask {
            None => succession(0, self.agreed),
            Some(Mask::LeftOut) => succession(self.clear, self.own_rays()),
            Some(Mask::Whole) => succession(self.blocked, self.own_rays()),
        }
    }
}

/// How likely it is that the next rays are of one kind, if so many of so many were.
fn succession(of_kind: u16, rays: u16) -> Odds {
    let (of_kind, rays) = (f32::from(of_kind), f32::from(rays));
    let one = (of_kind + 1.0) / (rays + 2.0);
    Odds {
        one,
        two: one * (of_kind + 2.0) / (rays + 3.0),
    }
}

#[cfg(test)]
mod tests;
