//! Sixteen rays together: each box and each triangle is loaded once and tested against all
//! of them.

mod bounds;
mod fan_planes;
mod hits;
mod occluders;
mod traverse;

use lie_geom::{Ray, SHADOW_T_MAX};

use crate::node::{WIDER, inverse};

pub use occluders::{BlockPart, FanOccluders, OccluderBlocks};
pub(crate) use traverse::{blocked, blockers, closest};

/// Rays per packet.
pub const PACKET: usize = 16;

/// One number for each ray.
pub(crate) type Lanes = [f32; PACKET];

/// Sixteen rays, one coordinate after the other. Coherent ones (a tile of pixels, or many
/// points towards one light) pay off; any others are still right.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct RayPacket {
    origin: [Lanes; 3],
    direction: [Lanes; 3],
    t_min: Lanes,
    t_max: Lanes,
    /// Where all rays start, if they do: what depends on a triangle and its distance to the
    /// origin alone is then worked out once for all lanes.
    apex: Option<[f32; 3]>,
}

impl RayPacket {
    /// A packet of up to sixteen rays; the lanes left over hit nothing.
    ///
    /// # Panics
    /// If there are more than sixteen.
    #[must_use]
    pub fn new(rays: &[Ray]) -> Self {
        assert!(rays.len() <= PACKET, "a packet holds {PACKET} rays");
        let mut packet = Self {
            origin: [[0.0; PACKET]; 3],
            direction: [[0.0; PACKET]; 3],
            t_min: [0.0; PACKET],
            t_max: [f32::NEG_INFINITY; PACKET],
            apex: None,
        };
        for (lane, ray) in rays.iter().enumerate() {
            packet.set(lane, ray);
        }
        let first = rays.first().map(|ray| ray.origin);
        if rays.iter().all(|ray| Some(ray.origin) == first) {
            packet.apex = first.map(|origin| origin.to_array());
        }
        packet
    }

    /// The segments from one place, where a light is, to sixteen others
    /// ([`Ray::segment_from`]). Only the lanes whose bits are set hit anything.
    #[must_use]
    #[inline]
    pub fn fan(apex: [f32; 3], ends: &[[f32; PACKET]; 3], lanes: u32) -> Self {
        let origin = apex.map(|axis| [axis; PACKET]);
        let mut packet = Self::between(&origin, ends, [1.0 - SHADOW_T_MAX, 1.0], lanes);
        packet.apex = Some(apex);
        packet
    }

    /// The segments between sixteen pairs of places ([`Ray::segment`]). Only the lanes whose
    /// bits are set hit anything.
    #[must_use]
    #[inline]
    pub fn segments(origin: &[[f32; PACKET]; 3], target: &[[f32; PACKET]; 3], lanes: u32) -> Self {
        Self::between(origin, target, [0.0, SHADOW_T_MAX], lanes)
    }

    #[inline]
    fn between(start: &[Lanes; 3], end: &[Lanes; 3], t: [f32; 2], active: u32) -> Self {
        let mut packet = Self {
            origin: *start,
            direction: [[0.0; PACKET]; 3],
            t_min: [t[0]; PACKET],
            t_max: [f32::NEG_INFINITY; PACKET],
            apex: None,
        };
        for axis in 0..3 {
            for lane in 0..PACKET {
                packet.direction[axis][lane] = end[axis][lane] - start[axis][lane];
            }
        }
        let active = lanes(active);
        for lane in 0..PACKET {
            packet.t_max[lane] = if active[lane] {
                t[1]
            } else {
                f32::NEG_INFINITY
            };
        }
        packet
    }

    /// One lane's ray; that of a lane left over is undefined, and hits nothing.
    pub(crate) fn ray(&self, lane: usize) -> Ray {
        let [origin, direction] =
            [&self.origin, &self.direction].map(|axes| axes.map(|axis| axis[lane]).into());
        Ray {
            origin,
            direction,
            t_min: self.t_min[lane],
            t_max: self.t_max[lane],
        }
    }

    fn set(&mut self, lane: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
        self.t_min[lane] = ray.t_min;
        // An undefined ray would poison comparisons; it hits nothing.
        self.t_max[lane] = if ray.is_defined() {
            ray.t_max
        } else {
            f32::NEG_INFINITY
        };
    }

    /// Where a lane's ray starts; with `FAN`, where all of them do.
    #[inline(always)]
    fn start<const FAN: bool>(&self, apex: [f32; 3], lane: usize) -> [f32; 3] {
        if FAN {
            apex
        } else {
            [
                self.origin[0][lane],
                self.origin[1][lane],
                self.origin[2][lane],
            ]
        }
    }

    /// Some lanes hit nothing any more: bit `i` for ray `i`.
    #[inline]
    pub fn leave_out(&mut self, rays: u32) {
        finish(rays, &mut self.t_max);
    }

