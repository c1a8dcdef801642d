use crate::{
    LightPoints,
    cell_answers::{CellAnswers, LightAnswer, RayAnswer},
    luminance,
};

/// How far a point's light may be off, since what LIEs rely on may be wrong.
///
/// Each light that is relied on is wrong with some probability p, and then by all the light
/// at stake, w: too bright if it is shown, too dark if it is hidden. Its error has the mean
/// ± p w and the variance p (1 − p) w². Lights are wrong independently of each other, so both
/// add up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExpectedError {
    /// Mean of the error, as luminance: above 0 is too bright.
    mean: f64,
    /// Its variance.
    variance: f64,
}

impl ExpectedError {
    /// Takes in a light that is wrong with a probability in `[0, 1]`, and then adds so much
    /// luminance too much; below 0, too little.
    pub fn add(&mut self, probability: f32, excess: f32) {
        let (probability, excess) = (f64::from(probability), f64::from(excess));
        self.mean += probability * excess;
        self.variance += probability * (1.0 - probability) * excess * excess;
    }

    /// Root of the mean square, as luminance.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.variance + self.mean * self.mean).sqrt()
    }
}

/// Luminance that a point has too much if all rays to a light are wrong that the scene is not
/// asked for; below 0, what it has too little. What a known occluder withholds is not at stake.
pub(crate) fn at_stake(answers: &CellAnswers<'_>, points: &LightPoints<'_>, light: u32) -> f32 {
    let (mut shown, mut hidden) = (0.0, 0.0);
    let is_hidden = match answers.of(light) {
        LightAnswer::Traced => return 0.0,
        answer => answer == LightAnswer::Hidden,
    };
    answers.for_each_ray(light, points, |ray, fate| match fate {
        RayAnswer::Shown => shown += luminance(ray.radiance),
        RayAnswer::Withheld if is_hidden => hidden += luminance(ray.radiance),
        RayAnswer::Withheld | RayAnswer::Traced => {}
    });
    shown - hidden
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rms(lights: &[(f32, f32)]) -> f64 {
        let mut error = ExpectedError::default();
        for &(probability, excess) in lights {
            error.add(probability, excess);
        }
        error.rms()
    }

    #[test]
    fn one_light_is_off_by_all_of_it_or_not_at_all() {
        // E[e²] = p w².
        for (probability, excess) in [(0.25, 3.0), (0.25, -3.0), (1.0, 3.0), (0.0, 3.0)] {
            let expected = f64::from(probability).sqrt() * 3.0;
            let found = rms(&[(probability, excess)]);
            assert!(
                (found - expected).abs() < 1.0e-6,
                "{found} is not {expected}"
            );
        }
        assert_eq!(rms(&[]), 0.0);
    }

    #[test]
    fn errors_in_one_direction_add_up_and_in_two_they_cancel() {
        // Every outcome of two lights, with its probability.
        let brute = |(p, a): (f64, f64), (q, b): (f64, f64)| {
            (p * q * (a + b).powi(2) + p * (1.0 - q) * a * a + (1.0 - p) * q * b * b).sqrt()
        };
        for second in [(0.5, 2.0), (0.5, -2.0)] {
            let found = rms(&[(0.25, 1.0), second]);
            let expected = brute((0.25, 1.0), (f64::from(second.0), f64::from(second.1)));
            assert!(
                (found - expected).abs() < 1.0e-6,
                "{found} is not {expected}"
            );
        }
        assert!(rms(&[(0.5, 1.0), (0.5, -1.0)]) < rms(&[(0.5, 1.0), (0.5, 1.0)]));
    }
}
