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

impl AddAssign for RenderStats {
    fn add_assign(&mut self, other: Self) {
        self.visibility_ns += other.visibility_ns;
        self.unoccluded_ns += other.unoccluded_ns;
        self.partial_ns += other.partial_ns;
        self.full_ns += other.full_ns;
        self.primary_rays += other.primary_rays;
        self.shadow_rays += other.shadow_rays;
        self.list_rays += other.list_rays;
        self.occluder_tests += other.occluder_tests;
        self.evaluations += other.evaluations;
        self.trusted += other.trusted;
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
