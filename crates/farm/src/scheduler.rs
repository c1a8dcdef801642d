//! Who renders which tile of a frame. No IO and no clock: `now` is passed in.

use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    time::{Duration, Instant},
};

/// A shader, as the client numbers them.
pub type ShaderId = u32;

/// When a tile is late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatePolicy {
    /// No tile is late before this.
    pub floor: Duration,
    /// A tile is late after this many times the mean time of the finished ones.
    pub factor: f64,
}

impl Default for LatePolicy {
    fn default() -> Self {
        Self {
            floor: Duration::from_millis(100),
            factor: 3.0,
        }
    }
}

/// What became of a tile that a shader has finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completion {
    /// It is the first: take it.
    First,
    /// Another was faster, or it was never asked for: drop it.
    Duplicate,
}

/// The tiles of one frame on their way.
///
/// Invariants: a tile is either waiting, in flight at one shader or more, or done, and is
/// done exactly once; a shader that has as many in flight as its credits is given none.
///
/// ```
/// use lie_farm::scheduler::{Completion, LatePolicy, Scheduler};
/// use std::time::Instant;
///
/// let now = Instant::now();
/// let mut scheduler = Scheduler::new([0, 1, 2], LatePolicy::default());
/// scheduler.joined(7, 2);
/// assert_eq!(scheduler.assign(now), [(7, 0), (7, 1)]);
/// assert_eq!(scheduler.completed(0, 7, now), Completion::First);
/// assert_eq!(scheduler.assign(now), [(7, 2)]);
/// ```
#[derive(Clone, Debug)]
pub struct Scheduler {
    waiting: VecDeque<u32>,
    /// Where and since when each unfinished tile is in flight, the newest holder last.
    in_flight: BTreeMap<u32, Vec<(ShaderId, Instant)>>,
    unfinished: BTreeSet<u32>,
    /// Who could not render each of these tiles.
    failures: BTreeMap<u32, BTreeSet<ShaderId>>,
    /// Those of them that wait for somebody else.
    again: BTreeSet<u32>,
    shaders: BTreeMap<ShaderId, Shader>,
    policy: LatePolicy,
    finished_time: Duration,
    finished: u32,
    lost: u64,
    reissued: u64,
}

#[derive(Clone, Debug)]
struct Shader {
    credits: usize,
    /// What it has not answered, since when; others may have finished it.
    tiles: BTreeMap<u32, Instant>,
    /// When it was given its first tile.
    oldest: Option<Instant>,
    /// It is only asked in need.
    is_reserve: bool,
    /// It has answered, in time or not.
    has_finished: bool,
}

impl Shader {
    /// Whether it has little to do, and may be asked.
    fn is_idle(&self, in_need: bool) -> bool {
        self.tiles.len() < self.credits.div_ceil(2) && (in_need || !self.is_reserve)
    }
}

impl Scheduler {
    /// A frame whose tiles are handed out in this order.
    #[must_use]
    pub fn new(order: impl IntoIterator<Item = u32>, policy: LatePolicy) -> Self {
        let waiting: VecDeque<u32> = order.into_iter().collect();
        Self {
            unfinished: waiting.iter().copied().collect(),
            waiting,
            in_flight: BTreeMap::new(),
            failures: BTreeMap::new(),
            again: BTreeSet::new(),
            shaders: BTreeMap::new(),
            policy,
            finished_time: Duration::ZERO,
            finished: 0,
            lost: 0,
            reissued: 0,
        }
    }

    /// A shader is there, now or from the start; `credits` are the most tiles it may have
    /// in flight, at least one.
    pub fn joined(&mut self, shader: ShaderId, credits: usize) {
        self.shaders.entry(shader).or_insert(Shader {
            credits: credits.max(1),
            tiles: BTreeMap::new(),
            oldest: None,
            is_reserve: false,
            has_finished: false,
        });
    }

    /// A shader is there that is not relied on: it gets a tile at a time, and only once every
    /// other one has let a tile become late.
    pub fn joined_in_reserve(&mut self, shader: ShaderId) {
        self.joined(shader, 1);
        if let Some(shader) = self.shaders.get_mut(&shader) {
            shader.is_reserve = true;
        }
    }

    /// A shader that is there and relied on may have so many tiles in flight from now on, at least
    /// one; what it has, it keeps.
    pub fn has_credits(&mut self, shader: ShaderId, credits: usize) {
        let shader = self.shaders.get_mut(&shader);
        if let Some(shader) = shader.filter(|shader| !shader.is_reserve) {
            shader.credits = credits.max(1);
        }
    }

    /// How long a shader has had a tile that it has not answered.
    #[must_use]
    pub fn held(&self, tile: u32, shader: ShaderId, now: Instant) -> Option<Duration> {
        let since = self.shaders.get(&shader)?.tiles.get(&tile)?;
        Some(now.saturating_duration_since(*since))
    }

