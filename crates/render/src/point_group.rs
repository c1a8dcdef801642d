use glam::Vec3;
use lie_accel::{FanOccluders, PACKET, RayPacket};
use lie_geom::{Ray, sampling};
use multiversion::multiversion;

use crate::{
    LieCell, LightRay, RenderStats, World,
    area_lanes::{self, AreaLanes, AreaSampling},
    delta_lanes::DeltaLight,
    light_form::{AreaForm, LightForm},
    light_rays::is_simple,
    occluder_lists::OpenLists,
    point_lanes::{Lanes, PointLanes, RadianceLanes, carrying},
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
pub(crate) struct PointGroup<'a> {
    cell: Option<&'a LieCell>,
    pub(crate) points: PointLanes,
    /// Each lane's pixel.
    pub(crate) pixels: [usize; PACKET],
    /// The lanes that hold a point: bit `i` for lane `i`.
    pub(crate) lanes: u32,
}

/// An area light as a group sees it.
struct SeenArea<'a> {
    /// Its number.
    index: u32,
    form: AreaForm<'a>,
    /// What the closed form has, in sr.
    irradiance: Option<Lanes>,
    /// Lanes that it may light.
    lanes: u32,
}

impl<'a> PointGroup<'a> {
    /// No points.
    pub(crate) fn new() -> Self {
        Self {
            cell: None,
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
    pub(crate) fn gather(&mut self, cell: &'a LieCell, blocks: &[Self], places: &[(u32, u32)]) {
        self.cell = Some(cell);
        self.lanes = (1 << places.len()) - 1;
        self.points.clear(places.len());
        for (lane, &(block, from)) in places.iter().enumerate() {
            let block = &blocks[block as usize];
            self.points.copy(lane, &block.points, from as usize);
            self.pixels[lane] = block.pixels[from as usize];
        }
    }

    /// Unoccluded lights: no rays at all, but for exact ones, which are left to be traced.
    pub(crate) fn unoccluded(&self, work: &mut GroupWork<'_>) {
        let Some(cell) = self.cell else { return };
        let mut total = self.take(work.sums);
        for light in cell.unoccluded.iter() {
            match work.world.light_form(light) {
                LightForm::Delta(light) => add(&mut total, &light.shade(&self.points), u32::MAX),
                LightForm::Area(form) => {
                    let mut seen = self.see(light, form);
                    self.area_open(&mut seen, work.strata, &mut total);
                    self.area_lit(&seen, &mut total, work, |_, _| 0);
                }
                LightForm::Other => {}
            }
        }
        self.give(&total, work.sums);
    }

    /// Partially occluded lights of groups that share a cell: rays against the occluders alone,
    /// but for exact ones.
    pub(crate) fn partial(groups: &[Self], work: &mut GroupWork<'_>, scratch: &mut ListScratch) {
        let Some(cell) = groups.first().and_then(|group| group.cell) else {
            return;
        };
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
                            rays.blocked_by_fan(seen, ends, world.cutout())
                        });
                    }
                }
                LightForm::Area(form) => {
                    for (group, total) in groups.iter().zip(&mut *totals) {
                        let blocked = |sample: &AreaLanes, lit| {
                            lists.blocked(list, &group.segments(sample, lit), world.cutout())
                        };
                        let seen = group.see(list.light, form);
                        rays += group.area_lit(&seen, total, work, blocked);
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

    /// Whether another group's points lie in the same cell.
    pub(crate) fn shares_cell(&self, other: &Self) -> bool {
        let place = |group: &Self| group.cell.map(std::ptr::from_ref);
        place(self) == place(other)
    }

    /// Lights that too little is known of, or all if there is no cell: rays through the scene.
    pub(crate) fn traced(&self, work: &mut GroupWork<'_>) {
        let world = work.world;
        let mut total = self.take(work.sums);
        let trace = |light: u32| {
            let cache = &mut *work.cache;
            let blocked = |rays: &RayPacket| self.blocked(world, cache, light, rays);
            work.stats.shadow_rays += match world.light_form(light) {
                // Mostly, in a cell, none does or all.
                LightForm::Delta(light) if !light.reaches_any(&self.points) => 0,
                LightForm::Delta(light) => self.delta_lit(light, &mut total, blocked),
                LightForm::Area(form) => self.area_traced(&self.see(light, form), &mut total, work),
                LightForm::Other => 0,
            };
        };
        match self.cell {
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

    /// What an area light could give the group.
    fn see<'l>(&self, index: u32, form: AreaForm<'l>) -> SeenArea<'l> {
        let outlines = form.outlines;
        let irradiance = outlines.map(|outlines| outlines.irradiances(&self.points));
        let all = self.lanes;
        SeenArea {
            index,
            form,
            lanes: irradiance.map_or(all, |irradiance| all & positive(&irradiance)),
            irradiance,
        }
    }

    /// Adds an area light that nothing hides to the lanes where its closed form is all there is
    /// to it, and takes them out of `seen`.
    fn area_open(&self, seen: &mut SeenArea<'_>, strata: (u32, u32), total: &mut RadianceLanes) {
        let (Some(irradiance), Some(outlines)) = (&seen.irradiance, seen.form.outlines) else {
            return;
        };
        let lanes = seen.lanes & self.points.matt;
        if lanes != 0 {
            let lanes = lanes & outlines.far(&self.points, strata.0 * strata.1);
            let radiance = area_lanes::reflect_all(&self.points, seen.form.light, irradiance);
            add(total, &radiance, lanes);
            seen.lanes &= !lanes;
        }
    }

    /// Adds an area light where `blocked` lets it through; exact rays are left to be traced.
    /// How many rays that took.
    fn area_lit(
        &self,
        seen: &SeenArea<'_>,
        total: &mut RadianceLanes,
        work: &mut GroupWork<'_>,
        mut blocked: impl FnMut(&AreaLanes, u32) -> u32,
    ) -> u64 {
        let mut count = 0;
        self.for_each_sample(seen, work.strata, work.samples, |sample, lit| {
            let exact = bits(&sample.exact) & lit;
            if exact != 0 {
                self.leave(seen.index, sample, exact, work.exact);
            }
            let lit = lit & !exact;
            if lit != 0 {
                add(total, &sample.radiance, lit & !blocked(sample, lit));
                count += u64::from(lit.count_ones());
            }
        });
        count
    }

    /// Which rays to a light the scene blocks. In a cell whatever blocks many of them is known
    /// already, and what blocked the last ones is of little use.
    #[inline]
    fn blocked(&self, world: &World, cache: &mut ShadowCache, light: u32, rays: &RayPacket) -> u32 {
        match self.cell {
            Some(cell) if cell.answered() > 0 => world.accel().blocked_packet(rays),
            _ => cache.blocked(world, light, rays),
        }
    }

    /// Adds an area light, exact rays and all, where the scene lets it through.
    fn area_traced(
        &self,
        seen: &SeenArea<'_>,
        total: &mut RadianceLanes,
        work: &mut GroupWork<'_>,
    ) -> u64 {
        let mut count = 0;
        let GroupWork { world, cache, .. } = work;
        self.for_each_sample(seen, work.strata, work.samples, |sample, lit| {
            let rays = self.segments(sample, lit);
            let blocked = self.blocked(world, cache, seen.index, &rays);
            add(total, &sample.radiance, lit & !blocked);
            count += u64::from(lit.count_ones());
        });
        count
    }

    /// Calls `found` with each sample of an area light, and the lanes it could light.
    fn for_each_sample(
        &self,
        seen: &SeenArea<'_>,
        strata: (u32, u32),
        samples: &mut Vec<AreaLanes>,
        mut found: impl FnMut(&AreaLanes, u32),
    ) {
        let keys = self.points.keys.map(|key| key.mix(u64::from(seen.index)));
        let smooth = if is_simple(seen.form.light) {
            self.points.smooth
        } else {
            0
        };
        let count = strata.0 * strata.1;
        for (lanes, by_lobe) in [(seen.lanes & !smooth, 0), (seen.lanes & smooth, count / 2)] {
            if lanes == 0 {
                continue;
            }
            let by_area = count - by_lobe;
            let sampling = AreaSampling {
                strata: sampling::strata(by_area),
                by_area,
                by_lobe,
            };
            let at = (seen.irradiance.as_ref(), lanes);
            area_lanes::gather(&self.points, seen.form, &keys, sampling, at, samples);
            for sample in &*samples {
                let lit = carrying(&sample.radiance) & lanes;
                if lit != 0 {
                    found(sample, lit);
                }
            }
        }
    }

    fn segments(&self, sample: &AreaLanes, lanes: u32) -> RayPacket {
        RayPacket::segments(&self.points.origin, &sample.target, lanes)
    }

    /// Leaves some lanes' rays to be traced later.
    fn leave(
        &self,
        light: u32,
        sample: &AreaLanes,
        lanes: u32,
        exact: &mut Vec<(usize, LightRay)>,
    ) {
        let at =
            |axes: &[Lanes; 3], lane: usize| Vec3::new(axes[0][lane], axes[1][lane], axes[2][lane]);
        for lane in lanes_of(self.lanes & lanes) {
            let ray = LightRay {
                light,
                ray: Ray::segment(at(&self.points.origin, lane), at(&sample.target, lane)),
                radiance: at(&sample.radiance, lane),
                exact: true,
                from_light: false,
            };
            exact.push((self.pixels[lane], ray));
        }
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

/// The lanes that are above zero.
fn positive(lanes: &Lanes) -> u32 {
    bits(&lanes.map(|value| value > 0.0))
}

/// Bit `i` for lane `i`.
fn bits(lanes: &[bool; PACKET]) -> u32 {
    let mut bits = 0;
    for lane in 0..PACKET {
        bits |= u32::from(lanes[lane]) << lane;
    }
    bits
}
