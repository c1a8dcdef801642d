//! The points of a square, cell by cell.

use glam::Vec3;

use crate::{LieCell, LieLookup, point_group::PointGroup};

/// Points sorted by the cell that each is in. To be used again for the next square: what it has
/// allocated stays.
#[derive(Default)]
pub(crate) struct CellSort<'a> {
    origins: Vec<Vec3>,
    /// Each point, as block and lane.
    places: Vec<(u32, u32)>,
    /// Each point's cell.
    found: Vec<&'a LieCell>,
    /// Points that follow each other in one cell: the cell's address, the first of them, and how
    /// many.
    runs: Vec<(usize, u32, u32)>,
    sorted: Vec<(u32, u32)>,
    /// Each cell, and how many points of `sorted` are in it.
    cells: Vec<(&'a LieCell, u32)>,
}

impl<'a> CellSort<'a> {
    /// Finds the cell of each point of some blocks.
    pub(crate) fn find(&mut self, lies: &'a dyn LieLookup, blocks: &[PointGroup]) {
        self.origins.clear();
        self.places.clear();
        self.found.clear();
        for (index, block) in (0..).zip(blocks) {
            for lane in block.lanes() {
                self.origins.push(block.origin(lane));
                self.places.push((index, lane as u32));
            }
        }
        lies.cells(&self.origins, &mut self.found);
        self.sort();
    }

    /// Points are in Z order, so that few of those that follow each other change the cell: whole
    /// runs of them are sorted.
    fn sort(&mut self) {
        self.runs.clear();
        let mut first = 0;
        for run in self.found.chunk_by(|a, b| std::ptr::eq(*a, *b)) {
            let count = run.len() as u32;
            let address = std::ptr::from_ref(run[0]).addr();
            self.runs.push((address, first, count));
            first += count;
        }
        // By what comes first of each cell, points would stay in order; each point's light does
        // not depend on who shares its group.
        self.runs.sort_unstable();
        self.sorted.clear();
        self.cells.clear();
        for runs in self.runs.chunk_by(|a, b| a.0 == b.0) {
            let mut points = 0;
            for &(_, first, count) in runs {
                let run = first as usize..(first + count) as usize;
                self.sorted.extend_from_slice(&self.places[run]);
                points += count;
            }
            self.cells.push((self.found[runs[0].1 as usize], points));
        }
    }

    /// Each cell with its points, as block and lane.
    pub(crate) fn cells(&self) -> impl Iterator<Item = (&'a LieCell, &[(u32, u32)])> {
        let mut rest = &self.sorted[..];
        self.cells.iter().map(move |&(cell, count)| {
            let (points, others) = rest.split_at(count as usize);
            rest = others;
            (cell, points)
        })
    }

    /// The cell of each point, in the order of the blocks.
    pub(crate) fn in_order(&self) -> &[&'a LieCell] {
        &self.found
    }
}