    /// Whether no lane hits anything.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.active() == 0
    }

    /// The lanes that look for anything: bit `i` for ray `i`.
    #[inline(always)]
    fn active(&self) -> u32 {
        let mut active = [0; PACKET];
        for lane in 0..PACKET {
            active[lane] = if self.is_active(lane) { 1 << lane } else { 0 };
        }
        union(&active)
    }

    /// Whether a lane looks for anything.
    #[inline(always)]
    fn is_active(&self, lane: usize) -> bool {
        self.t_max[lane] > f32::NEG_INFINITY
    }

    /// One over each direction.
    #[inline(always)]
    fn inverse(&self) -> [Lanes; 3] {
        // Loops: a closure would be compiled apart, without the vector unit.
        let mut inverses = [[0.0; PACKET]; 3];
        for axis in 0..3 {
            for lane in 0..PACKET {
                inverses[axis][lane] = inverse(self.direction[axis][lane]);
            }
        }
        inverses
    }

    /// The least and the largest direction of the active lanes, by axis.
    #[inline(always)]
    fn ways(&self) -> [[f32; 3]; 2] {
        let mut ways = [[0.0; 3]; 2];
        for axis in 0..3 {
            let [least, most] = self.extremes(&self.direction[axis]);
            ways[0][axis] = least;
            ways[1][axis] = most;
        }
        ways
    }

    /// The least and the largest number of the active lanes.
    #[inline(always)]
    fn extremes(&self, values: &Lanes) -> [f32; 2] {
        let mut low = [f32::INFINITY; PACKET];
        let mut high = [f32::NEG_INFINITY; PACKET];
        for lane in 0..PACKET {
            let active = self.is_active(lane);
            low[lane] = if active { values[lane] } else { f32::INFINITY };
            high[lane] = if active {
                values[lane]
            } else {
                f32::NEG_INFINITY
            };
        }
        [smallest(&low), largest(&high)]
    }

    /// Whether any lane enters a box before its bound.
    #[inline(always)]
    fn enters<const FAN: bool>(
        &self,
        inverse: &[Lanes; 3],
        (lowest, highest): ([f32; 3], [f32; 3]),
        bound: &Lanes,
    ) -> bool {
        let apex = self.apex.unwrap_or_default();
        let mut entered = [false; PACKET];
        for lane in 0..PACKET {
            let mut enter = self.t_min[lane];
            let mut leave = bound[lane];
            let origin = self.start::<FAN>(apex, lane);
            for axis in 0..3 {
                let t0 = (lowest[axis] - origin[axis]) * inverse[axis][lane];
                let t1 = (highest[axis] - origin[axis]) * inverse[axis][lane];
                let (near, far) = (if t0 < t1 { t0 } else { t1 }, if t0 < t1 { t1 } else { t0 });
                enter = if near > enter { near } else { enter };
                leave = if far * WIDER < leave {
                    far * WIDER
                } else {
                    leave
                };
            }
            entered[lane] = enter <= leave;
        }
        any(&entered)
    }
}

#[inline(always)]
fn any(lanes: &[bool; PACKET]) -> bool {
    let mut any = false;
    for &lane in lanes {
        any |= lane;
    }
    any
}

/// All bits that any lane has.
#[inline(always)]
fn union<const N: usize>(lanes: &[u32; N]) -> u32 {
    let mut folded = *lanes;
    let mut width = N;
    while width > 1 {
        width /= 2;
        for lane in 0..width {
            folded[lane] |= folded[lane + width];
        }
    }
    folded[0]
}

/// The lanes of a mask.
#[inline(always)]
fn lanes(mask: u32) -> [bool; PACKET] {
    let mut lanes = [false; PACKET];
    for lane in 0..PACKET {
        lanes[lane] = mask & (1 << lane) != 0;
    }
    lanes
}

/// Some rays enter and hit nothing more.
#[inline(always)]
fn finish(rays: u32, bound: &mut Lanes) {
    let rays = lanes(rays);
    for ray in 0..PACKET {
        bound[ray] = if rays[ray] {
            f32::NEG_INFINITY
        } else {
            bound[ray]
        };
    }
}

/// The smallest of sixteen numbers; undefined ones do not count.
#[inline(always)]
fn smallest(lanes: &Lanes) -> f32 {
    fold(lanes, |a, b| if a < b { a } else { b })
}

/// The largest of sixteen numbers; undefined ones do not count.
#[inline(always)]
fn largest(lanes: &Lanes) -> f32 {
    fold(lanes, |a, b| if a > b { a } else { b })
}

/// Folds halves onto each other: four vector operations, where a loop would wait for each
/// lane in turn.
#[inline(always)]
fn fold(lanes: &Lanes, take: impl Fn(f32, f32) -> f32) -> f32 {
    let mut folded = *lanes;
    let mut width = PACKET;
    while width > 1 {
        width /= 2;
        for lane in 0..width {
            folded[lane] = take(folded[lane], folded[lane + width]);
        }
    }
    folded[0]
}
