//! Sixteen rays together: each box and each triangle is loaded once and tested against all
//! of them.

mod bounds;
mod fan_planes;
mod hits;
mod occluders;
mod rays;
mod slab;
mod traverse;
pub(crate) mod vector;

use lie_geom::{Ray, SHADOW_T_MAX};

pub use occluders::{BlockPart, FanOccluders, OccluderBlocks};
pub(crate) use traverse::{blocked, blockers, closest};

/// Rays per packet.
pub const PACKET: usize = 16;

/// One number for each ray.
pub(crate) type Lanes = [f32; PACKET];

/// Sixteen rays, one coordinate after the other. Coherent ones (a tile of pixels, or many
/// points towards one light) pay off; any others are still right.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
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

    /// Rays without end from one place, such as an eye, that is finite. Only the lanes whose bits
    /// are set hit anything.
    #[must_use]
    #[inline(always)]
    pub fn from_eye(apex: [f32; 3], directions: &[[f32; PACKET]; 3], lanes: u32) -> Self {
        let mut t_max = [f32::NEG_INFINITY; PACKET];
        for lane in 0..PACKET {
            if lanes & (1 << lane) != 0 {
                t_max[lane] = f32::INFINITY;
            }
        }
        Self {
            origin: everywhere(apex),
            direction: *directions,
            t_min: [0.0; PACKET],
            t_max,
            apex: Some(apex),
        }
    }

    /// The segments from one place, where a light is, to sixteen others
    /// ([`Ray::segment_from`]). Only the lanes whose bits are set hit anything.
    #[must_use]
    #[inline(always)]
    pub fn fan(apex: [f32; 3], ends: &[[f32; PACKET]; 3], lanes: u32) -> Self {
        let origin = everywhere(apex);
        let mut packet = Self::between(&origin, ends, [1.0 - SHADOW_T_MAX, 1.0], lanes);
        packet.apex = Some(apex);
        packet
    }

    /// The segments from one place to sixteen others ([`Ray::segment`]). Only the lanes whose bits
    /// are set hit anything.
    #[must_use]
    #[inline(always)]
    pub fn spread(apex: [f32; 3], targets: &[[f32; PACKET]; 3], lanes: u32) -> Self {
        let mut packet = Self::segments(&everywhere(apex), targets, lanes);
        packet.apex = Some(apex);
        packet
    }

    /// The segments between sixteen pairs of places ([`Ray::segment`]). Only the lanes whose
    /// bits are set hit anything.
    #[must_use]
    #[inline(always)]
    pub fn segments(origin: &[[f32; PACKET]; 3], target: &[[f32; PACKET]; 3], lanes: u32) -> Self {
        Self::between(origin, target, [0.0, SHADOW_T_MAX], lanes)
    }

    #[inline(always)]
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
        for lane in 0..PACKET {
            packet.t_max[lane] = if active & (1 << lane) != 0 {
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
        self.t_max[lane] = if ray.is_defined() && !ray.t_max.is_nan() {
            ray.t_max
        } else {
            f32::NEG_INFINITY
        };
    }

    /// Some lanes hit nothing any more: bit `i` for ray `i`.
    #[inline]
    pub fn leave_out(&mut self, rays: u32) {
        for lane in 0..PACKET {
            if rays & (1 << lane) != 0 {
                self.t_max[lane] = f32::NEG_INFINITY;
            }
        }
    }

    /// Whether no lane hits anything.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.t_max.iter().all(|&t_max| t_max == f32::NEG_INFINITY)
    }
}

/// One place in all lanes.
#[inline(always)]
fn everywhere([x, y, z]: [f32; 3]) -> [Lanes; 3] {
    [[x; PACKET], [y; PACKET], [z; PACKET]]
}
