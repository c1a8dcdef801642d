//! Kernels on a vector unit of one's choice: for tests, which hold all units to the same bits,
//! and for benchmarks. A program that is not measured takes the widest, always.

use std::cell::Cell;

use fearless_simd::{Level, prelude::*};

thread_local! {
    static CHOSEN: Cell<Option<Level>> = const { Cell::new(None) };
}

/// What this thread's kernels run on.
#[inline]
pub(crate) fn unit() -> Level {
    CHOSEN.get().unwrap_or_else(Level::new)
}

/// What kernels can run on: a vector unit of this machine.
///
/// It decides about packets and lists of occluders. Loops that the compiler turns into vector code by
/// itself (single rays, shafts, light at a point) take the widest unit whatever is chosen here.
#[derive(Clone, Copy, Debug)]
pub struct VectorUnit {
    name: &'static str,
    level: Level,
}

impl VectorUnit {
    /// All that this machine has, the widest first. The last is what every machine of its kind has:
    /// SSE 2, or NEON.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let widest = Level::new();
        let units = [
            #[cfg(target_arch = "x86_64")]
            ("avx512", widest.as_avx512().map(Simd::level)),
            #[cfg(target_arch = "x86_64")]
            ("avx2", widest.as_avx2().map(Simd::level)),
            #[cfg(target_arch = "x86_64")]
            ("sse4.2", widest.as_sse4_2().map(Simd::level)),
            #[cfg(target_arch = "x86_64")]
            ("sse2", widest.as_sse2().map(Simd::level)),
            #[cfg(target_arch = "aarch64")]
            ("neon", widest.as_neon().map(Simd::level)),
        ];
        let of_name = |(name, level): (_, Option<Level>)| level.map(|level| Self { name, level });
        units.into_iter().filter_map(of_name).collect()
    }

    /// What it is called: `avx512`, `avx2`, `sse4.2`, `sse2` or `neon`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Does something with this thread's kernels on this unit.
    pub fn run<R>(self, work: impl FnOnce() -> R) -> R {
        let _restore = Restore(CHOSEN.replace(Some(self.level)));
        work()
    }
}

/// Gives back, also in a panic, what was chosen before.
struct Restore(Option<Level>);

impl Drop for Restore {
    fn drop(&mut self) {
        CHOSEN.set(self.0);
    }
}

/// Does something on each of them.
#[cfg(test)]
pub(crate) fn on_each_unit(work: impl Fn()) {
    for unit in VectorUnit::all() {
        unit.run(&work);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_chosen_for_as_long_as_it_runs() {
        let units = VectorUnit::all();
        assert!(!units.is_empty());
        let widest = format!("{:?}", unit());
        for chosen in units {
            let inside = chosen.run(|| format!("{:?}", unit()));
            assert_eq!(inside, format!("{:?}", chosen.level));
        }
        assert_eq!(format!("{:?}", unit()), widest);
    }
}
