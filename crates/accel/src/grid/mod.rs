//! The paper's structure (LIE §3, §6): a regular grid whose cells may hold grids of their own.

mod build;
mod lattice;
mod overlap;

use std::{ops::ControlFlow, sync::Arc};

use lie_geom::{Hit, Ray, Triangle};
use lie_scene::Geometry;

use self::lattice::{GridRay, Lattice};
use crate::{Accel, Cutout, PACKET, RayPacket};

/// A two-level grid over a scene's triangles. Its resolution follows the number of triangles
/// and the scene's extent (Cleary and Wyvill 1988), and a top cell's that of its own.
///
/// Rays walk from cell to cell in double precision, and a triangle is in every cell that it
/// meets or nearly meets, so no ray slips through between cells. Packets are taken ray by ray.
///
/// Memory is bounded: top cells are at most an eighth of the triangles' number, and where a
/// triangle would lie in more than four top cells or a top cell's in more than four small
/// ones, on average, cells are made larger. In all, a triangle has at most sixteen references
/// and ten cells, of four bytes each.
pub struct TwoLevelGrid {
    cells: Cells,
    triangles: Vec<Triangle>,
    cutout: Option<Arc<dyn Cutout>>,
}

/// Sizes, for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridStats {
    /// Cells along each axis, on top.
    pub top: [u32; 3],
    /// Cells of the second level, those of top cells that are not cut included.
    pub cells: usize,
    /// References from cells to triangles.
    pub references: usize,
    /// Memory of cells, references and triangles.
    pub bytes: usize,
}

/// The cells. `ids[starts[i]..starts[i + 1]]` are the triangles of small cell `i`; the small
/// cells of a top cell follow each other from its `first`, x before y before z.
#[derive(Default)]
struct Cells {
    /// None over no triangles.
    lattice: Option<Lattice>,
    top: Vec<TopCell>,
    /// One more for each top cell than it has small cells.
    starts: Vec<u32>,
    ids: Vec<u32>,
}

/// How a top cell is cut.
struct TopCell {
    first: u32,
    /// Small cells along each axis; zeros if nothing is in it.
    counts: [u16; 3],
}

/// How wrong the distance of a hit may be, relative to it: what lies almost along the ray is
/// hit at a distance of few true digits. Cells so far beyond a hit are still looked into.
const SLACK: f64 = 1.0e-4;

/// A distance, and what it may be wrong by.
fn beyond(t: f64) -> f64 {
    t + SLACK * t.abs()
}

impl TwoLevelGrid {
    /// Builds the grid, in parallel. `cutout` says where triangles have holes; `None` means
    /// nowhere.
    #[must_use]
    pub fn build(geometry: &Geometry, cutout: Option<Arc<dyn Cutout>>) -> Self {
        let triangles = geometry.shapes().to_vec();
        Self {
            cells: build::build(&triangles),
            triangles,
            cutout,
        }
    }

    /// Sizes of the grid.
    #[must_use]
    pub fn stats(&self) -> GridStats {
        let cells = &self.cells;
        let counts = cells
            .lattice
            .map_or([0; 3], |lattice| lattice.counts.into());
        let cut = cells.top.iter().filter(|top| top.counts != [0; 3]).count();
        GridStats {
            top: counts,
            cells: cells.starts.len() - cut,
            references: cells.ids.len(),
            bytes: size_of_val(&cells.top[..])
                + size_of_val(&cells.starts[..])
                + size_of_val(&cells.ids[..])
                + size_of_val(&self.triangles[..]),
        }
    }

