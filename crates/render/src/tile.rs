use glam::{UVec2, Vec3};

/// A rectangle of a frame, in film pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tile {
    /// Upper left pixel.
    pub origin: UVec2,
    /// Columns and rows.
    pub size: UVec2,
}

impl Tile {
    /// Whether all of it lies in a film of that size.
    #[must_use]
    pub fn is_inside(&self, film: UVec2) -> bool {
        let inside = |at: usize| {
            let end = self.origin[at].checked_add(self.size[at]);
            end.is_some_and(|end| end <= film[at])
        };
        inside(0) && inside(1)
    }
}

/// Sides that tiles may have, in pixels, from the largest down: a large one has more neighbours to
/// share its work with, and small ones are shared out more evenly.
pub const TILE_SIDES: [u32; 3] = [64, 32, 16];

/// The tiles of a frame, row by row, as large as they may be.
#[must_use]
pub fn tiles(size: UVec2) -> Vec<Tile> {
    tiles_of(size, TILE_SIDES[0])
}

/// The tiles of a frame, row by row, with sides of so many pixels, at least 1; those at the right
/// and lower border may be smaller.
#[must_use]
pub fn tiles_of(size: UVec2, side: u32) -> Vec<Tile> {
    let side = side.max(1);
    let starts = |end: u32| (0..end).step_by(side as usize);
    starts(size.y)
        .flat_map(|y| starts(size.x).map(move |x| UVec2::new(x, y)))
        .map(|origin| Tile {
            origin,
            size: (size - origin).min(UVec2::splat(side)),
        })
        .collect()
}

/// A finished rectangle of the film, as linear RGB radiance.
///
/// Shape: `size.y × size.x`, row-major, row 0 on top; element `y * size.x + x` is film
/// pixel `origin + (x, y)`. Units: W·sr⁻¹·m⁻² per channel (Rec. 709 primaries), before
/// exposure and tone mapping, so a viewer can re-expose without re-rendering.
///
/// Invariants, established by [`Self::new`] and relied on when compositing:
/// * each side lies in `1..=MAX_SIDE`, and `radiance.len() == size.x * size.y`;
/// * every channel is finite and non-negative.
#[derive(Clone, Debug, PartialEq)]
pub struct RadianceTile {
    tile: Tile,
    radiance: Vec<Vec3>,
}

/// Why data could not become a [`RadianceTile`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TileError {
    /// A side is zero or too long, or the tile leaves the film.
    #[error("tile of {0} pixels has a side outside 1..={max}", max = RadianceTile::MAX_SIDE)]
    Size(UVec2),
    /// The number of pixels is not the area.
    #[error("a tile of {size} pixels came with {count} values")]
    Count {
        /// The tile's size.
        size: UVec2,
        /// Values given.
        count: usize,
    },
    /// A value is negative, infinite or undefined.
    #[error("the radiance of pixel {0} of a tile is not a finite, non-negative number")]
    Value(usize),
}

impl RadianceTile {
    /// Longest side in pixels; bounds what a hostile peer can make us hold.
    pub const MAX_SIDE: u32 = 256;

    /// Checks `radiance` once, here, so that no reader has to check again.
    ///
    /// # Errors
    /// [`TileError`] if an invariant above fails; nothing is clamped silently.
    pub fn new(tile: Tile, radiance: Vec<Vec3>) -> Result<Self, TileError> {
        let sides = 1..=Self::MAX_SIDE;
        if !sides.contains(&tile.size.x) || !sides.contains(&tile.size.y) {
            return Err(TileError::Size(tile.size));
        }
        if radiance.len() != (tile.size.x * tile.size.y) as usize {
            return Err(TileError::Count {
                size: tile.size,
                count: radiance.len(),
            });
        }
        match first_impossible(&radiance) {
            Some(pixel) => Err(TileError::Value(pixel)),
            None => Ok(Self { tile, radiance }),
        }
    }

    /// Where it lies.
    #[must_use]
    pub fn tile(&self) -> Tile {
        self.tile
    }

    /// Its pixels, row by row.
    #[must_use]
    pub fn radiance(&self) -> &[Vec3] {
        &self.radiance
    }
}

/// The first pixel that is not finite or is negative in a channel.
pub(crate) fn first_impossible(radiance: &[Vec3]) -> Option<usize> {
    // Nearly always there is none, and without a way out early lanes can look.
    let channel = |channel: f32| (0.0..=f32::MAX).contains(&channel);
    let possible = |value: &Vec3| channel(value.x) & channel(value.y) & channel(value.z);
    if radiance
        .iter()
        .fold(true, |all, value| all & possible(value))
    {
        return None;
    }
    radiance.iter().position(|value| !possible(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        for size in [UVec2::new(1, 1), UVec2::new(33, 64), UVec2::new(100, 7)] {
            let mut seen = vec![0; (size.x * size.y) as usize];
            for tile in TILE_SIDES.into_iter().flat_map(|side| tiles_of(size, side)) {
                for y in tile.origin.y..tile.origin.y + tile.size.y {
                    for x in tile.origin.x..tile.origin.x + tile.size.x {
                        seen[(y * size.x + x) as usize] += 1;
                    }
                }
            }
            let sides = TILE_SIDES.len();
            assert!(seen.iter().all(|&count| count == sides), "{size}");
        }
    }

    #[test]
    fn impossible_tiles_are_refused() {
        let tile = |x, y| Tile {
            origin: UVec2::ZERO,
            size: UVec2::new(x, y),
        };
        assert!(RadianceTile::new(tile(2, 1), vec![Vec3::ONE; 2]).is_ok());
        assert!(matches!(
            RadianceTile::new(tile(0, 1), vec![]),
            Err(TileError::Size(_))
        ));
        assert!(matches!(
            RadianceTile::new(tile(257, 1), vec![]),
            Err(TileError::Size(_))
        ));
        assert!(matches!(
            RadianceTile::new(tile(2, 1), vec![Vec3::ONE]),
            Err(TileError::Count { .. })
        ));
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let values = vec![Vec3::ONE, Vec3::new(0.0, bad, 0.0)];
            assert_eq!(
                RadianceTile::new(tile(2, 1), values),
                Err(TileError::Value(1))
            );
        }
    }
}
