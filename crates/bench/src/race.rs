use std::time::{Duration, Instant};

use lie_render::{Film, RenderStats};

use crate::{Progress, Spread};

/// What a frame's time went to: times of the threads, shared out among them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stages {
    /// Primary visibility.
    pub visibility_ms: f64,
    /// Lights that no ray is needed for.
    pub unoccluded_ms: f64,
    /// Lights tested against occluder lists.
    pub partial_ms: f64,
    /// Lights tested against the whole scene.
    pub full_ms: f64,
}

impl Stages {
    fn new(stats: &RenderStats, threads: usize) -> Self {
        let shared = |nanoseconds: u64| nanoseconds as f64 * 1.0e-6 / threads.max(1) as f64;
        Self {
            visibility_ms: shared(stats.visibility_ns),
            unoccluded_ms: shared(stats.unoccluded_ns),
            partial_ms: shared(stats.partial_ns),
            full_ms: shared(stats.full_ns),
        }
    }

    /// The median of each.
    fn median(all: &[Self]) -> Self {
        let of = |part: fn(&Self) -> f64| {
            let values: Vec<f64> = all.iter().map(part).collect();
            Spread::of(&values).map_or(0.0, |spread| spread.median)
        };
        Self {
            visibility_ms: of(|stages| stages.visibility_ms),
            unoccluded_ms: of(|stages| stages.unoccluded_ms),
            partial_ms: of(|stages| stages.partial_ms),
            full_ms: of(|stages| stages.full_ms),
        }
    }
}

/// One that takes part in a [`race`].
pub(crate) struct Entrant<'a> {
    /// For the progress.
    pub(crate) name: String,
    /// Renders its frame on rayon's current threads.
    pub(crate) render: Render<'a>,
}

/// Renders a frame and tells the share done.
pub(crate) type Render<'a> =
    Box<dyn Fn(&mut (dyn FnMut(f32) + Send)) -> (Film, RenderStats) + Sync + 'a>;

/// What an entrant did.
pub(crate) struct Runs {
    /// Its frame: the same every time.
    pub(crate) film: Film,
    /// What that cost, the last time.
    pub(crate) stats: RenderStats,
    /// Each repetition's time.
    pub(crate) times_ms: Vec<f64>,
    stages: Vec<Stages>,
}

impl Runs {
    /// Its times.
    pub(crate) fn frame_ms(&self) -> Spread {
        Spread::of(&self.times_ms).unwrap_or(Spread::NONE)
    }

    /// Each repetition's time of primary visibility.
    pub(crate) fn visibility_ms(&self) -> Vec<f64> {
        self.stages
            .iter()
            .map(|stages| stages.visibility_ms)
            .collect()
    }

    /// Where its time went, in the median.
    pub(crate) fn stages(&self) -> Stages {
        Stages::median(&self.stages)
    }

    /// How many times as fast as another one, repetition by repetition.
    pub(crate) fn speedup_over(&self, other: &Self) -> Option<Spread> {
        let pairs = other.times_ms.iter().zip(&self.times_ms);
        let ratios: Vec<f64> = pairs.map(|(other, own)| other / own).collect();
        Spread::of(&ratios)
    }
}

/// Lets each entrant render once, in order, and all of that `repeat` times (at least once):
/// what disturbs the machine disturbs all of them alike.
pub(crate) fn race(
    pool: &rayon::ThreadPool,
    repeat: u32,
    entrants: &[Entrant<'_>],
    progress: &Progress<'_>,
) -> Vec<Runs> {
    let mut all: Vec<Runs> = vec![];
    for repetition in 0..repeat.max(1) {
        let round = format!("{} of {repeat}", repetition + 1);
        race_round(pool, &round, entrants, &mut all, progress);
    }
    all
}

/// One round of a [`race`]: each entrant renders once, in order. `all` holds what they did in the
/// rounds before, and is empty in the first.
pub(crate) fn race_round(
    pool: &rayon::ThreadPool,
    round: &str,
    entrants: &[Entrant<'_>],
    all: &mut Vec<Runs>,
    progress: &Progress<'_>,
) {
    let threads = pool.current_num_threads();
    for (index, entrant) in entrants.iter().enumerate() {
        let what = format!("{}, {threads} threads, {round}", entrant.name);
        let (film, stats, time_ms) = timed(pool, &entrant.render, &|share| {
            progress(&what, share);
        });
        if index == all.len() {
            all.push(Runs {
                film,
                stats,
                times_ms: vec![],
                stages: vec![],
            });
        }
        all[index].times_ms.push(time_ms);
        all[index].stages.push(Stages::new(&stats, threads));
        all[index].stats = stats;
    }
}

/// One frame on these threads, and its time.
pub(crate) fn timed(
    pool: &rayon::ThreadPool,
    render: &Render<'_>,
    progress: &(dyn Fn(f32) + Sync),
) -> (Film, RenderStats, f64) {
    pool.install(|| {
        let clock = Instant::now();
        let (film, stats) = render(&mut |share| progress(share));
        (film, stats, milliseconds(clock.elapsed()))
    })
}

/// Threads to render on.
pub(crate) fn pool(threads: usize) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build()
}

pub(crate) fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1.0e3
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[test]
    fn entrants_alternate() {
        let order = Mutex::new(String::new());
        let entrant = |name: &'static str| Entrant {
            name: name.to_owned(),
            render: Box::new(|_| {
                order.lock().unwrap().push_str(name);
                let stats = RenderStats {
                    visibility_ns: 4_000_000,
                    ..RenderStats::default()
                };
                (Film::new(glam::UVec2::ONE), stats)
            }),
        };
        let pool = pool(2).unwrap();
        let runs = race(&pool, 3, &[entrant("a"), entrant("b")], &|_, _| {});
        assert_eq!(*order.lock().unwrap(), "ababab");
        for run in &runs {
            assert_eq!(run.times_ms.len(), 3);
            assert_eq!(run.stages().visibility_ms, 2.0, "shared out to two threads");
        }
        let speedup = runs[1].speedup_over(&runs[0]).unwrap();
        assert!(speedup.min <= speedup.median && speedup.median <= speedup.max);
    }
}
