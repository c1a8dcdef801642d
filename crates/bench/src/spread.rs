/// What repetitions of one measurement gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The middle one; of an even number, the mean of the two in the middle.
    pub median: f64,
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

impl Spread {
    /// Of nothing that was measured.
    pub(crate) const NONE: Self = Self {
        median: 0.0,
        min: 0.0,
        max: 0.0,
    };

    /// Of some values, in any order; `None` of none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (&min, &max) = (sorted.first()?, sorted.last()?);
        let upper = sorted.len() / 2;
        let median = if sorted.len() % 2 == 1 {
            sorted[upper]
        } else {
            0.5 * (sorted[upper - 1] + sorted[upper])
        };
        Some(Self { median, min, max })
    }
}

/// The smallest of some values that this share of them does not exceed, by nearest rank; `None`
/// of none.
pub(crate) fn percentile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted
        .get(rank.saturating_sub(1).min(sorted.len().saturating_sub(1)))
        .copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_that_there_are() {
        let values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let of = |share| percentile(&values, share);
        assert_eq!(
            (of(0.5), of(0.95), of(0.99)),
            (Some(50.0), Some(95.0), Some(99.0))
        );
        assert_eq!((of(0.0), of(1.0)), (Some(1.0), Some(100.0)));
        assert_eq!(percentile(&[3.0], 0.5), Some(3.0));
        assert_eq!(percentile(&[], 0.5), None);
    }

    #[test]
    fn medians_do_not_depend_on_order() {
        let spread = |values: &[f64]| Spread::of(values).map(|s| (s.median, s.min, s.max));
        assert_eq!(spread(&[]), None);
        assert_eq!(spread(&[3.0]), Some((3.0, 3.0, 3.0)));
        assert_eq!(spread(&[5.0, 1.0]), Some((3.0, 1.0, 5.0)));
        assert_eq!(spread(&[9.0, 1.0, 2.0]), Some((2.0, 1.0, 9.0)));
        assert_eq!(spread(&[4.0, 1.0, 100.0, 2.0]), Some((3.0, 1.0, 100.0)));
    }
}
