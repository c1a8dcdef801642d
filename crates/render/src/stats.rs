use std::ops::AddAssign;

/// What a tile or a frame cost. Times are summed over threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Nanoseconds in primary visibility.
    pub visibility_ns: u64,
    /// Nanoseconds in lights that no ray is needed for.
    pub unoccluded_ns: u64,
    /// Nanoseconds in lights tested against occluder lists.
    pub partial_ns: u64,
    /// Nanoseconds in lights tested against the whole scene.
    pub full_ns: u64,
    /// Camera rays.
    pub primary_rays: u64,
    /// Shadow rays through the whole scene.
    pub shadow_rays: u64,
    /// Rays tested against an occluder list instead.
    pub list_rays: u64,
    /// Triangles in the lists that those rays met.
    pub occluder_tests: u64,
    /// Lights evaluated at surface points: unoccluded, partial and doubtful ones.
    pub evaluations: u64,
    /// Those that the LIEs answered.
    pub trusted: u64,
}

/// Sums end at the largest number: what comes over a network may be any.
impl AddAssign for RenderStats {
    fn add_assign(&mut self, other: Self) {
        self.visibility_ns = self.visibility_ns.saturating_add(other.visibility_ns);
        self.unoccluded_ns = self.unoccluded_ns.saturating_add(other.unoccluded_ns);
        self.partial_ns = self.partial_ns.saturating_add(other.partial_ns);
        self.full_ns = self.full_ns.saturating_add(other.full_ns);
        self.primary_rays = self.primary_rays.saturating_add(other.primary_rays);
        self.shadow_rays = self.shadow_rays.saturating_add(other.shadow_rays);
        self.list_rays = self.list_rays.saturating_add(other.list_rays);
        self.occluder_tests = self.occluder_tests.saturating_add(other.occluder_tests);
        self.evaluations = self.evaluations.saturating_add(other.evaluations);
        self.trusted = self.trusted.saturating_add(other.trusted);
    }
}

impl RenderStats {
    /// The share of light evaluations that the LIEs answered, in `[0, 1]`; 1 where there
    /// were none. Lights that are known to be hidden are not evaluated and do not count.
    #[must_use]
    pub fn trusted_fraction(&self) -> f64 {
        if self.evaluations == 0 {
            1.0
        } else {
            self.trusted as f64 / self.evaluations as f64
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_what_a_peer_claims_end_at_the_largest_number() {
        let claimed = RenderStats {
            visibility_ns: u64::MAX - 1,
            trusted: 2,
            ..RenderStats::default()
        };
        let mut sum = claimed;
        sum += claimed;
        assert_eq!((sum.visibility_ns, sum.trusted), (u64::MAX, 4));
    }
}
