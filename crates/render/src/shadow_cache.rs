use std::borrow::Cow;

use lie_accel::RayPacket;

use crate::World;

/// What blocked the last rays to each light: the next ones start near by, and it often blocks
/// them as well (Haines and Greenberg 1986, *The Light Buffer*, have the same of one triangle).
/// It answers as the scene does, sooner.
pub(crate) struct ShadowCache {
    /// For each light the triangles, the latest first.
    recent: Vec<[u32; WAYS]>,
}

/// Triangles that are remembered of each light.
const WAYS: usize = 4;

/// No triangle.
const NONE: u32 = u32::MAX;

impl ShadowCache {
    /// One that remembers nothing, for a scene with so many lights.
    pub(crate) fn new(lights: usize) -> Self {
        Self {
            recent: vec![[NONE; WAYS]; lights],
        }
    }

    /// Which rays of a packet the scene blocks, all to one light: bit `i` for ray `i`.
    pub(crate) fn blocked(&mut self, world: &World, light: u32, rays: &RayPacket) -> u32 {
        let recent = &mut self.recent[light as usize];
        let mut rest = Cow::Borrowed(rays);
        let mut blocked = 0;
        for place in 0..WAYS {
            let Some(shape) = world.triangle(recent[place]) else {
                break;
            };
            let hit = rest.blocked_by(shape);
            if hit != 0 {
                recent[..=place].rotate_right(1);
                blocked |= hit;
                rest.to_mut().leave_out(hit);
                if rest.is_empty() {
                    return blocked;
                }
            }
        }
        if blocked == 0 {
            // They lie elsewhere by now.
            *recent = [NONE; WAYS];
        }
        for (ray, blocker) in world.accel().blocker_packet(&rest).into_iter().enumerate() {
            let Some(triangle) = blocker else { continue };
            blocked |= 1 << ray;
            if !recent.contains(&triangle) && !world.has_holes(triangle) {
                recent.rotate_right(1);
                recent[0] = triangle;
            }
        }
        blocked
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;
    use lie_accel::PACKET;
    use lie_geom::{RandomKey, Ray};
    use lie_scene::{Gallery, gallery};

    use super::*;

    fn place(bounds: lie_geom::Aabb, key: RandomKey, n: u32) -> Vec3 {
        let xy = key.uniform2(2 * n);
        bounds.min + bounds.size() * Vec3::new(xy.x, xy.y, key.uniform(2 * n + 1))
    }

    #[test]
    fn it_answers_as_the_scene_does() {
        let scene = gallery(&Gallery {
            detail: 0.2,
            ..Gallery::default()
        });
        let world = World::new(Arc::new(scene));
        let bounds = world.scene().geometry.bounds();
        let mut cache = ShadowCache::new(3);
        let mut counts = [0; 2];
        for number in 0..600 {
            // Rays start near those before, as pixels' do, to one of three lights.
            let light = number % 3;
            let key = RandomKey::new(u64::from(number / 30));
            let lamp = place(bounds, RandomKey::new(7), light);
            let here = place(bounds, key, 0);
            let near = RandomKey::new(u64::from(number)).mix(1);
            let ray = |lane: u32| {
                let start = here + 0.05 * (place(bounds, near, lane) - here);
                Ray::segment(start, lamp)
            };
            let rays: Vec<Ray> = (0..PACKET as u32 - number % 5).map(ray).collect();
            let packet = RayPacket::new(&rays);
            let expected = world.accel().blocked_packet(&packet);
            assert_eq!(cache.blocked(&world, light, &packet), expected);
            counts[0] += expected.count_ones();
            counts[1] += rays.len() as u32 - expected.count_ones();
        }
        assert!(counts.iter().all(|&count| count > 500), "{counts:?}");
    }
}
