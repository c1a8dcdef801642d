use std::array;

use glam::{UVec2, Vec3};
use lie_accel::{PACKET, RayPacket};
use lie_render::{Film, RadianceTile, RenderStats, Tile, tiles};
use rayon::prelude::*;

use crate::Stage;

/// Pixels along a side of a packet.
const BLOCK: u32 = 4;

/// Traces a view's camera rays, through the centres of its pixels, and nothing else. The picture
/// is the cosine between each triangle's normal and the ray, and black where there is nothing.
/// Both sides of it are multiples of four.
pub(super) fn closest_hits(
    stage: &Stage,
    progress: &mut (dyn FnMut(f32) + Send),
) -> (Film, RenderStats) {
    let size = stage.settings().size;
    let rendered: Vec<_> = tiles(size)
        .into_par_iter()
        .map(|tile| RadianceTile::new(tile, trace(stage, tile)))
        .collect();
    let mut film = Film::new(size);
    for tile in rendered.into_iter().flatten() {
        assert!(film.put(&tile), "tiles lie inside their film");
    }
    progress(1.0);
    let stats = RenderStats {
        primary_rays: stage.pixels(),
        ..RenderStats::default()
    };
    (film, stats)
}

fn trace(stage: &Stage, tile: Tile) -> Vec<Vec3> {
    let (world, film) = (stage.world(), stage.camera().film(stage.settings().size));
    let mut cosines = vec![Vec3::ZERO; (tile.size.x * tile.size.y) as usize];
    for y in (0..tile.size.y).step_by(BLOCK as usize) {
        for x in (0..tile.size.x).step_by(BLOCK as usize) {
            // As a frame does: all from one place, and directions in lanes.
            let pixels: [UVec2; PACKET] =
                array::from_fn(|lane| UVec2::new(x + lane as u32 % BLOCK, y + lane as u32 / BLOCK));
            let mut places = [[0.0; PACKET]; 2];
            for (lane, pixel) in pixels.iter().enumerate() {
                let place = (tile.origin + pixel).as_vec2() + 0.5;
                (places[0][lane], places[1][lane]) = (place.x, place.y);
            }
            let directions = film.directions(&places);
            let rays = RayPacket::from_eye(film.eye().to_array(), &directions, 0xffff);
            let hits = world.accel().closest_packet(&rays);
            for (lane, hit) in hits.iter().enumerate() {
                let Some(hit) = hit else { continue };
                let normal = world.scene().geometry.triangle(hit.triangle).normal;
                let direction = Vec3::from(directions.map(|axis| axis[lane]));
                let cosine = normal.dot(direction).abs();
                cosines[(pixels[lane].y * tile.size.x + pixels[lane].x) as usize] =
                    Vec3::splat(cosine);
            }
        }
    }
    cosines
}

#[cfg(test)]
mod tests {
    use super::*;
    use lie_render::AccelKind;
    use std::sync::Arc;

    #[test]
    fn a_wall_that_is_looked_at_straight_is_bright() {
        let scene = Arc::new(lie_scene::cornell_box());
        let camera = scene.cameras[0].clone();
        let stage = Stage::new("", scene, camera, UVec2::new(80, 64), AccelKind::default());
        let (film, stats) = closest_hits(&stage, &mut |_| {});
        let pixel = |x: usize, y: usize| film.radiance()[80 * y + x].x;
        assert!(pixel(40, 20) > 0.99, "the back wall");
        assert!((0.01..0.5).contains(&pixel(40, 62)), "the floor");
        assert_eq!(pixel(0, 0), 0.0, "nothing");
        assert_eq!(stats.primary_rays, 80 * 64);
    }
}
