//! From triangles to cells.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec3, UVec3};
use lie_geom::Triangle;
use rayon::prelude::*;

use super::{
    Cells, TopCell,
    lattice::{Lattice, resolution},
    overlap::Shape,
};

/// Top cells for each triangle, and small cells for each triangle of a top cell (Kalojanov,
/// Billeter and Slusallek 2011 find these two densities good for many scenes).
const TOP_DENSITY: f64 = 0.125;
const SUB_DENSITY: f64 = 2.4;

/// A top cell of at most so many triangles is not cut again.
const FEW: usize = 4;

/// A triangle may lie in many cells; on average, in no more than this many top cells, and
/// each of those is cut into no more than this many small cells with a part of it. Else cells
/// become larger.
const MOST_COPIES: usize = 4;

/// Most cells along an axis.
const MOST_COUNT: u32 = 1024;

/// Most cells on top.
const MOST_TOP: f64 = (1 << 22) as f64;

/// By how much of the scene's size a cell's box grows as triangles are put into it. Far more
/// than a walk or the triangle test rounds: a ray along a border misses nothing.
const PAD: f64 = 1.0e-6;

/// The cells over some triangles, `solid` of which can be hit.
pub(super) fn build(triangles: &[Triangle]) -> Cells {
    let solid: Vec<u32> = (0..triangles.len() as u32)
        .filter(|&id| triangles[id as usize].normal.is_normalized())
        .collect();
    let Some([low, high]) = bounds(triangles, &solid) else {
        return Cells::default();
    };
    let magnitude = low.abs().max(high.abs()).max_element();
    let pad = PAD * magnitude.max(f64::from(f32::MIN_POSITIVE));
    let (min, size) = (low - 2.0 * pad, high - low + 4.0 * pad);
    let budget = (TOP_DENSITY * solid.len() as f64).min(MOST_TOP);
    let (lattice, top) = cut(triangles, &solid, [min, size], budget, pad);

    // Each top cell by itself, and then one after the other into common arrays.
    let subs: Vec<Sub> = (0..lattice.len())
        .into_par_iter()
        .map(|index| {
            let ids = top.of(index);
            let corner = lattice.corner(place_of(&lattice, index));
            let budget = if ids.len() > FEW {
                SUB_DENSITY * ids.len() as f64
            } else {
                1.0
            };
            let (sub, buckets) = cut(triangles, ids, [corner, lattice.cell], budget, pad);
            Sub {
                counts: sub.counts,
                buckets,
            }
        })
        .collect();
    let mut cells = Cells {
        lattice: Some(lattice),
        ..Cells::default()
    };
    for sub in subs {
        cells.top.push(TopCell {
            first: cells.starts.len() as u32,
            counts: if sub.buckets.ids.is_empty() {
                [0; 3]
            } else {
                sub.counts.to_array().map(|count| count as u16)
            },
        });
        if !sub.buckets.ids.is_empty() {
            let base = cells.ids.len() as u32;
            cells
                .starts
                .extend(sub.buckets.starts.iter().map(|start| base + start));
            cells.ids.extend(sub.buckets.ids);
        }
    }
    let most = u32::MAX as usize;
    assert!(
        cells.ids.len() <= most && cells.starts.len() <= most,
        "too many cells"
    );
    cells.starts.shrink_to_fit();
    cells.ids.shrink_to_fit();
    cells
}

struct Sub {
    counts: UVec3,
    buckets: Buckets,
}

/// Ids sorted by cell: those of cell `i` are `ids[starts[i]..starts[i + 1]]`, in order.
struct Buckets {
    starts: Vec<u32>,
    ids: Vec<u32>,
}

impl Buckets {
    fn of(&self, cell: usize) -> &[u32] {
        &self.ids[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

fn bounds(triangles: &[Triangle], solid: &[u32]) -> Option<[DVec3; 2]> {
    solid
        .par_iter()
        .map(|&id| Shape::new(&triangles[id as usize]).bounds())
        .reduce_with(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

fn place_of(lattice: &Lattice, index: usize) -> UVec3 {
    let [x, y] = [lattice.counts.x as usize, lattice.counts.y as usize];
    UVec3::new(
        (index % x) as u32,
        (index / x % y) as u32,
        (index / (x * y)) as u32,
    )
}

/// Cuts a box into about `budget` cells and puts triangles into them. If that takes too many
/// copies, with half the budget; a single cell takes none.
fn cut(
    triangles: &[Triangle],
    ids: &[u32],
    [min, size]: [DVec3; 2],
    mut budget: f64,
    pad: f64,
) -> (Lattice, Buckets) {
    loop {
        let lattice = Lattice::new(min, size, resolution(size, budget, MOST_COUNT));
        if lattice.len() == 1 {
            let buckets = Buckets {
                starts: vec![0, ids.len() as u32],
                ids: ids.to_vec(),
            };
            return (lattice, buckets);
        }
        let most = MOST_COPIES * ids.len() + 8;
        if let Some(pairs) = pairs(triangles, ids, &lattice, pad, most) {
            return (lattice, sort(&pairs, lattice.len()));
        }
        budget *= 0.5;
    }
}

/// Which triangle is in which cell, or nothing if there are more than `most` such pairs.
fn pairs(
    triangles: &[Triangle],
    ids: &[u32],
    lattice: &Lattice,
    pad: f64,
    most: usize,
) -> Option<Vec<(u32, u32)>> {
    /// Triangles to a task: top cells hold fewer and are tasks themselves.
    const CHUNK: usize = 4096;
    let total = AtomicUsize::new(0);
    let chunks: Vec<Vec<(u32, u32)>> = ids
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut pairs = vec![];
            for &id in chunk {
                let before = pairs.len();
                let left = most.saturating_sub(total.load(Ordering::Relaxed));
                add_cells_of(&triangles[id as usize], lattice, pad, left, |cell| {
                    pairs.push((cell, id));
                });
                total.fetch_add(pairs.len() - before, Ordering::Relaxed);
                if total.load(Ordering::Relaxed) > most {
                    break;
                }
            }
            pairs
        })
        .collect();
    (total.into_inner() <= most).then(|| chunks.concat())
}

/// Calls `add` with the cells that a triangle meets; gives up after more than `most`.
fn add_cells_of(
    triangle: &Triangle,
    lattice: &Lattice,
    pad: f64,
    most: usize,
    mut add: impl FnMut(u32),
) {
    let shape = Shape::new(triangle);
    let [low, high] = shape.bounds();
    let (first, last) = (lattice.place(low - pad), lattice.place(high + pad));
    let half = 0.5 * lattice.cell + pad;
    let mut count = 0;
    for z in first.z..=last.z {
        for y in first.y..=last.y {
            for x in first.x..=last.x {
                let place = UVec3::new(x, y, z);
                let center = lattice.corner(place) + 0.5 * lattice.cell;
                if shape.meets(center, half) {
                    add(lattice.index(place) as u32);
                    count += 1;
                    if count > most {
                        return;
                    }
                }
            }
        }
    }
}

/// Sorts by cell, by counting; the order within a cell stays.
fn sort(pairs: &[(u32, u32)], cells: usize) -> Buckets {
    let mut starts = vec![0u32; cells + 1];
    for &(cell, _) in pairs {
        starts[cell as usize + 1] += 1;
    }
    for cell in 0..cells {
        starts[cell + 1] += starts[cell];
    }
    let mut next = starts.clone();
    let mut ids = vec![0; pairs.len()];
    for &(cell, id) in pairs {
        ids[next[cell as usize] as usize] = id;
        next[cell as usize] += 1;
    }
    Buckets { starts, ids }
}
