//! Area lights on a group of points.

use glam::Vec3;
use lie_accel::{Cutout, FanOccluders, PACKET, RayPacket};
use lie_geom::{Aabb, Ray, sampling};

use super::{GroupWork, PointGroup, add, blocked, lanes_of};
use crate::{
    LightRay,
    area_lanes::{self, AreaLanes, AreaSampling},
    light_form::AreaForm,
    light_rays::is_simple,
    occluder_lists::{LightList, OpenLists},
    point_lanes::{Lanes, RadianceLanes, carrying},
};

/// So many samples of a light are asked about pixel by pixel, sixteen of one pixel together; fewer
/// of them sample by sample, sixteen pixels together.
const MANY: usize = 8;

/// What may be in the way to an area light.
pub(super) struct AreaOccluders<'a> {
    pub(super) lists: &'a OpenLists,
    pub(super) list: &'a LightList,
    /// Where all rays to it end.
    pub(super) ends: Aabb,
    pub(super) seen: &'a mut FanOccluders,
    pub(super) cutout: Option<&'a dyn Cutout>,
}

impl AreaOccluders<'_> {
    /// Which rays are blocked, wherever they start.
    fn blocked(&self, rays: &RayPacket) -> u32 {
        self.lists.blocked(self.list, rays, self.cutout)
    }

    /// Prepares for rays to the light from one place.
    fn look_from(&mut self, apex: [f32; 3]) {
        let parts = self.lists.parts(self.list);
        self.seen
            .look_to(apex, self.ends, &self.lists.blocks, parts);
    }

    /// Which of such rays are blocked.
    fn blocked_from_there(&self, rays: &RayPacket) -> u32 {
        rays.blocked_by_fan(self.seen, None, self.cutout)
    }
}

/// An area light as a group sees it.
pub(super) struct SeenArea<'a> {
    /// Its number.
    index: u32,
    form: AreaForm<'a>,
    /// What the closed form has, in sr.
    irradiance: Option<Lanes>,
    /// Lanes that it may light.
    pub(super) lanes: u32,
}

impl PointGroup {
    /// What an area light could give the group.
    pub(super) fn see<'l>(&self, index: u32, form: AreaForm<'l>) -> SeenArea<'l> {
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

    /// Adds an area light to those of the `clear` lanes, where nothing hides it, in which its
    /// closed form is all there is to it, and takes them out of `seen`.
    pub(super) fn area_open(
        &self,
        seen: &mut SeenArea<'_>,
        clear: u32,
        strata: (u32, u32),
        total: &mut RadianceLanes,
    ) {
        let (Some(irradiance), Some(outlines)) = (&seen.irradiance, seen.form.outlines) else {
            return;
        };
        let lanes = seen.lanes & clear & self.points.matt;
        if lanes != 0 {
            let lanes = lanes & outlines.far(&self.points, strata.0 * strata.1);
            let radiance = area_lanes::reflect_all(&self.points, seen.form.light, irradiance);
            add(total, &radiance, lanes);
            seen.lanes &= !lanes;
        }
    }

    /// Adds an area light but for what `hide` takes out of its samples' lanes; exact rays are left
    /// to be traced. How many rays `hide` took.
    pub(super) fn area_lit(
        &self,
        seen: &SeenArea<'_>,
        total: &mut RadianceLanes,
        work: &mut GroupWork<'_>,
        mut hide: impl FnMut(&mut [AreaLanes]) -> u64,
    ) -> u64 {
        let mut count = 0;
        self.for_each_set(seen, work.strata, work.samples, |samples| {
            for sample in &mut *samples {
                let exact = bits(&sample.exact) & sample.lit;
                if exact != 0 {
                    self.leave(seen.index, sample, exact, work.exact);
                    sample.lit &= !exact;
                }
            }
            count += hide(samples);
            add_all(total, samples);
        });
        count
    }

    /// Takes out of samples what a light's list hides of them in the `asked` lanes. How many rays
    /// that took.
    pub(super) fn hide_listed(
        &self,
        samples: &mut [AreaLanes],
        asked: u32,
        occluders: &mut AreaOccluders<'_>,
    ) -> u64 {
        let mut count = 0;
        if samples.len() < MANY {
            for sample in samples {
                let asked = sample.lit & asked;
                if asked != 0 {
                    count += u64::from(asked.count_ones());
                    let rays = self.segments(sample, asked);
                    sample.lit &= !occluders.blocked(&rays);
                }
            }
            return count;
        }
        for lane in lanes_of(asked) {
            let apex = [0, 1, 2].map(|axis| self.points.origin[axis][lane]);
            let mut is_seen = false;
            for samples in samples.chunks_mut(PACKET) {
                let mut targets = [[0.0; PACKET]; 3];
                let mut lit = 0;
                for (index, sample) in samples.iter().enumerate() {
                    lit |= (sample.lit >> lane & 1) << index;
                    for axis in 0..3 {
                        targets[axis][index] = sample.target[axis][lane];
                    }
                }
                if lit == 0 {
                    continue;
                }
                count += u64::from(lit.count_ones());
                if !is_seen {
                    occluders.look_from(apex);
                    is_seen = true;
                }
                let rays = RayPacket::spread(apex, &targets, lit);
                for index in lanes_of(occluders.blocked_from_there(&rays)) {
                    samples[index].lit &= !(1 << lane);
                }
            }
        }
        count
    }

    /// Adds an area light, exact rays and all, where the scene lets it through.
    pub(super) fn area_traced(
        &self,
        seen: &SeenArea<'_>,
        is_cached: bool,
        total: &mut RadianceLanes,
        work: &mut GroupWork<'_>,
    ) -> u64 {
        let mut count = 0;
        let GroupWork { world, cache, .. } = work;
        self.for_each_set(seen, work.strata, work.samples, |samples| {
            for sample in samples.iter_mut().filter(|sample| sample.lit != 0) {
                count += u64::from(sample.lit.count_ones());
                let rays = self.segments(sample, sample.lit);
                let cache = is_cached.then_some(&mut **cache);
                sample.lit &= !blocked(world, cache, seen.index, &rays);
            }
            add_all(total, samples);
        });
        count
    }

    /// Calls `found` with the samples of an area light: those that all of some lanes take.
    fn for_each_set(
        &self,
        seen: &SeenArea<'_>,
        strata: (u32, u32),
        samples: &mut Vec<AreaLanes>,
        mut found: impl FnMut(&mut [AreaLanes]),
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
            for sample in &mut *samples {
                sample.lit = carrying(&sample.radiance) & lanes;
            }
            found(samples);
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
}

/// Adds samples in the lanes that they light.
fn add_all(total: &mut RadianceLanes, samples: &[AreaLanes]) {
    for sample in samples.iter().filter(|sample| sample.lit != 0) {
        add(total, &sample.radiance, sample.lit);
    }
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
