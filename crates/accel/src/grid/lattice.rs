use std::ops::ControlFlow;

use glam::{DVec3, UVec3};
use lie_geom::Ray;

/// A box cut into equal cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    pub(super) min: DVec3,
    /// Size of a cell; positive along every axis.
    pub(super) cell: DVec3,
    /// Cells per metre.
    density: DVec3,
    /// Cells along each axis, at least one.
    pub(super) counts: UVec3,
}

impl Lattice {
    pub(super) fn new(min: DVec3, size: DVec3, counts: UVec3) -> Self {
        let count = counts.as_dvec3();
        Self {
            min,
            cell: size / count,
            density: count / size,
            counts,
        }
    }

    /// One of this lattice's cells, cut itself.
    #[inline(always)]
    pub(super) fn cut(&self, place: UVec3, counts: UVec3) -> Self {
        let count = counts.as_dvec3();
        Self {
            min: self.corner(place),
            cell: self.cell / count,
            density: self.density * count,
            counts,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.counts.x as usize * self.counts.y as usize * self.counts.z as usize
    }

    pub(super) fn index(&self, place: UVec3) -> usize {
        let [x, y, z] = [place.x, place.y, place.z].map(|index| index as usize);
        (z * self.counts.y as usize + y) * self.counts.x as usize + x
    }

    /// The lower corner of a cell.
    pub(super) fn corner(&self, place: UVec3) -> DVec3 {
        self.min + place.as_dvec3() * self.cell
    }

    /// The cell that a point is in; the nearest one if it is outside.
    pub(super) fn place(&self, point: DVec3) -> UVec3 {
        // The cast takes what is negative or undefined to 0.
        ((point - self.min) * self.density)
            .as_uvec3()
            .min(self.counts - UVec3::ONE)
    }

    /// Calls `visit` with each cell along a ray between two distances, in order, and with
    /// the distances at which the ray enters and leaves the cell (Amanatides and Woo 1987).
    ///
    /// The ray is in the lattice all the way, but for rounding.
    #[inline(always)]
    pub(super) fn walk(
        &self,
        ray: &GridRay,
        [mut t, end]: [f64; 2],
        mut visit: impl FnMut(UVec3, [f64; 2]) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut place = self.place(ray.origin + t * ray.direction).to_array();
        let mut leave = [0.0; 3];
        for axis in 0..3 {
            leave[axis] = self.leave(ray, place[axis], axis);
        }
        loop {
            let axis = if leave[0] < leave[1] {
                if leave[0] < leave[2] { 0 } else { 2 }
            } else if leave[1] < leave[2] {
                1
            } else {
                2
            };
            // Where rounding put the start past a border, the cell is left at once.
            let exit = leave[axis].max(t);
            visit(UVec3::from_array(place), [t, exit.min(end)])?;
            let next = if ray.direction[axis] < 0.0 {
                place[axis].checked_sub(1)
            } else {
                Some(place[axis] + 1).filter(|&next| next < self.counts[axis])
            };
            let Some(next) = next.filter(|_| exit < end) else {
                return ControlFlow::Continue(());
            };
            place[axis] = next;
            leave[axis] = self.leave(ray, next, axis);
            t = exit;
        }
    }

    /// Where a ray meets a cell's far side along one axis. From the cell's number each time:
    /// rounding does not add up.
    #[inline(always)]
    fn leave(&self, ray: &GridRay, index: u32, axis: usize) -> f64 {
        if ray.direction[axis] == 0.0 {
            return f64::INFINITY;
        }
        let side = index + u32::from(ray.direction[axis] > 0.0);
        let plane = self.min[axis] + f64::from(side) * self.cell[axis];
        (plane - ray.origin[axis]) * ray.inverse[axis]
    }
}

/// A ray in double precision: cells are found without an error worth the name.
pub(super) struct GridRay {
    origin: DVec3,
    direction: DVec3,
    inverse: DVec3,
}

impl GridRay {
    pub(super) fn new(ray: &Ray) -> Self {
        let direction = ray.direction.as_dvec3();
        Self {
            origin: ray.origin.as_dvec3(),
            direction,
            inverse: direction.recip(),
        }
    }

