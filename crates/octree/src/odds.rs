//! How likely it is that what samples say is wrong.

use crate::{Lie, LightEvidence, Mask, Standing};

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

    /// Probability that a shadow ray from the cell to a light is answered wrongly, as far as
    /// samples answer it: 0 for what is certain, or traced since it is in doubt or crowded.
    ///
    /// Laplace's rule of succession: (k + 1) / (n + 2), where k of n rays were wrong. Of what is
    /// relied on k is 0, of what is masked mostly not. It takes rays for independent draws of
    /// one kind, and every share of wrong ones for as likely as any other before the first.
    #[must_use]
    pub fn odds(&self, light: u32, trust: u32) -> f32 {
        match self.standing(light, trust) {
            Standing::Certain | Standing::Crowded | Standing::Doubtful => 0.0,
            Standing::Lit(entry) => entry.odds(),
            // No ray that could have carried anything was ever cast.
            Standing::Hidden => self
                .evidence(light)
                .map_or(succession(0, 0), LightEvidence::odds),
        }
    }
}

impl LightEvidence {
    /// Probability that the next ray meets something else than shaders make of it.
    fn odds(&self) -> f32 {
        match self.mask {
            None => succession(0, self.agreed),
            Some(Mask::LeftOut) => succession(self.clear, self.own_rays()),
            Some(Mask::Whole) => succession(self.blocked, self.own_rays()),
        }
    }
}

/// Probability that the next of some rays is of one kind, of which so many of them were.
fn succession(of_kind: u16, rays: u16) -> f32 {
    (f32::from(of_kind) + 1.0) / (f32::from(rays) + 2.0)
}

#[cfg(test)]
mod tests;
