use glam::Vec3;
use lie_geom::Ray;

use super::{Observer, lanes, listed};
use crate::{Outcome, ShadowRay, Visibility};

/// Triangles that rays are aimed past in vain before it ends, for one light to which each
/// point has one ray.
const VAIN: usize = 64;

/// Rays that are aimed past one triangle.
const TRIES: u32 = 8;

/// A list that needs no help to grow.
const LONG: usize = 64;

impl<V: Visibility> Observer<'_, V> {
    /// Where one triangle blocks a light, its neighbours often do as well: aims rays past
    /// them, from points in the same cell. Few random rays would come by a small triangle.
    pub(super) fn aim_past_new(&mut self, light: u32, rays: &[ShadowRay]) {
        // Many rays from each point find what is small by themselves.
        let points = rays.chunk_by(|a, b| a.point == b.point).count();
        let mut vain = VAIN * points / rays.len().max(1);
        let mut neighbours = std::mem::take(&mut self.scratch.neighbours);
        while let Some((place, triangle)) = self.scratch.fresh.pop() {
            if vain == 0 || !self.scratch.reached[place] {
                continue;
            }
            neighbours.clear();
            self.world.neighbours(triangle, &mut neighbours);
            for &neighbour in &neighbours {
                match self.aim_past(light, rays, place, neighbour) {
                    Some(true) => vain += 1,
                    Some(false) if vain > 0 => vain -= 1,
                    _ => {}
                }
            }
        }
        self.scratch.neighbours = neighbours;
    }

    /// Whether a triangle turned out to block the light; `None` if that was known, or there
    /// is nowhere to aim from.
    fn aim_past(
        &mut self,
        light: u32,
        rays: &[ShadowRay],
        place: usize,
        triangle: u32,
    ) -> Option<bool> {
        let listed = listed(&self.cells[place], light);
        let is_listed = listed.iter().any(|known| known.triangle() == triangle);
        let source = self.scratch.sources[place].clone();
        let found = &self.scratch.found[place];
        let is_long = listed.len() + found.len() > LONG;
        if is_listed || is_long || found.contains(&triangle) || source.is_empty() {
            return None;
        }
        let random = self
            .random
            .mix(u64::from(light) | u64::from(triangle) << 32);
        let mut points = [0; TRIES as usize];
        let mut aimed = [Ray::new(Vec3::ZERO, Vec3::X); TRIES as usize];
        let mut len = 0;
        for index in 0..TRIES {
            let pick = (random.uniform(index) * source.len() as f32) as usize;
            let point = rays[source.start + pick.min(source.len() - 1)].point;
            let random = random.mix(u64::from(index));
            let ray = self.world.aim(point, triangle, light, random);
            let here = |(_, start): &(Ray, Vec3)| {
                std::ptr::eq(self.tree.packed_at(*start), self.packed[place])
            };
            if let Some((ray, _)) = ray.filter(here) {
                (points[len], aimed[len]) = (point, ray);
                len += 1;
            }
        }
        let gathered = self.world.gather(&aimed[..len]);
        let mut blocked = self.world.blocked_by(triangle, &gathered);
        let known = listed.iter().map(|known| known.triangle());
        for known in known.chain(self.scratch.found[place].iter().copied()) {
            if blocked == 0 {
                return Some(false);
            }
            blocked &= !self.world.blocked_by(known, &gathered);
        }
        let Some(lane) = lanes(blocked).next() else {
            return Some(false);
        };
        self.scratch.found[place].push(triangle);
        self.scratch.fresh.push((place, triangle));
        self.observations[points[lane] as usize]
            .outcomes
            .push(Outcome {
                blocker: Some(triangle),
                ..Outcome::of(light)
            });
        Some(true)
    }
}