    /// The part of `[from, to]` in which the ray is inside a box.
    pub(super) fn clip(&self, min: DVec3, max: DVec3, [mut from, mut to]: [f64; 2]) -> [f64; 2] {
        for axis in 0..3 {
            if self.direction[axis] == 0.0 {
                if !(min[axis]..=max[axis]).contains(&self.origin[axis]) {
                    return [f64::INFINITY, f64::NEG_INFINITY];
                }
                continue;
            }
            let one = (min[axis] - self.origin[axis]) * self.inverse[axis];
            let other = (max[axis] - self.origin[axis]) * self.inverse[axis];
            from = from.max(one.min(other));
            to = to.min(one.max(other));
        }
        [from, to]
    }
}

/// How many cells along each axis make about `budget` nearly cubic ones of a box, and never
/// more: along an axis too thin for two there is one, and the others share the rest.
pub(super) fn resolution(size: DVec3, budget: f64, most: u32) -> UVec3 {
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| size[a].total_cmp(&size[b]));
    let mut counts = UVec3::ONE;
    let mut left = budget.max(1.0);
    for (done, &axis) in axes.iter().enumerate() {
        let rest = &axes[done..];
        // Cells per metre, if those along the rest of the axes are to be cubes.
        let volume: f64 = rest.iter().map(|&axis| size[axis]).product();
        let density = (left / volume).powf(1.0 / rest.len() as f64);
        let wanted = size[axis] * density;
        counts[axis] = (wanted.floor() as u32).clamp(1, most);
        left = (left / f64::from(counts[axis])).max(1.0);
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_resolution_keeps_to_its_budget() {
        for (size, budget, expected) in [
            (DVec3::ONE, 1000.0, [10, 10, 10]),
            (DVec3::ONE, 0.3, [1, 1, 1]),
            (DVec3::new(1.0, 1.0, 1.0e-9), 100.0, [10, 10, 1]),
            (DVec3::new(1.0e-9, 8.0, 1.0e-9), 8.0, [1, 8, 1]),
            (DVec3::new(2.0, 1.0, 1.0), 16.0, [4, 2, 2]),
            (DVec3::splat(1.0e30), 27.0, [3, 3, 3]),
        ] {
            let counts = resolution(size * 1.000_000_1, budget * 1.000_001, 1024);
            assert_eq!(counts.to_array(), expected, "{size} {budget}");
        }
        assert_eq!(resolution(DVec3::ONE, 1.0e12, 16), UVec3::splat(16));
    }

    #[test]
    fn a_walk_visits_neighbours_in_order() {
        let lattice = Lattice::new(DVec3::ZERO, DVec3::splat(4.0), UVec3::splat(4));
        let along = |origin: Vec3, direction: Vec3| {
            let ray = GridRay::new(&Ray::new(origin, direction));
            let range = ray.clip(DVec3::ZERO, DVec3::splat(4.0), [0.0, f64::INFINITY]);
            let mut places = vec![];
            let mut before = range[0];
            if range[0] <= range[1] {
                let _ = lattice.walk(&ray, range, |place, [enter, leave]| {
                    assert!(enter >= before && leave >= enter);
                    before = leave;
                    places.push(place.to_array());
                    ControlFlow::Continue(())
                });
            }
            places
        };
        let row = along(Vec3::new(-1.0, 0.5, 2.5), Vec3::X);
        assert_eq!(row, [[0, 0, 2], [1, 0, 2], [2, 0, 2], [3, 0, 2]]);
        let back = along(Vec3::new(3.5, 0.5, 2.5), Vec3::new(-0.1, 0.0, -0.0));
        assert_eq!(back, [[3, 0, 2], [2, 0, 2], [1, 0, 2], [0, 0, 2]]);
        // Through corners: some way round each, and to the end.
        let diagonal = along(Vec3::ZERO, Vec3::ONE);
        assert_eq!(diagonal.last(), Some(&[3, 3, 3]));
        assert_eq!(along(Vec3::new(0.5, 5.0, 0.5), Vec3::X), [[0u32; 3]; 0]);
    }
}
