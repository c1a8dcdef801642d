use glam::{UVec2, Vec3};
use lie_accel::{PACKET, RayPacket};
use lie_geom::{Hit, Ray};
use lie_octree::{CellKey, Cube};
use lie_render::World;

use super::{pass_rays::PassRays, square::Square};

/// A surface point of a view, by what its camera ray met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) pixel: UVec2,
    pub(super) hit: Hit,
    /// Where its shadow rays start.
    pub(super) origin: Vec3,
    /// The deepest cell around that: neighbours in space follow each other by it.
    pub(super) code: CellKey,
}

impl Place {
    /// What tells the neighbourhood's random numbers from others'.
    pub(super) fn code(&self) -> u64 {
        self.code.raw()
    }
}

/// What the camera sees in a square's pixels, traced in packets of 4 × 4.
pub(super) fn places(world: &World, cube: Cube, view: PassRays<'_>, square: Square) -> Vec<Place> {
    let mut places = Vec::with_capacity(square.pixels() as usize);
    for block in square.blocks() {
        let mut rays = [Ray::new(Vec3::ZERO, Vec3::X); PACKET];
        let mut pixels = [UVec2::ZERO; PACKET];
        let mut len = 0;
        for pixel in block {
            (rays[len], pixels[len]) = (view.camera_ray(pixel).0, pixel);
            len += 1;
        }
        let hits = world.accel().closest_packet(&RayPacket::new(&rays[..len]));
        for lane in 0..len {
            let Some(hit) = hits[lane] else { continue };
            let origin = world.scene().shadow_origin(&rays[lane], &hit);
            places.push(Place {
                pixel: pixels[lane],
                hit,
                origin,
                code: cube.key_at(origin, CellKey::MAX_DEPTH),
            });
        }
    }
    places
}
