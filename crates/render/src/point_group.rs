use glam::Vec3;
use lie_accel::{FanOccluders, PACKET, RayPacket};
use multiversion::multiversion;

mod areas;

use self::areas::AreaOccluders;
use crate::{
    LieCell, LightRay, RenderStats, World,
    area_lanes::AreaLanes,
    delta_lanes::DeltaLight,
    light_form::LightForm,
    occluder_lists::OpenLists,
    point_lanes::{PointLanes, RadianceLanes, carrying},
    shadow_cache::ShadowCache,
};

/// What groups work on.
pub(crate) struct GroupWork<'a> {
    pub(crate) world: &'a World,
    /// Sample points on an area light, as columns and rows.
    pub(crate) strata: (u32, u32),
    pub(crate) stats: &'a mut RenderStats,
    pub(crate) cache: &'a mut ShadowCache,
    /// Each pixel's light so far.
    pub(crate) sums: &'a mut [Vec3],
    /// Rays that must go through the scene whatever the cell says, with their pixels.
    pub(crate) exact: &'a mut Vec<(usize, LightRay)>,
    /// Kept for what it has allocated.
    pub(crate) samples: &'a mut Vec<AreaLanes>,
}

/// What partially occluded lights are worked out in; kept for what it has allocated.
#[derive(Default)]
pub(crate) struct ListScratch {
    pub(crate) lists: OpenLists,
    seen: FanOccluders,
    totals: Vec<RadianceLanes>,
}

/// Up to sixteen shading points of one cell, or neighbours where there are no cells.
pub(crate) struct PointGroup {
    pub(crate) points: PointLanes,
    /// Each lane's pixel.
    pub(crate) pixels: [usize; PACKET],
    /// The lanes that hold a point: bit `i` for lane `i`.
    pub(crate) lanes: u32,
}

impl PointGroup {
    /// No points.
    pub(crate) fn new() -> Self {
        Self {
            points: PointLanes::new(),
            pixels: [0; PACKET],
            lanes: 0,
        }
    }

    /// The lanes that hold a point.
    pub(crate) fn lanes(&self) -> impl Iterator<Item = usize> + use<> {
        lanes_of(self.lanes)
    }

    /// Where a lane's shadow rays start.
    pub(crate) fn origin(&self, lane: usize) -> Vec3 {
        let origin = &self.points.origin;
        Vec3::new(origin[0][lane], origin[1][lane], origin[2][lane])
    }

    /// Makes these points of one cell, up to sixteen, by block and lane.
    pub(crate) fn gather(&mut self, blocks: &[Self], places: &[(u32, u32)]) {
        self.lanes = (1 << places.len()) - 1;
        self.points.clear(places.len());
        for (lane, &(block, from)) in places.iter().enumerate() {
            let block = &blocks[block as usize];
            self.points.copy(lane, &block.points, from as usize);
            self.pixels[lane] = block.pixels[from as usize];
        }
    }

    /// Unoccluded lights: no rays at all, but for exact ones, which are left to be traced.
    pub(crate) fn unoccluded(&self, cell: &LieCell, work: &mut GroupWork<'_>) {
        let mut total = self.take(work.sums);
        for light in cell.unoccluded.iter() {
            match work.world.light_form(light) {
                LightForm::Delta(light) => add(&mut total, &light.shade(&self.points), u32::MAX),
                LightForm::Area(form) => {
                    let mut seen = self.see(light, form);
                    self.area_open(&mut seen, u32::MAX, work.strata, &mut total);
                    self.area_lit(&seen, &mut total, work, |_| 0);
                }
                LightForm::Other => {}
            }
        }
        self.give(&total, work.sums);
    }

