//! Primary visibility: what the camera rays of a square of pixels meet.

use glam::{UVec2, Vec2, Vec3};
use lie_accel::{PACKET, RayPacket};
use lie_geom::RandomKey;
use lie_scene::{CameraFilm, SurfaceLanes};

use crate::{
    Brdf, FrameSettings, Tile, World, groups::Groups, point_lanes::Lanes,
    shading_point::ShadingPoint,
};

/// Pixels along a side of a square.
pub(crate) const SQUARE: u32 = 64;

/// Pixels along a side of a packet of camera rays.
const BLOCK: u32 = 4;

/// What shoots a frame's camera rays.
pub(crate) struct FirstHits<'a> {
    pub(crate) world: &'a World,
    pub(crate) film: CameraFilm,
    pub(crate) settings: &'a FrameSettings,
    /// Whether any light needs its points one by one.
    pub(crate) is_one_by_one: bool,
}

/// What a square's camera rays met. To be used again for the next square: what it has allocated
/// stays.
#[derive(Default)]
pub(crate) struct SquareHits {
    /// In packets of 4 × 4 pixels, in Z order, so that points that follow each other are near
    /// each other.
    pub(crate) blocks: Groups,
    surfaces: SurfaceLanes,
}

impl FirstHits<'_> {
    /// Shoots the rays of a square's pixels, and adds emission and background to their sums.
    /// `points` become what they met one by one, if that is wanted. How many rays.
    pub(crate) fn find(
        &self,
        square: Tile,
        sample: u32,
        hits: &mut SquareHits,
        points: &mut Vec<ShadingPoint<'_>>,
        sums: &mut [Vec3],
    ) -> u64 {
        hits.blocks.clear();
        points.clear();
        for index in 0..(SQUARE / BLOCK) * (SQUARE / BLOCK) {
            let start = BLOCK * UVec2::new(every_other_bit(index), every_other_bit(index >> 1));
            if start.cmplt(square.size).all() {
                self.find_block((square, start), sample, hits, points, sums);
            }
        }
        u64::from(square.size.x) * u64::from(square.size.y)
    }

    /// Up to 4 × 4 pixels of a square, from `start` on.
    fn find_block(
        &self,
        (square, start): (Tile, UVec2),
        sample: u32,
        hits: &mut SquareHits,
        points: &mut Vec<ShadingPoint<'_>>,
        sums: &mut [Vec3],
    ) {
        let scene = self.world.scene();
        let size = (square.size - start).min(UVec2::splat(BLOCK));
        let count = (size.x * size.y) as usize;
        let mut places: [Lanes; 2] = [[0.0; PACKET]; 2];
        let mut pixels = [0; PACKET];
        let mut keys = [RandomKey::new(0); PACKET];
        for lane in 0..count {
            let pixel = start + UVec2::new(lane as u32 % size.x, lane as u32 / size.x);
            let (place, key): (Vec2, _) = self.settings.film_place(square.origin + pixel, sample);
            (places[0][lane], places[1][lane]) = (place.x, place.y);
            pixels[lane] = (pixel.y * square.size.x + pixel.x) as usize;
            keys[lane] = key;
        }
        let directions = self.film.directions(&places);
        let lanes = (1u32 << count) - 1;
        let packet = RayPacket::from_eye(self.film.eye().to_array(), &directions, lanes);
        let found = self.world.accel().closest_packet(&packet);
        let surfaces = &mut hits.surfaces;
        scene.surfaces(&directions, &found, surfaces);
        for lane in 0..count {
            sums[pixels[lane]] += if surfaces.hits >> lane & 1 == 1 {
                let front = surfaces.front >> lane & 1 == 1;
                self.world.emission_of(surfaces.material[lane], front)
            } else {
                scene.background.radiance
            };
            if self.is_one_by_one && surfaces.hits >> lane & 1 == 1 {
                let surface = surfaces.surface(lane);
                points.push(ShadingPoint {
                    pixel: pixels[lane],
                    key: keys[lane],
                    brdf: Brdf::new(scene, &surface),
                    surface,
                    cell: None,
                });
            }
        }
        if surfaces.hits != 0 {
            let block = hits.blocks.push();
            block.points.look(scene, surfaces, &keys);
            (block.pixels, block.lanes) = (pixels, surfaces.hits);
        }
    }
}

/// The bits at even places.
fn every_other_bit(number: u32) -> u32 {
    let bits = number & 0x5555;
    let bits = (bits | bits >> 1) & 0x3333;
    let bits = (bits | bits >> 2) & 0x0f0f;
    (bits | bits >> 4) & 0x00ff
}
