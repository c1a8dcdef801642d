use crate::{LieSettings, LightEvidence, Mask, Observation};

/// Own rays to a light from a cell below which it is never masked, whatever the trust.
const ENOUGH: u16 = 32;

/// The least that a cell's samples show: what Weber's law holds masked lights against.
///
/// The paper keeps each light's minimum and adds them up (LIE §5). The minimum of the sums
/// is at least as large, and no less of a bound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shown {
    /// Luminance of the darkest sample, all lights together; `None` before the first.
    pub(crate) least: Option<f32>,
}

impl Shown {
    /// Takes in a sample.
    pub(crate) fn record(&mut self, seen: &Observation) {
        let luminance: f32 = seen.outcomes.iter().map(|outcome| outcome.luminance).sum();
        self.least = Some(self.least.map_or(luminance, |least| least.min(luminance)));
    }

    /// Luminance of the darkest sample; 0 before the first.
    pub(crate) fn least(self) -> f32 {
        self.least.unwrap_or(0.0)
    }

    /// Marks the lights whose shadows the others mask: from the one that errs least at worst
    /// on, while all of them together err by no more than a fraction of what the darkest
    /// sample shows (LIE §5). Only lights that are known to reach the cell past something, and
    /// well enough, may be masked. Everything is decided anew each time.
    pub(crate) fn mask(self, lights: &mut [LightEvidence], settings: &LieSettings) {
        for entry in lights.iter_mut() {
            entry.mask = None;
        }
        if settings.masking <= 0.0 {
            return;
        }
        let limit = f64::from(settings.masking) * f64::from(self.least());
        let may_be_masked = |entry: &&mut LightEvidence| {
            let agreed = entry.agreed.min(entry.own_rays());
            let is_known = agreed >= ENOUGH && entry.is_enough(agreed, settings.trust);
            // Without occluders it costs no ray.
            is_known && entry.is_lit() && !entry.crowded && !entry.occluders.is_empty()
        };
        let mut faint: Vec<&mut LightEvidence> = lights.iter_mut().filter(may_be_masked).collect();
        for entry in &mut faint {
            entry.mask = Some(entry.better_mask());
        }
        // Stable: of equal lights the one with the lower number goes first.
        faint.sort_by(|a, b| a.masked_error().total_cmp(&b.masked_error()));
        let mut error = 0.0;
        for entry in faint {
            error += entry.masked_error();
            if error > limit {
                entry.mask = None;
            }
        }
    }
}

impl LightEvidence {
    /// The mask that is wrong for fewer rays.
    fn better_mask(&self) -> Mask {
        if self.blocked > self.clear {
            Mask::LeftOut
        } else {
            Mask::Whole
        }
    }

    /// The largest luminance by which its mask is wrong anywhere, as far as is known; 0
    /// without one.
    pub(crate) fn masked_error(&self) -> f64 {
        f64::from(match self.mask {
            None => 0.0,
            Some(Mask::LeftOut) => self.most,
            Some(Mask::Whole) => self.withheld,
        })
    }
}
