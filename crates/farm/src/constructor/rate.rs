use std::{collections::VecDeque, time::Instant};

/// Notes that a rate is taken from.
const NOTES: usize = 6;

/// A counter at some moments.
#[derive(Default)]
pub(super) struct Rate(VecDeque<(Instant, u64)>);

impl Rate {
    pub(super) fn note(&mut self, now: Instant, count: u64) {
        if self.0.len() == NOTES {
            self.0.pop_front();
        }
        self.0.push_back((now, count));
    }

    pub(super) fn per_s(&self) -> f32 {
        let (Some(&(from, before)), Some(&(to, after))) = (self.0.front(), self.0.back()) else {
            return 0.0;
        };
        let seconds = (to - from).as_secs_f32();
        if seconds > 0.0 {
            after.saturating_sub(before) as f32 / seconds
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_rate_is_of_the_last_seconds() {
        let (mut rate, start) = (Rate::default(), Instant::now());
        assert_eq!(rate.per_s(), 0.0);
        rate.note(start, 7);
        assert_eq!(rate.per_s(), 0.0);
        for second in 1..=20 {
            rate.note(start + Duration::from_secs(second), 7 + 100 * second);
        }
        assert!((rate.per_s() - 100.0).abs() < 0.01);
        for second in 21..=40 {
            rate.note(start + Duration::from_secs(second), 2007);
        }
        assert_eq!(rate.per_s(), 0.0);
    }
}
