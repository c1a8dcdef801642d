use std::{
    cmp::Reverse,
    collections::{BinaryHeap, VecDeque},
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

/// A tile that takes its time.
pub(super) trait Job: Send + 'static {
    /// How long it takes.
    fn cost(&self) -> Duration;

    /// Whether nobody wants it any more.
    fn is_cancelled(&self) -> bool;

    /// It is done.
    fn done(self, times: Times);
}

/// When a tile was worked at. Nobody did: it is when the work would have begun and ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Times {
    pub(super) arrived: Instant,
    /// When the one before was done, or long ago.
    pub(super) free: Instant,
    pub(super) started: Instant,
    pub(super) due: Instant,
}

/// Threads that do nothing but take their time, each for one tile after the other. A single
/// thread keeps the time of all, since it is the same to sleep for many.
pub(super) struct Clock<J>(Arc<Inner<J>>);

struct Inner<J> {
    state: Mutex<State<J>>,
    news: Condvar,
}

struct State<J> {
    lanes: Vec<Lane<J>>,
    /// When the first tile of a lane is due. One that is there no more, or later, is passed over.
    due: BinaryHeap<Reverse<(Instant, usize)>>,
    closed: bool,
}

struct Lane<J> {
    /// The first is in work.
    jobs: VecDeque<(J, Times)>,
    /// When it has been done with what it has had.
    free: Instant,
}

impl<J: Job> Clock<J> {
    /// Starts to keep the time of so many threads.
    pub(super) fn start(lanes: usize) -> io::Result<Self> {
        let now = Instant::now();
        let lane = |_| Lane {
            jobs: VecDeque::new(),
            free: now,
        };
        let inner = Arc::new(Inner {
            state: Mutex::new(State {
                lanes: (0..lanes).map(lane).collect(),
                due: BinaryHeap::new(),
                closed: false,
            }),
            news: Condvar::new(),
        });
        let keeper = inner.clone();
        thread::Builder::new()
            .name("replay".to_owned())
            .spawn(move || keeper.keep())?;
        Ok(Self(inner))
    }

    /// A thread has one more tile to do.
    pub(super) fn submit(&self, lane: usize, job: J, arrived: Instant) {
        let mut state = self.0.lock();
        let State { lanes, due, .. } = &mut *state;
        let lane_state = &mut lanes[lane];
        let before = lane_state.jobs.back();
        let free = before.map_or(lane_state.free, |(_, times)| times.due);
        let times = Times::of(&job, arrived, free, arrived);
        lane_state.jobs.push_back((job, times));
        if lane_state.jobs.len() == 1 {
            due.push(Reverse((times.due, lane)));
            self.0.news.notify_one();
        }
    }

    /// A thread drops what nobody wants any more, and goes on with what follows.
    pub(super) fn forget_cancelled(&self, lane: usize, now: Instant) {
        let mut state = self.0.lock();
        let State { lanes, due, .. } = &mut *state;
        let lane_state = &mut lanes[lane];
        let before = lane_state.jobs.len();
        lane_state.jobs.retain(|(job, _)| !job.is_cancelled());
        if lane_state.jobs.len() == before {
            return;
        }
        lane_state.free = now;
        let mut free = now;
        for (job, times) in &mut lane_state.jobs {
            // What was begun goes on.
            if times.started > now {
                *times = Times::of(job, times.arrived, free, now);
            }
            free = times.due;
        }
        if let Some((_, times)) = lane_state.jobs.front() {
            due.push(Reverse((times.due, lane)));
            self.0.news.notify_one();
        }
    }

    /// Ends.
    pub(super) fn close(&self) {
        self.0.lock().closed = true;
        self.0.news.notify_one();
    }
}

impl Times {
    /// Of work that begins when the thread is free, and not before `now`.
    fn of(job: &impl Job, arrived: Instant, free: Instant, now: Instant) -> Self {
        let started = free.max(now);
        let due = started + job.cost();
        Self {
            arrived,
            free,
            started,
            due,
        }
    }
}

impl<J: Job> Inner<J> {
    fn lock(&self) -> MutexGuard<'_, State<J>> {
        // Nothing in here can panic half-way.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn keep(&self) {
        let mut state = self.lock();
        while !state.closed {
            let now = Instant::now();
            let next = state.due.peek().map(|&Reverse((due, _))| due);
            state = match next {
                Some(due) if due <= now => match state.take() {
                    Some((job, times)) => {
                        drop(state);
                        job.done(times);
                        self.lock()
                    }
                    None => state,
                },
                Some(due) => {
                    let waited = self.news.wait_timeout(state, due - now);
                    waited.unwrap_or_else(PoisonError::into_inner).0
                }
                None => self
                    .news
                    .wait(state)
                    .unwrap_or_else(PoisonError::into_inner),
            };
        }
    }
}

impl<J: Job> State<J> {
    /// The tile that is due first, unless it is not there any more.
    fn take(&mut self) -> Option<(J, Times)> {
        let Reverse((due, number)) = self.due.pop()?;
        let lane = &mut self.lanes[number];
        if lane.jobs.front()?.1.due != due {
            return None;
        }
        let (job, times) = lane.jobs.pop_front()?;
        lane.free = due;
        if let Some((_, next)) = lane.jobs.front() {
            self.due.push(Reverse((next.due, number)));
        }
        Some((job, times))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{
        atomic::{AtomicBool, Ordering},
        mpsc,
    };

    use super::*;

    struct Sleep {
        name: u32,
        cost_ms: u64,
        cancelled: Arc<AtomicBool>,
        said: mpsc::Sender<(u32, Times)>,
    }

    impl Job for Sleep {
        fn cost(&self) -> Duration {
            Duration::from_millis(self.cost_ms)
        }

        fn is_cancelled(&self) -> bool {
            self.cancelled.load(Ordering::Relaxed)
        }

        fn done(self, times: Times) {
            let _ = self.said.send((self.name, times));
        }
    }

    #[test]
    fn each_thread_does_one_tile_after_the_other_and_drops_what_is_cancelled() {
        let clock = Clock::start(2).unwrap();
        let (said, heard) = mpsc::channel();
        let cancelled = Arc::new(AtomicBool::new(false));
        let sleep = |name, cost_ms, cancelled: &Arc<AtomicBool>| Sleep {
            name,
            cost_ms,
            cancelled: cancelled.clone(),
            said: said.clone(),
        };
        let wanted = Arc::<AtomicBool>::default();
        let now = Instant::now();
        clock.submit(0, sleep(1, 40, &wanted), now);
        clock.submit(0, sleep(2, 20, &wanted), now);
        clock.submit(1, sleep(3, 10, &wanted), now);
        let done: Vec<_> = heard.iter().take(3).collect();
        let names: Vec<u32> = done.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, [3, 1, 2]);
        let at = |instant: Instant| (instant - now).as_millis();
        assert_eq!([0, 1, 2].map(|i| at(done[i].1.due)), [10, 40, 60]);
        assert_eq!([0, 1, 2].map(|i| at(done[i].1.started)), [0, 0, 40]);

        // An hour that nobody waits for, and one that somebody does not wait for either.
        let now = Instant::now();
        clock.submit(0, sleep(4, 3_600_000, &cancelled), now);
        clock.submit(0, sleep(5, 3_600_000, &cancelled), now);
        clock.submit(0, sleep(6, 1, &wanted), now);
        cancelled.store(true, Ordering::Relaxed);
        clock.forget_cancelled(0, now);
        let (name, times) = heard.recv().unwrap();
        assert_eq!(name, 6);
        assert_eq!(times.due - now, Duration::from_millis(1));
        clock.close();
    }
}