    /// Partially occluded lights of groups that share a cell: rays against the occluders alone,
    /// but for exact ones.
    pub(crate) fn partial(
        groups: &[Self],
        cell: &LieCell,
        work: &mut GroupWork<'_>,
        scratch: &mut ListScratch,
    ) {
        let world = work.world;
        let ListScratch {
            lists,
            seen,
            totals,
        } = scratch;
        lists.open(&cell.partial, world.scene().geometry.shapes());
        totals.clear();
        totals.extend(groups.iter().map(|group| group.take(work.sums)));
        for list in &lists.lights {
            let mut rays = 0;
            match world.light_form(list.light) {
                LightForm::Delta(light) => {
                    seen.look_from(light.position, &lists.blocks, lists.parts(list));
                    for (group, total) in groups.iter().zip(&mut *totals) {
                        let ends = group.points.origins;
                        rays += group.delta_lit(light, total, |rays| {
                            rays.blocked_by_fan(seen, Some(ends), world.cutout())
                        });
                    }
                }
                LightForm::Area(form) => {
                    let mut occluders = AreaOccluders {
                        lists,
                        list,
                        ends: form.ends,
                        seen,
                        cutout: world.cutout(),
                    };
                    for (group, total) in groups.iter().zip(&mut *totals) {
                        let mut seen = group.see(list.light, form);
                        let origins = &group.points.origin;
                        let asked = lists.may_hide(list, form, origins, seen.lanes);
                        group.area_open(&mut seen, !asked, work.strata, total);
                        rays += group.area_lit(&seen, total, work, |samples| {
                            group.hide_listed(samples, asked, &mut occluders)
                        });
                    }
                }
                LightForm::Other => {}
            }
            work.stats.list_rays += rays;
            work.stats.occluder_tests += rays * list.occluders;
        }
        for (group, total) in groups.iter().zip(totals) {
            group.give(total, work.sums);
        }
    }

    /// Lights that too little is known of, or all if there is no cell: rays through the scene.
    pub(crate) fn traced(&self, cell: Option<&LieCell>, work: &mut GroupWork<'_>) {
        let world = work.world;
        // In a cell whatever blocks many of its rays is known already, and what blocked the last
        // ones is of little use.
        let is_cached = cell.is_none_or(|cell| cell.answered() == 0);
        let mut total = self.take(work.sums);
        let trace = |light: u32| {
            let cache = is_cached.then_some(&mut *work.cache);
            let blocked = |rays: &RayPacket| blocked(world, cache, light, rays);
            work.stats.shadow_rays += match world.light_form(light) {
                // Mostly, in a cell, none does or all.
                LightForm::Delta(light) if !light.reaches_any(&self.points) => 0,
                LightForm::Delta(light) => self.delta_lit(light, &mut total, blocked),
                LightForm::Area(form) => {
                    self.area_traced(&self.see(light, form), is_cached, &mut total, work)
                }
                LightForm::Other => 0,
            };
        };
        match cell {
            Some(cell) => cell.traced.iter().for_each(trace),
            None => (0..world.scene().lights.len() as u32).for_each(trace),
        }
        self.give(&total, work.sums);
    }

    /// Adds a light without extent where `blocked` lets it through. How many rays that took.
    #[inline]
    fn delta_lit(
        &self,
        light: &DeltaLight,
        total: &mut RadianceLanes,
        blocked: impl FnOnce(&RayPacket) -> u32,
    ) -> u64 {
        let radiance = light.shade(&self.points);
        let lit = carrying(&radiance);
        if lit == 0 {
            return 0;
        }
        let rays = RayPacket::fan(light.position, &self.points.origin, lit);
        add(total, &radiance, !blocked(&rays));
        u64::from(lit.count_ones())
    }

    /// The pixels' sums so far.
    fn take(&self, sums: &[Vec3]) -> RadianceLanes {
        let mut total = [[0.0; PACKET]; 3];
        for lane in self.lanes() {
            let pixel = self.pixels[lane];
            for channel in 0..3 {
                total[channel][lane] = sums[pixel][channel];
            }
        }
        total
    }

    fn give(&self, total: &RadianceLanes, sums: &mut [Vec3]) {
        for lane in self.lanes() {
            sums[self.pixels[lane]] = Vec3::new(total[0][lane], total[1][lane], total[2][lane]);
        }
    }
}

/// Which rays to a light the scene blocks.
#[inline]
fn blocked(world: &World, cache: Option<&mut ShadowCache>, light: u32, rays: &RayPacket) -> u32 {
    match cache {
        Some(cache) => cache.blocked(world, light, rays),
        None => world.accel().blocked_packet(rays),
    }
}

/// Adds in the lanes whose bits are set.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn add(total: &mut RadianceLanes, radiance: &RadianceLanes, lanes: u32) {
    for channel in 0..3 {
        for lane in 0..PACKET {
            let given = lanes & (1 << lane) != 0;
            total[channel][lane] += if given { radiance[channel][lane] } else { 0.0 };
        }
    }
}

/// The lanes of a set of bits.
fn lanes_of(bits: u32) -> impl Iterator<Item = usize> {
    let mut left = bits;
    std::iter::from_fn(move || {
        let lane = left.trailing_zeros() as usize;
        (left != 0).then(|| {
            left &= left - 1;
            lane
        })
    })
}
