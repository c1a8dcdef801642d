use std::sync::atomic::{AtomicU64, Ordering};

/// A number that only rises.
#[derive(Debug, Default)]
pub(crate) struct Counter(AtomicU64);

impl Counter {
    pub(crate) fn add(&self, count: u64) {
        self.0.fetch_add(count, Ordering::Relaxed);
    }

    pub(crate) fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// How many there are now.
#[derive(Debug, Default)]
pub(crate) struct Gauge(AtomicU64);

/// One of them; one less when dropped.
pub(crate) struct Held<'a>(&'a Gauge);

impl Gauge {
    pub(crate) fn set(&self, count: usize) {
        self.0.store(count as u64, Ordering::Relaxed);
    }

    /// There is one more, until what this gives is dropped.
    pub(crate) fn hold(&self) -> Held<'_> {
        self.0.fetch_add(1, Ordering::Relaxed);
        Held(self)
    }

    pub(crate) fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

impl Drop for Held<'_> {
    fn drop(&mut self) {
        self.0.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// How many durations there were up to certain lengths.
#[derive(Debug, Default)]
pub(crate) struct Histogram {
    /// By the first bound that is not exceeded; the last has none.
    counts: [AtomicU64; Histogram::BOUNDS.len() + 1],
    sum_ns: AtomicU64,
}

impl Histogram {
    /// Upper bounds in nanoseconds, and how they are written in seconds.
    pub(crate) const BOUNDS: [(u64, &'static str); 13] = [
        (100_000, "0.0001"),
        (250_000, "0.00025"),
        (500_000, "0.0005"),
        (1_000_000, "0.001"),
        (2_500_000, "0.0025"),
        (5_000_000, "0.005"),
        (10_000_000, "0.01"),
        (25_000_000, "0.025"),
        (50_000_000, "0.05"),
        (100_000_000, "0.1"),
        (250_000_000, "0.25"),
        (1_000_000_000, "1"),
        (10_000_000_000, "10"),
    ];

    /// One more, of so many nanoseconds.
    pub(crate) fn observe_ns(&self, ns: u64) {
        let bucket = Self::BOUNDS.partition_point(|&(bound, _)| bound < ns);
        self.counts[bucket].fetch_add(1, Ordering::Relaxed);
        self.sum_ns.fetch_add(ns, Ordering::Relaxed);
    }

    /// How many there were up to each bound, and at last how many in all.
    pub(crate) fn cumulative(&self) -> [u64; Self::BOUNDS.len() + 1] {
        let mut total = 0;
        std::array::from_fn(|bucket| {
            total += self.counts[bucket].load(Ordering::Relaxed);
            total
        })
    }

    /// All durations together, in seconds.
    pub(crate) fn sum_s(&self) -> f64 {
        self.sum_ns.load(Ordering::Relaxed) as f64 * 1.0e-9
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_counts_up_to_its_bound_and_beyond() {
        let histogram = Histogram::default();
        for ns in [0, 100_000, 100_001, 60_000_000_000] {
            histogram.observe_ns(ns);
        }
        let counts = histogram.cumulative();
        assert_eq!(counts[..3], [2, 3, 3]);
        assert_eq!(counts[12..], [3, 4]);
        assert!((histogram.sum_s() - 60.000_200_001).abs() < 1.0e-9);
    }

    #[test]
    fn bounds_rise_and_are_written_as_they_are() {
        assert!(Histogram::BOUNDS.is_sorted());
        for (ns, text) in Histogram::BOUNDS {
            let seconds: f64 = text.parse().unwrap();
            assert!((seconds * 1.0e9 - ns as f64).abs() < 0.5, "{text}");
        }
    }

    #[test]
    fn what_is_held_is_given_back() {
        let gauge = Gauge::default();
        let held = (gauge.hold(), gauge.hold());
        assert_eq!(gauge.get(), 2);
        drop(held);
        assert_eq!(gauge.get(), 0);
    }
}
