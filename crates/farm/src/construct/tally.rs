use lie_octree::Observation;

/// What a whole pass showed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Finding {
    /// Relative RMSE of the picture.
    pub(crate) error: f32,
    /// Share of the light evaluations that are in doubt, and traced for that.
    pub(crate) doubtful: f32,
}

/// What one pass showed: one sample in every pixel where something is in doubt.
#[derive(Default)]
pub(super) struct Tally {
    /// Pixels counted so far, those included that show no surface or nothing new.
    pub(super) pixels: u64,
    evaluations: u64,
    trusted: u64,
    /// For each surface point, the luminance that LIEs answer for: as the tree had it, and
    /// as it is.
    luminances: Vec<(f32, f32)>,
}

impl Tally {
    /// Takes in what some points showed.
    pub(super) fn count(&mut self, observations: &[Observation]) {
        self.pixels += observations.len() as u64;
        for seen in observations {
            self.evaluations += u64::from(seen.evaluations);
            self.trusted += u64::from(seen.trusted);
            self.luminances.push((seen.predicted, seen.actual));
        }
    }

    /// Takes in pixels that are not worth a sample, with so many evaluations of lights.
    pub(super) fn skip(&mut self, pixels: u64, evaluated: u64, answered: u64) {
        self.pixels += pixels;
        self.evaluations += evaluated;
        self.trusted += answered;
    }

    /// What a whole pass found, in a picture of which so much luminance is typical, or more.
    pub(super) fn finding(&self, typical: f32) -> Finding {
        Finding {
            error: self.relative_rmse(typical),
            doubtful: 1.0 - self.trusted_share(),
        }
    }

    /// The luminance that a thousandth of the points exceed. Surfaces centimetres from a
    /// lamp would outweigh the whole picture: they count as no more than this.
    fn white(&self) -> f32 {
        let mut actual: Vec<f32> = self.luminances.iter().map(|&(_, actual)| actual).collect();
        let rank = actual.len() * 999 / 1000;
        match actual.get(rank) {
            Some(_) => *actual.select_nth_unstable_by(rank, f32::total_cmp).1,
            None => 0.0,
        }
    }

    /// Mean over all pixels.
    pub(super) fn mean(&self) -> f32 {
        let white = self.white();
        let shown = self
            .luminances
            .iter()
            .map(|&(_, actual)| f64::from(actual.min(white)));
        (shown.sum::<f64>() / self.pixels as f64) as f32
    }

    fn relative_rmse(&self, typical: f32) -> f32 {
        let white = self.white();
        let squared = |&(predicted, actual): &(f32, f32)| {
            f64::from(predicted.min(white) - actual.min(white)).powi(2)
        };
        let sum: f64 = self.luminances.iter().map(squared).sum();
        let rmse = (sum / self.pixels as f64).sqrt() as f32;
        if rmse == 0.0 {
            0.0
        } else {
            rmse / self.mean().max(typical)
        }
    }

    fn trusted_share(&self) -> f32 {
        if self.evaluations == 0 {
            1.0
        } else {
            self.trusted as f32 / self.evaluations as f32
        }
    }
}
