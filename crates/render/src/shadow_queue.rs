use glam::Vec3;
use lie_accel::{Accel, PACKET, RayPacket};
use lie_geom::Ray;

use crate::LightRay;

/// Shadow rays on their way through the whole scene, sixteen at a time, and the pixels
/// that their light is added to, in the order of arrival.
pub(crate) struct ShadowQueue<'a> {
    accel: &'a dyn Accel,
    rays: [Ray; PACKET],
    adds: [(usize, Vec3); PACKET],
    len: usize,
    pub(crate) traced: u64,
}

impl<'a> ShadowQueue<'a> {
    pub(crate) fn new(accel: &'a dyn Accel) -> Self {
        Self {
            accel,
            rays: [Ray::new(Vec3::ZERO, Vec3::X); PACKET],
            adds: [(0, Vec3::ZERO); PACKET],
            len: 0,
            traced: 0,
        }
    }

    /// Queues a ray; its light is added to `sums[pixel]` if nothing blocks it.
    #[inline]
    pub(crate) fn push(&mut self, light_ray: &LightRay, pixel: usize, sums: &mut [Vec3]) {
        // Rays from one origin cost less together; half a packet of them is worth it.
        if self.len >= PACKET / 2 && light_ray.ray.origin != self.rays[0].origin {
            self.flush(sums);
        }
        self.rays[self.len] = light_ray.ray;
        self.adds[self.len] = (pixel, light_ray.radiance);
        self.len += 1;
        if self.len == PACKET {
            self.flush(sums);
        }
    }

    /// Traces what is queued.
    pub(crate) fn flush(&mut self, sums: &mut [Vec3]) {
        if self.len == 0 {
            return;
        }
        let blocked = self
            .accel
            .blocked_packet(&RayPacket::new(&self.rays[..self.len]));
        for (lane, (pixel, radiance)) in self.adds[..self.len].iter().enumerate() {
            if blocked >> lane & 1 == 0 {
                sums[*pixel] += *radiance;
            }
        }
        self.traced += self.len as u64;
        self.len = 0;
    }
}
