use crate::{
    LightPoints, World,
    cell_answers::{CellAnswers, LightAnswer, RayAnswer},
};

/// How likely it is that rays to a light are answered wrongly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayOdds {
    /// Probability that one is.
    pub one: f32,
    /// Probability that two are.
    pub two: f32,
}

/// What depends on a light's rays that the scene is not asked for, as luminance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AtStake {
    /// What is too much if all of them are answered wrongly; below 0, too little.
    pub excess: f64,
    /// Sum of the squares, ray by ray.
    pub squares: f64,
}

impl AtStake {
    fn ray(&mut self, excess: f32) {
        let excess = f64::from(excess);
        self.excess += excess;
        self.squares += excess * excess;
    }
}

/// How far a point's light may be off, since what LIEs rely on may be wrong.
///
/// Each ray that a LIE answers is wrong with some probability, and then by all that it carries:
/// too bright if it is shown, too dark if not. If w are a light's rays and p₁ and p₂ the
/// probabilities that one is wrong and that two are, its error has the mean p₁ Σ w and the mean
/// square p₁ Σ w² + p₂ ((Σ w)² − Σ w²). Lights are wrong independently of each other, so means
/// and variances add up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExpectedError {
    /// Mean of the error, as luminance: above 0 is too bright.
    mean: f64,
    /// Its variance.
    variance: f64,
}

impl ExpectedError {
    /// Takes in a light.
    pub fn add(&mut self, odds: RayOdds, at_stake: AtStake) {
        let AtStake { excess, squares } = at_stake;
        let mean = f64::from(odds.one) * excess;
        let pairs = (excess * excess - squares).max(0.0);
        let square = f64::from(odds.one) * squares + f64::from(odds.two) * pairs;
        self.mean += mean;
        self.variance += (square - mean * mean).max(0.0);
    }

    /// Root of the mean square, as luminance.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.variance + self.mean * self.mean).sqrt()
    }

    /// That of a point in a cell, if `odds` are the probabilities of its lights.
    pub(crate) fn of_point(
        world: &World,
        answers: &CellAnswers<'_>,
        points: &LightPoints<'_>,
        odds: &[RayOdds],
    ) -> Self {
        let mut error = Self::default();
        for light in 0..world.scene().lights.len() as u32 {
            match odds.get(light as usize) {
                Some(&odds) if odds.one > 0.0 => error.add(odds, at_stake(answers, points, light)),
                _ => {}
            }
        }
        error
    }
}

/// What is at stake of a light at a point. What a known occluder withholds is not.
pub(crate) fn at_stake(answers: &CellAnswers<'_>, points: &LightPoints<'_>, light: u32) -> AtStake {
    let mut at_stake = AtStake::default();
    let is_hidden = match answers.of(light) {
        LightAnswer::Traced => return at_stake,
        answer => answer == LightAnswer::Hidden,
    };
    answers.for_each_ray(light, points, |ray, fate| match fate {
        RayAnswer::Shown => at_stake.ray(ray.weight()),
        RayAnswer::Withheld if is_hidden => at_stake.ray(-ray.weight()),
        RayAnswer::Withheld | RayAnswer::Traced => {}
    });
    at_stake
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of lights with one ray each.
    fn rms(lights: &[(f32, f32)]) -> f64 {
        let mut error = ExpectedError::default();
        for &(one, excess) in lights {
            let mut at_stake = AtStake::default();
            at_stake.ray(excess);
            error.add(RayOdds { one, two: one }, at_stake);
        }
        error.rms()
    }

    fn check(found: f64, expected: f64) {
        assert!(
            (found - expected).abs() < 1.0e-6,
            "{found} is not {expected}"
        );
    }

    #[test]
    fn one_ray_is_off_by_all_of_it_or_not_at_all() {
        // E[e²] = p w².
        for (odds, excess) in [(0.25, 3.0), (0.25, -3.0), (1.0, 3.0), (0.0, 3.0)] {
            check(rms(&[(odds, excess)]), f64::from(odds).sqrt() * 3.0);
        }
        check(rms(&[]), 0.0);
    }

    #[test]
    fn errors_in_one_direction_add_up_and_in_two_they_cancel() {
        // Every outcome of two lights, with its probability.
        let brute = |(p, a): (f64, f64), (q, b): (f64, f64)| {
            (p * q * (a + b).powi(2) + p * (1.0 - q) * a * a + (1.0 - p) * q * b * b).sqrt()
        };
        for second in [(0.5, 2.0), (0.5, -2.0)] {
            let expected = brute((0.25, 1.0), (f64::from(second.0), f64::from(second.1)));
            check(rms(&[(0.25, 1.0), second]), expected);
        }
        assert!(rms(&[(0.5, 1.0), (0.5, -1.0)]) < rms(&[(0.5, 1.0), (0.5, 1.0)]));
    }

    #[test]
    fn rays_of_one_light_are_wrong_together_as_often_as_two_are() {
        let of = |two: f32| {
            let mut at_stake = AtStake::default();
            (0..4).for_each(|_| at_stake.ray(0.25));
            let mut error = ExpectedError::default();
            error.add(RayOdds { one: 0.25, two }, at_stake);
            error.rms()
        };
        // Always together: as one ray. Independent: mean ¼, variance 4 (3/16) / 16.
        check(of(0.25), 0.5);
        check(of(0.0625), (0.0625_f64 + 0.75 / 16.0).sqrt());
    }
}
