//! Into which tiles a frame is cut, and in which order they are handed out. The picture is the same
//! whatever is decided here.

use glam::UVec2;
use lie_render::{TILE_SIDES, Tile, tiles_of};

/// Tiles that there are to be for each thread, if possible: when the last one is handed out the
/// others are nearly done, so that a frame's end, where threads have nothing to do, is short.
const TILES_PER_THREAD: usize = 8;

/// Side of the squares whose costs are remembered, in pixels.
const BLOCK: u32 = TILE_SIDES[TILE_SIDES.len() - 1];

/// The tiles of a frame that so many threads are there for: the largest of which there are enough.
pub(super) fn cut(size: UVec2, threads: usize) -> Vec<Tile> {
    let wanted = TILES_PER_THREAD * threads;
    let count = |side| (size.x.div_ceil(side) * size.y.div_ceil(side)) as usize;
    let enough = TILE_SIDES.into_iter().find(|&side| count(side) >= wanted);
    tiles_of(size, enough.unwrap_or(BLOCK))
}

/// What the parts of the last frame cost, wherever its camera was: views that follow each other
/// are alike.
#[derive(Debug, Default)]
pub(super) struct Costs {
    size: UVec2,
    /// Nanoseconds for each pixel of a square, row by row; none if nothing is known.
    blocks: Vec<f32>,
}

impl Costs {
    /// A tile of a frame of this size took so long to render.
    pub(super) fn note(&mut self, size: UVec2, tile: Tile, render_ns: u64) {
        if self.size != size || self.blocks.is_empty() {
            let count = size.x.div_ceil(BLOCK) * size.y.div_ceil(BLOCK);
            (self.size, self.blocks) = (size, vec![0.0; count as usize]);
        }
        let of_pixel = render_ns as f32 / (tile.size.x * tile.size.y) as f32;
        for block in blocks(size, tile) {
            self.blocks[block] = of_pixel;
        }
    }

    /// The numbers of some tiles in the order in which they are handed out: the costliest first, so
    /// that what is left at the end is soon done; and the middle first as long as nothing is known.
    pub(super) fn order(&self, size: UVec2, tiles: &[Tile]) -> Vec<u32> {
        if self.size != size || self.blocks.is_empty() {
            return centre_out(size, tiles);
        }
        let expected = |tile: &Tile| {
            let costs = blocks(size, *tile).map(|block| self.blocks[block]);
            let (sum, count) = costs.fold((0.0, 0), |(sum, n), cost| (sum + cost, n + 1));
            sum / count.max(1) as f32 * (tile.size.x * tile.size.y) as f32
        };
        let expected: Vec<f32> = tiles.iter().map(expected).collect();
        let mut order: Vec<u32> = (0..tiles.len() as u32).collect();
        order.sort_by(|&a, &b| expected[b as usize].total_cmp(&expected[a as usize]));
        order
    }
}

/// The squares that a tile has pixels of.
fn blocks(size: UVec2, tile: Tile) -> impl Iterator<Item = usize> {
    let (first, last) = (tile.origin / BLOCK, (tile.origin + tile.size - 1) / BLOCK);
    let columns = size.x.div_ceil(BLOCK);
    (first.y..=last.y)
        .flat_map(move |y| (first.x..=last.x).map(move |x| (y * columns + x) as usize))
}

/// The numbers of some tiles from the frame's centre outwards.
fn centre_out(size: UVec2, tiles: &[Tile]) -> Vec<u32> {
    let distance = |&tile: &u32| {
        let tile = tiles[tile as usize];
        let centre = 2 * (tile.origin + tile.size / 2);
        (centre.as_i64vec2() - size.as_i64vec2()).length_squared()
    };
    let mut order: Vec<u32> = (0..tiles.len() as u32).collect();
    order.sort_by_key(distance);
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_threads_get_small_tiles_and_few_get_large_ones() {
        let side = |size, threads| cut(UVec2::splat(size), threads)[0].size.x;
        let cases = [(512, 0, 64), (512, 2, 64), (512, 8, 64), (512, 9, 32)];
        for (size, threads, expected) in [(512, 24, 32), (1024, 24, 64), (1024, 256, 16)]
            .into_iter()
            .chain(cases)
            .chain([(64, 1000, 16)])
        {
            assert_eq!(side(size, threads), expected, "{size} pixels, {threads}");
        }
    }

    #[test]
    fn the_middle_comes_first_as_long_as_nothing_is_known() {
        let size = UVec2::splat(96);
        let tiles = tiles_of(size, 32);
        let costs = Costs::default();
        assert_eq!(costs.order(size, &tiles), [4, 1, 3, 5, 7, 0, 2, 6, 8]);
        assert!(costs.order(size, &[]).is_empty());
    }

    #[test]
    fn what_was_costly_comes_first_however_it_is_cut() {
        let size = UVec2::new(130, 70);
        let mut costs = Costs::default();
        let tiles = tiles_of(size, 64);
        assert_eq!(tiles.len(), 6);
        for (tile, cost) in tiles.iter().zip([10, 60, 50, 20, 30, 40]) {
            costs.note(size, *tile, cost);
        }
        assert_eq!(costs.order(size, &tiles), [1, 2, 5, 4, 3, 0]);
        // Of a pixel those at the border cost far more, and of tiles the small ones of theirs.
        let small = tiles_of(size, 16);
        let order = costs.order(size, &small);
        let all: std::collections::BTreeSet<_> = order.iter().collect();
        assert_eq!(all.len(), small.len());
        let first = small[order[0] as usize];
        assert_eq!(first.origin, UVec2::new(128, 64));
        // A frame of another size is another picture.
        let other = UVec2::new(131, 70);
        let tiles = tiles_of(other, 64);
        assert_eq!(costs.order(other, &tiles), centre_out(other, &tiles));
    }
}