    /// Calls `visit` with each small cell along a ray that has triangles, in order: these
    /// triangles, and the distance at which the ray leaves the cell.
    #[inline(always)]
    fn walk(&self, ray: &Ray, mut visit: impl FnMut(&[u32], f64) -> ControlFlow<()>) {
        let Some(lattice) = self.cells.lattice.as_ref().filter(|_| ray.is_defined()) else {
            return;
        };
        let grid_ray = GridRay::new(ray);
        let end = lattice.corner(lattice.counts);
        let [from, to] = [ray.t_min, ray.t_max].map(f64::from);
        let wanted = [from - SLACK * from.abs(), beyond(to)];
        let range = grid_ray.clip(lattice.min, end, wanted);
        if range[0] > range[1] || range[1].is_nan() {
            return;
        }
        let _ = lattice.walk(&grid_ray, range, |place, range| {
            let top = &self.cells.top[lattice.index(place)];
            match top.counts {
                [0, 0, 0] => ControlFlow::Continue(()),
                [1, 1, 1] => visit(self.cells.of(top.first as usize), range[1]),
                counts => {
                    let counts = counts.map(u32::from).into();
                    let sub = lattice.cut(place, counts);
                    sub.walk(&grid_ray, range, |place, [_, leave]| {
                        match self.cells.of(top.first as usize + sub.index(place)) {
                            [] => ControlFlow::Continue(()),
                            ids => visit(ids, leave),
                        }
                    })
                }
            }
        });
    }

    /// A hit on one triangle inside the ray's interval, where the triangle is solid.
    #[inline(always)]
    fn intersect(&self, id: u32, ray: &Ray) -> Option<Hit> {
        let hit = self.triangles[id as usize].intersect(ray)?;
        let is_solid = self
            .cutout
            .as_ref()
            .is_none_or(|cutout| !cutout.has_holes(id) || cutout.is_solid(id, hit.u, hit.v));
        is_solid.then_some(Hit {
            t: hit.t,
            u: hit.u,
            v: hit.v,
            triangle: id,
        })
    }
}

impl Cells {
    #[inline(always)]
    fn of(&self, cell: usize) -> &[u32] {
        &self.ids[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

/// The triangles that a ray has met lately: those in many cells are not tested in each.
struct Mailbox([u32; Self::SIZE]);

impl Mailbox {
    const SIZE: usize = 32;

    fn new() -> Self {
        Self([u32::MAX; Self::SIZE])
    }

    /// Whether a triangle comes for the first time, as far as is remembered.
    #[inline(always)]
    fn is_new(&mut self, id: u32) -> bool {
        let slot = &mut self.0[id as usize % Self::SIZE];
        let is_new = *slot != id;
        *slot = id;
        is_new
    }
}

impl Accel for TwoLevelGrid {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let mut ahead = *ray;
        let mut met = Mailbox::new();
        self.walk(ray, |ids, leave| {
            for &id in ids {
                if !met.is_new(id) {
                    continue;
                }
                if let Some(hit) = self.intersect(id, &ahead)
                    && best.is_none_or(|best| hit.t < best.t || id < best.triangle)
                {
                    best = Some(hit);
                    // One step past it, so that a hit at the same distance is seen.
                    ahead.t_max = hit.t.next_up();
                }
            }
            match best {
                Some(best) if beyond(best.t.into()) < leave => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        });
        best
    }

    fn blocker(&self, ray: &Ray) -> Option<u32> {
        let mut found = None;
        let mut met = Mailbox::new();
        self.walk(ray, |ids, _| {
            found = ids
                .iter()
                .copied()
                .find(|&id| met.is_new(id) && self.intersect(id, ray).is_some());
            match found {
                Some(_) => ControlFlow::Break(()),
                None => ControlFlow::Continue(()),
            }
        });
        found
    }

    fn closest_packet(&self, packet: &RayPacket) -> [Option<Hit>; PACKET] {
        std::array::from_fn(|lane| self.closest(&packet.ray(lane)))
    }

    fn blocker_packet(&self, packet: &RayPacket) -> [Option<u32>; PACKET] {
        std::array::from_fn(|lane| self.blocker(&packet.ray(lane)))
    }

    fn blocked_packet(&self, packet: &RayPacket) -> u32 {
        (0..PACKET)
            .filter(|&lane| self.is_blocked(&packet.ray(lane)))
            .fold(0, |blocked, lane| blocked | 1 << lane)
    }

    fn bytes(&self) -> usize {
        self.stats().bytes
    }
}

#[cfg(test)]
mod tests;
