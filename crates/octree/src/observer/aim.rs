use glam::Vec3;
use lie_geom::Ray;

use super::{Observer, lanes};
use crate::{GROUP, Outcome, ShadowRay, Visibility};

/// Most triangles that rays are aimed past, for one light to which each point has one ray.
const AIMED: usize = 1024;

impl<V: Visibility> Observer<'_, V> {
    /// Where one triangle blocks a light, its neighbours often do as well: aims rays past
    /// them, from points in the same cell. Few random rays would come by a small triangle.
    pub(super) fn aim_past_new(&mut self, light: u32, rays: &[ShadowRay]) {
        // Many rays from each point find what is small by themselves.
        let points = rays.chunk_by(|a, b| a.point == b.point).count();
        let mut left = AIMED * points / rays.len().max(1);
        let mut neighbours = std::mem::take(&mut self.scratch.neighbours);
        while let Some((place, triangle)) = self.scratch.fresh.pop() {
            neighbours.clear();
            self.world.neighbours(triangle, &mut neighbours);
            for &neighbour in &neighbours {
                if left > 0 && self.aim_past(light, rays, place, neighbour) {
                    left -= 1;
                }
            }
        }
        self.scratch.neighbours = neighbours;
    }

    /// Says whether there was anything to aim past.
    fn aim_past(&mut self, light: u32, rays: &[ShadowRay], place: usize, triangle: u32) -> bool {
        let listed = self.listed(place, light);
        let is_listed = listed.iter().any(|known| known.triangle == triangle);
        let source = self.scratch.sources[place].clone();
        if is_listed || self.scratch.found[place].contains(&triangle) || source.is_empty() {
            return false;
        }
        let random = self
            .random
            .mix(u64::from(light) | u64::from(triangle) << 32);
        let mut points = [0; GROUP];
        let mut aimed = [Ray::new(Vec3::ZERO, Vec3::X); GROUP];
        let mut len = 0;
        for index in 0..GROUP as u32 {
            let pick = (random.uniform(index) * source.len() as f32) as usize;
            let point = rays[source.start + pick.min(source.len() - 1)].point;
            let random = random.mix(u64::from(index));
            let ray = self.world.aim(point, triangle, light, random);
            let here = |ray: &Ray| std::ptr::eq(self.tree.lie_at(ray.origin), self.cells[place]);
            if let Some(ray) = ray.filter(here) {
                (points[len], aimed[len]) = (point, ray);
                len += 1;
            }
        }
        let gathered = self.world.gather(&aimed[..len]);
        let mut blocked = self.world.blocked_by(triangle, &gathered);
        let known = listed.iter().map(|known| known.triangle);
        for known in known.chain(self.scratch.found[place].iter().copied()) {
            if blocked == 0 {
                return true;
            }
            blocked &= !self.world.blocked_by(known, &gathered);
        }
        let Some(lane) = lanes(blocked).next() else {
            return true;
        };
        self.scratch.found[place].push(triangle);
        self.scratch.fresh.push((place, triangle));
        self.observations[points[lane] as usize]
            .outcomes
            .push(Outcome {
                blocker: Some(triangle),
                ..Outcome::of(light)
            });
        true
    }
}
