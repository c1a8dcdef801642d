use std::ops::AddAssign;

use crate::RenderStats;

/// What light at a pixel takes, counted and not timed: the same on every machine.
///
/// Sums over all pixels are the renderer's own counts ([`RenderStats`]) of the same frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Camera rays.
    pub primary_rays: u64,
    /// Lights, sample points on lights, and edges of lights that are integrated, at surface
    /// points: evaluated sixteen pixels at a time.
    pub lane_evaluations: u64,
    /// Those that adaptive shadow testing evaluates one by one.
    pub single_evaluations: u64,
    /// Rays tested against an occluder list.
    pub list_rays: u64,
    /// Triangles in the lists, for each ray: tested sixteen rays at a time.
    pub lane_tests: u64,
    /// Shadow rays through the whole scene.
    pub shadow_rays: u64,
}

impl Work {
    /// Triangles that rays were tested against one of the lists of.
    #[must_use]
    pub fn occluder_tests(&self) -> u64 {
        self.lane_tests
    }

    /// Lights, sample points on lights and edges of lights that were evaluated.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        self.lane_evaluations + self.single_evaluations
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.primary_rays += other.primary_rays;
        self.lane_evaluations += other.lane_evaluations;
        self.single_evaluations += other.single_evaluations;
        self.list_rays += other.list_rays;
        self.lane_tests += other.lane_tests;
        self.shadow_rays += other.shadow_rays;
    }
}

/// What each kind of [`Work`] costs, in nanoseconds of one thread.
///
/// The usual weights are rounded from stage times and counts of whole frames of the shipped
/// scenes (`lie bench figure4 --threads 1 --json`); `docs/decisions/0018-cost-is-counted.md`
/// says how well they fit. They are constants so that a cost is the same wherever and whenever
/// it is counted; what matters to a picture of costs are their ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostModel {
    /// For a camera ray: the closest hit, the surface there, and its cell.
    pub primary_ray_ns: f32,
    /// For one of sixteen evaluated at a time.
    pub lane_evaluation_ns: f32,
    /// For a light's sample point evaluated alone.
    pub single_evaluation_ns: f32,
    /// For one of sixteen rays tested against a triangle at a time.
    pub lane_test_ns: f32,
    /// For a ray through the whole scene.
    pub shadow_ray_ns: f32,
}

impl Default for CostModel {
    fn default() -> Self {
        Self {
            primary_ray_ns: 220.0,
            lane_evaluation_ns: 8.0,
            single_evaluation_ns: 30.0,
            lane_test_ns: 1.5,
            shadow_ray_ns: 100.0,
        }
    }
}

impl CostModel {
    /// Nanoseconds of one thread that some work costs.
    #[must_use]
    pub fn cost_ns(&self, work: &Work) -> f64 {
        let parts = [
            (work.primary_rays, self.primary_ray_ns),
            (work.lane_evaluations, self.lane_evaluation_ns),
            (work.single_evaluations, self.single_evaluation_ns),
            (work.lane_tests, self.lane_test_ns),
            (work.shadow_rays, self.shadow_ray_ns),
        ];
        let costs = parts.map(|(count, weight_ns)| count as f64 * f64::from(weight_ns));
        costs.iter().sum()
    }

    /// Nanoseconds of one thread that a frame took, as measured, over all stages: what the
    /// cost of its work is an estimate of.
    #[must_use]
    pub fn measured_ns(stats: &RenderStats) -> u64 {
        stats.visibility_ns + stats.unoccluded_ns + stats.partial_ns + stats.full_ns
    }
}