    /// Whether a shader in reserve has nothing to do; when it is needed is for
    /// [`Self::assign`] to find out, and is no [`Self::next_deadline`].
    #[must_use]
    pub fn has_reserves(&self) -> bool {
        let mut shaders = self.shaders.values();
        shaders.any(|shader| shader.is_reserve && shader.tiles.is_empty())
    }

    /// A shader is gone: its tiles go to the front of the queue, unless another has them too.
    pub fn lost(&mut self, shader: ShaderId) {
        let Some(gone) = self.shaders.remove(&shader) else {
            return;
        };
        for &tile in gone.tiles.keys().rev() {
            self.lost += 1;
            if let Some(holders) = self.in_flight.get_mut(&tile) {
                holders.retain(|&(holder, _)| holder != shader);
                if holders.is_empty() {
                    self.in_flight.remove(&tile);
                    if self.failures.contains_key(&tile) {
                        self.again.insert(tile);
                    } else {
                        self.waiting.push_front(tile);
                    }
                }
            }
        }
    }

    /// Whether [`Self::completed`] would take this tile from that shader.
    #[must_use]
    pub fn wants(&self, tile: u32, shader: ShaderId) -> bool {
        let holders = self.in_flight.get(&tile).map_or(&[][..], Vec::as_slice);
        holders.iter().any(|&(holder, _)| holder == shader)
    }

    /// A tile has come back.
    pub fn completed(&mut self, tile: u32, shader: ShaderId, now: Instant) -> Completion {
        if let Some(shader) = self.shaders.get_mut(&shader) {
            shader.has_finished |= shader.tiles.remove(&tile).is_some();
        }
        let holders = self.in_flight.get(&tile).map_or(&[][..], Vec::as_slice);
        let Some(&(_, since)) = holders.iter().find(|&&(holder, _)| holder == shader) else {
            return Completion::Duplicate;
        };
        self.in_flight.remove(&tile);
        self.unfinished.remove(&tile);
        self.finished += 1;
        self.finished_time += now.saturating_duration_since(since);
        Completion::First
    }

    /// A shader could not render a tile: others are asked, and it is again if there is no other. Says whether that
    /// is news; the tile may have come from another meanwhile.
    pub fn failed(&mut self, tile: u32, shader: ShaderId) -> bool {
        if let Some(shader) = self.shaders.get_mut(&shader) {
            shader.has_finished |= shader.tiles.remove(&tile).is_some();
        }
        let Some(holders) = self.in_flight.get_mut(&tile) else {
            return false;
        };
        let before = holders.len();
        holders.retain(|&(holder, _)| holder != shader);
        if holders.len() == before {
            return false;
        }
        self.failures.entry(tile).or_default().insert(shader);
        if holders.is_empty() {
            self.in_flight.remove(&tile);
            self.again.insert(tile);
        }
        true
    }

    /// What to send now: waiting tiles first, to the shaders with the most free credits;
    /// when none waits, late tiles to idle shaders as well. Where the second is late too, to a
    /// third: both may hang.
    pub fn assign(&mut self, now: Instant) -> Vec<(ShaderId, u32)> {
        let mut assigned = Vec::new();
        let in_need = self.is_in_need(now);
        self.assign_again(now, &mut assigned);
        while let Some(shader) = self.freest(in_need) {
            let Some(tile) = self.waiting.pop_front() else {
                break;
            };
            self.give(shader, tile, now);
            assigned.push((shader, tile));
        }
        if self.waiting.is_empty() {
            self.assign_late(now, in_need, &mut assigned);
        }
        assigned
    }

    /// Tiles that somebody could not render. One waits for those who have not tried, the relied on first, and goes to
    /// one that has if all have.
    fn assign_again(&mut self, now: Instant, assigned: &mut Vec<(ShaderId, u32)>) {
        for tile in self.again.clone() {
            let rank = |(id, shader): (&ShaderId, &Shader)| {
                let has_failed = self.has_failed(*id, tile);
                (has_failed, shader.is_reserve)
            };
            let best = self.shaders.iter().map(rank).min();
            let mut candidates = self.shaders.iter().filter(|&(id, shader)| {
                shader.tiles.len() < shader.credits && Some(rank((id, shader))) == best
            });
            if let Some((&shader, _)) = candidates.next() {
                self.again.remove(&tile);
                self.give(shader, tile, now);
                assigned.push((shader, tile));
            }
        }
    }

    fn has_failed(&self, shader: ShaderId, tile: u32) -> bool {
        let failed = self.failures.get(&tile);
        failed.is_some_and(|failed| failed.contains(&shader))
    }

    fn assign_late(&mut self, now: Instant, in_need: bool, assigned: &mut Vec<(ShaderId, u32)>) {
        let late_after = self.late_after();
        let late: Vec<u32> = self
            .in_flight
            .iter()
            .filter(|(_, holders)| age(holders, now).is_some_and(|age| age >= late_after))
            .map(|(&tile, _)| tile)
            .collect();
        for tile in late {
            let holders = self.in_flight.get(&tile).map_or(&[][..], Vec::as_slice);
            if let Some(shader) = self.idle_beside(tile, holders, in_need) {
                self.reissued += 1;
                self.give(shader, tile, now);
                assigned.push((shader, tile));
            }
        }
    }

