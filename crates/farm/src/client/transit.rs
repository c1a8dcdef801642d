//! How many tiles a shader is to have at once, so that it has the next one when it is done with
//! one, however far away it is.

use std::{collections::BTreeMap, time::Duration};

use lie_protocol::WireCost;

use crate::scheduler::ShaderId;

/// Tiles for each thread: one in work, and one that waits.
const NEAR: f64 = 2.0;
/// As many as a shader takes for each thread.
const FAR: f64 = 8.0;
/// Share of what is newest in what is remembered.
const NEWEST: f64 = 0.2;
/// The same of a way that has become longer.
const RISE: f64 = 0.05;

/// How long tiles are on their way, from one frame to the next.
#[derive(Debug, Default)]
pub(super) struct Transits(BTreeMap<ShaderId, Transit>);

/// Of the last tiles, in seconds.
#[derive(Clone, Copy, Debug)]
struct Transit {
    /// From the request until the tile was back, without the time at the shader: about the least
    /// that there was. What more it takes is a queue on the way, which more tiles would make longer.
    way: f64,
    /// Of work, in the mean.
    work: f64,
}

impl Transits {
    /// A tile came so long after it was asked for, and cost this.
    pub(super) fn note(&mut self, shader: ShaderId, held: Duration, cost: &WireCost) {
        let seconds = |nanoseconds: u64| 1.0e-9 * nanoseconds as f64;
        let work = seconds(cost.render_ns) + seconds(cost.pack_ns);
        if work == 0.0 {
            // Nothing was said of its cost, and nothing follows.
            return;
        }
        let way = (held.as_secs_f64() - work - seconds(cost.queued_ns)).max(0.0);
        let now = Transit { way, work };
        let mean = self.0.entry(shader).or_insert(now);
        mean.way = now.way.min(mean.way + RISE * (now.way - mean.way));
        mean.work += NEWEST * (now.work - mean.work);
    }

    /// Tiles that a shader of so many threads is to have at once, of a frame that has so many for each
    /// thread there is: more than its share would be missed by the others.
    pub(super) fn credits(&self, shader: ShaderId, threads: u32, share: usize) -> usize {
        let on_the_way = self.0.get(&shader).map_or(0.0, |mean| {
            // A tile that takes no time is as short as a microsecond.
            mean.way / mean.work.max(1.0e-6)
        });
        // What is on its way for less than half a tile's time is covered by the one that waits.
        let wanted = (NEAR + (on_the_way - 0.5).max(0.0).ceil()).min(FAR);
        let each = (wanted as usize).min(share.max(NEAR as usize));
        each * threads as usize
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
    fn who_is_far_away_has_more_tiles_on_their_way_and_never_more_than_its_share() {
        let cost = |ms: u64| WireCost {
            render_ns: 1_000_000 * ms,
            queued_ns: 7_000_000,
            ..WireCost::default()
        };
        let mut transits = Transits::default();
        assert_eq!(transits.credits(1, 3, 100), 6);
        // 1 ms on its way for 4 ms of work; 20 ms; and 1 s.
        for (shader, held_ms) in [(1, 12), (2, 31), (3, 1011)] {
            transits.note(shader, Duration::from_millis(held_ms), &cost(4));
        }
        let credits = |shader, share| transits.credits(shader, 1, share);
        assert_eq!([1, 2, 3].map(|shader| credits(shader, 100)), [2, 7, 8]);
        assert_eq!([1, 2, 3].map(|shader| credits(shader, 4)), [2, 4, 4]);
        assert_eq!([1, 2, 3].map(|shader| credits(shader, 0)), [2, 2, 2]);
        transits.note(2, Duration::from_millis(11), &cost(4));
        assert_eq!(transits.credits(2, 1, 100), 2, "there was no queue");
        transits.note(2, Duration::from_millis(31), &cost(4));
        assert_eq!(transits.credits(2, 1, 100), 2, "once is a queue");
        for _ in 0..100 {
            transits.note(2, Duration::from_millis(31), &cost(4));
        }
        assert_eq!(transits.credits(2, 1, 100), 7, "it has gone away");
        transits.keep_only(|_| false);
        assert_eq!(transits.credits(3, 1, 100), 2);
    }
}
