use glam::Vec3;
use lie_accel::{PACKET, RayPacket};
use lie_geom::{RandomKey, Ray};
use lie_render::{Brdf, LightPoints, World};
use lie_scene::Surface;

use super::view::{Square, ViewProgress};

/// A pixel's surface point.
pub(super) struct Point {
    pub(super) surface: Surface,
    pub(super) brdf: Brdf,
    pub(super) key: RandomKey,
}

impl Point {
    pub(super) fn light_points(&self, strata: (u32, u32)) -> LightPoints<'_> {
        LightPoints {
            surface: &self.surface,
            brdf: &self.brdf,
            key: self.key,
            strata,
        }
    }
}

/// What the camera sees in a square's pixels, traced in packets of 4 × 4.
pub(super) fn visible_points(world: &World, progress: &ViewProgress, square: Square) -> Vec<Point> {
    let mut points = vec![];
    for block in square.blocks() {
        let mut rays = [Ray::new(Vec3::ZERO, Vec3::X); PACKET];
        let mut keys = [RandomKey::new(0); PACKET];
        let mut len = 0;
        for pixel in block {
            let (ray, key) = progress.camera_ray(pixel, square.pass);
            (rays[len], keys[len]) = (ray, key);
            len += 1;
        }
        let hits = world.accel().closest_packet(&RayPacket::new(&rays[..len]));
        for lane in 0..len {
            let Some(hit) = &hits[lane] else { continue };
            let surface = world.scene().surface(&rays[lane], hit);
            points.push(Point {
                brdf: Brdf::new(world.scene(), &surface),
                surface,
                key: keys[lane],
            });
        }
    }
    points
}