    /// A shader that has little to do, other than those that have the tile or cannot render it; one in
    /// reserve only in need, and if there is no other.
    fn idle_beside(
        &self,
        tile: u32,
        holders: &[(ShaderId, Instant)],
        in_need: bool,
    ) -> Option<ShaderId> {
        let idle = self.shaders.iter().filter(|&(&id, shader)| {
            let has_it = holders.iter().any(|&(holder, _)| holder == id);
            let may_have_it = !has_it && !self.has_failed(id, tile);
            may_have_it && shader.is_idle(in_need)
        });
        idle.min_by_key(|&(&id, shader)| (shader.is_reserve, id))
            .map(|(&id, _)| id)
    }

    /// Whether every shader that is relied on has a tile that is late.
    fn is_in_need(&self, now: Instant) -> bool {
        let late_after = self.late_after();
        let is_late = |&since: &Instant| now.saturating_duration_since(since) >= late_after;
        let mut relied_on = self.shaders.values().filter(|shader| !shader.is_reserve);
        relied_on.all(|shader| shader.tiles.values().any(is_late))
    }

    /// When the next tile becomes late that an idle shader could take over: then
    /// [`Self::assign`] has news. Where none is idle, the next one is by an event.
    #[must_use]
    pub fn next_deadline(&self) -> Option<Instant> {
        if !self.waiting.is_empty() || self.shaders.len() < 2 {
            return None;
        }
        // Every event of a frame's end asks this, of hundreds of tiles and shaders.
        let idle = self.shaders.values().filter(|shader| shader.is_idle(false));
        let idle = idle.count();
        let since = self.in_flight.iter().filter_map(|(tile, holders)| {
            let can_be_taken = match idle {
                0 => false,
                _ if idle > holders.len() && !self.failures.contains_key(tile) => true,
                _ => self.idle_beside(*tile, holders, false).is_some(),
            };
            holders
                .last()
                .filter(|_| can_be_taken)
                .map(|&(_, since)| since)
        });
        Some(since.min()? + self.late_after())
    }

    /// Whether a shader has had tiles until they were late, and has finished none.
    #[must_use]
    pub fn is_silent(&self, shader: ShaderId, now: Instant) -> bool {
        let late_after = self.late_after();
        let Some(shader) = self.shaders.get(&shader) else {
            return false;
        };
        let held = shader
            .oldest
            .map(|since| now.saturating_duration_since(since));
        !shader.has_finished && held.is_some_and(|held| held >= late_after)
    }

    /// Whether every tile is done.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.unfinished.is_empty()
    }

    /// Tiles that are not done.
    #[must_use]
    pub fn unfinished(&self) -> usize {
        self.unfinished.len()
    }

    /// Shaders that are there.
    #[must_use]
    pub fn shaders(&self) -> usize {
        self.shaders.len()
    }

    /// Tiles in flight at a shader.
    #[must_use]
    pub fn in_flight(&self, shader: ShaderId) -> usize {
        self.shaders.get(&shader).map_or(0, |s| s.tiles.len())
    }

    /// Tiles that were in flight at shaders that went away.
    #[must_use]
    pub fn lost_tiles(&self) -> u64 {
        self.lost
    }

    /// How often a tile was given to another shader as well because it was late.
    #[must_use]
    pub fn reissued_tiles(&self) -> u64 {
        self.reissued
    }

    fn late_after(&self) -> Duration {
        if self.finished == 0 {
            return self.policy.floor.max(Duration::from_secs(1));
        }
        let mean = self.finished_time / self.finished;
        self.policy.floor.max(mean.mul_f64(self.policy.factor))
    }

    fn freest(&self, in_need: bool) -> Option<ShaderId> {
        let free = |shader: &Shader| shader.credits.saturating_sub(shader.tiles.len());
        let ids = self.shaders.iter().filter(|(_, s)| free(s) > 0);
        let ids = ids.filter(|(_, s)| in_need || !s.is_reserve);
        // Of equals the first, so that the order does not depend on the map.
        ids.min_by_key(|(id, s)| (s.is_reserve, usize::MAX - free(s), **id))
            .map(|(&id, _)| id)
    }

    fn give(&mut self, shader: ShaderId, tile: u32, now: Instant) {
        if let Some(shader) = self.shaders.get_mut(&shader) {
            shader.tiles.insert(tile, now);
            shader.oldest.get_or_insert(now);
        }
        self.in_flight.entry(tile).or_default().push((shader, now));
    }
}

/// How long the newest holder of a tile has had it.
fn age(holders: &[(ShaderId, Instant)], now: Instant) -> Option<Duration> {
    let &(_, since) = holders.last()?;
    Some(now.saturating_duration_since(since))
}

#[cfg(test)]
mod tests;
