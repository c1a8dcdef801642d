//! Which shaders are given work. One that let a frame wait and gave nothing is set aside, and
//! tried again later with a single tile, so that a shader that hangs costs one frame a little
//! time, and not every frame.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use crate::scheduler::ShaderId;

/// How long a shader is set aside at first; it doubles up to the last.
const FIRST_PAUSE: Duration = Duration::from_millis(250);
const LAST_PAUSE: Duration = Duration::from_secs(4);

/// The shaders that have let frames wait, from one frame to the next. Of any other nothing is kept.
#[derive(Debug, Default)]
pub(super) struct Standings(BTreeMap<ShaderId, Aside>);

#[derive(Clone, Copy, Debug)]
struct Aside {
    pause: Duration,
    until: Instant,
}

impl Standings {
    /// Whether a shader is to be asked for tiles now.
    pub(super) fn may_work(&self, shader: ShaderId, now: Instant) -> bool {
        self.0.get(&shader).is_none_or(|aside| now >= aside.until)
    }

    /// How many tiles it may have at once, of so many: one that is tried again has one.
    pub(super) fn credits(&self, shader: ShaderId, credits: usize) -> usize {
        if self.0.contains_key(&shader) {
            1
        } else {
            credits
        }
    }

    /// It had tiles until they were late, and finished none. Gives how long it is set aside.
    pub(super) fn failed(&mut self, shader: ShaderId, now: Instant) -> Duration {
        let before = self.0.get(&shader);
        let pause = before.map_or(FIRST_PAUSE, |aside| (2 * aside.pause).min(LAST_PAUSE));
        let until = now + pause;
        self.0.insert(shader, Aside { pause, until });
        pause
    }

    /// It has finished a tile. Says whether that was in doubt.
    pub(super) fn proved(&mut self, shader: ShaderId) -> bool {
        self.0.remove(&shader).is_some()
    }

    /// Forgets those that are gone; numbers are never given twice.
    pub(super) fn keep_only(&mut self, is_there: impl Fn(ShaderId) -> bool) {
        self.0.retain(|&shader, _| is_there(shader));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_fails_waits_twice_as_long_each_time_until_it_has_proved_itself() {
        let (mut standings, mut now) = (Standings::default(), Instant::now());
        assert!(standings.may_work(7, now));
        assert_eq!(standings.credits(7, 4), 4);
        for pause_ms in [250, 500, 1000, 2000, 4000, 4000] {
            let pause = standings.failed(7, now);
            assert_eq!(pause, Duration::from_millis(pause_ms));
            assert!(!standings.may_work(7, now));
            assert!(standings.may_work(8, now));
            now += pause;
            assert!(standings.may_work(7, now));
            assert_eq!(standings.credits(7, 4), 1);
        }
        assert!(standings.proved(7));
        assert!(!standings.proved(7));
        assert_eq!(standings.credits(7, 4), 4);
        assert_eq!(standings.failed(7, now), FIRST_PAUSE);
        standings.keep_only(|shader| shader != 7);
        assert!(standings.may_work(7, now));
    }
}
