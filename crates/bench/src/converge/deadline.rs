use std::time::{Duration, Instant};

/// When a scene's time is over, and the time of its parts.
pub(super) struct Deadline {
    start: Instant,
    limit: Option<Duration>,
    modes: usize,
}

impl Deadline {
    /// From now on, shared out equally among the modes.
    pub(super) fn new(limit: Option<Duration>, modes: usize) -> Self {
        Self {
            start: Instant::now(),
            limit,
            modes,
        }
    }

    /// When a share, in `[0, 1]`, of a mode's part is over; `None` is never.
    pub(super) fn of_part(&self, mode: usize, share: f32) -> Option<Instant> {
        let parts = (mode as f32 + share) / self.modes as f32;
        self.limit.map(|limit| self.start + limit.mul_f32(parts))
    }
}

/// Whether a time is over.
pub(super) fn is_over(end: Option<Instant>) -> bool {
    end.is_some_and(|end| Instant::now() >= end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_each_other() {
        let deadline = Deadline::new(Some(Duration::from_secs(100)), 2);
        let after =
            |mode, share| (deadline.of_part(mode, share).unwrap() - deadline.start).as_secs_f32();
        assert!((after(0, 0.6) - 30.0).abs() < 0.01);
        assert!((after(0, 1.0) - 50.0).abs() < 0.01);
        assert!((after(1, 1.0) - 100.0).abs() < 0.01);
        assert!(!is_over(Deadline::new(None, 2).of_part(0, 0.0)));
        assert!(is_over(
            Deadline::new(Some(Duration::ZERO), 2).of_part(0, 0.0)
        ));
    }
}
