use glam::{UVec2, Vec3};

use crate::{RadianceTile, Tile, TileError, tile::first_impossible};

/// A frame's pixels, as linear RGB radiance in W·sr⁻¹·m⁻², row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    size: UVec2,
    radiance: Vec<Vec3>,
}

/// How many bits of each channel are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 16-bit floating point: an error of at most 1 in 2,048, values up to 65,504.
    Half,
    /// 32-bit floating point: what was computed.
    #[default]
    Float,
}

impl Film {
    /// A black film.
    #[must_use]
    pub fn new(size: UVec2) -> Self {
        Self {
            size,
            radiance: vec![Vec3::ZERO; size.x as usize * size.y as usize],
        }
    }

    /// A film from its pixels, row by row; `None` if their number is not the area.
    #[must_use]
    pub fn from_radiance(size: UVec2, radiance: Vec<Vec3>) -> Option<Self> {
        (radiance.len() == size.x as usize * size.y as usize).then_some(Self { size, radiance })
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The pixels, row by row.
    #[must_use]
    pub fn radiance(&self) -> &[Vec3] {
        &self.radiance
    }

    /// Puts a tile in its place; says whether it lies inside.
    #[must_use]
    pub fn put(&mut self, tile: &RadianceTile) -> bool {
        let (origin, size) = (tile.tile().origin, tile.tile().size);
        if !tile.tile().is_inside(self.size) {
            return false;
        }
        for (row, values) in tile.radiance().chunks(size.x as usize).enumerate() {
            let start = (origin.y as usize + row) * self.size.x as usize + origin.x as usize;
            self.radiance[start..start + values.len()].copy_from_slice(values);
        }
        true
    }

    /// Lets `fill` write a tile's rows where they belong, and checks its pixels as
    /// [`RadianceTile::new`] does. `fill` gets the number of the row's first pixel in the tile.
    ///
    /// # Errors
    /// [`TileError`] if the tile is not inside, and nothing is written then; or if a value is not
    /// possible, after which the tile is of no use until it is filled again.
    pub fn fill(
        &mut self,
        tile: Tile,
        mut fill: impl FnMut(usize, &mut [Vec3]),
    ) -> Result<(), TileError> {
        let (start, width) = (tile.origin.as_usizevec2(), tile.size.x as usize);
        if !tile.is_inside(self.size) {
            return Err(TileError::Size(tile.size));
        }
        for row in 0..tile.size.y as usize {
            let first = (start.y + row) * self.size.x as usize + start.x;
            let pixels = &mut self.radiance[first..first + width];
            fill(row * width, pixels);
            if let Some(pixel) = first_impossible(pixels) {
                return Err(TileError::Value(row * width + pixel));
            }
        }
        Ok(())
    }

    /// The film with fewer bits; larger values than a half can hold become its largest.
    #[must_use]
    pub fn quantized(mut self, precision: Precision) -> Self {
        if precision == Precision::Half {
            for value in &mut self.radiance {
                *value = Vec3::from_array(value.to_array().map(|channel| {
                    half::f16::from_f32(channel.min(half::f16::MAX.to_f32())).to_f32()
                }));
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_land_in_their_place_or_not_at_all() {
        let mut film = Film::new(UVec2::new(4, 3));
        let tile = |x, y| Tile {
            origin: UVec2::new(x, y),
            size: UVec2::new(2, 2),
        };
        let make = |x, y| {
            RadianceTile::new(tile(x, y), vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE]).unwrap()
        };
        assert!(film.put(&make(2, 1)));
        assert_eq!(film.radiance()[6], Vec3::X);
        assert_eq!(film.radiance()[11], Vec3::ONE);
        let before = film.clone();
        for (x, y) in [(3, 0), (0, 2), (u32::MAX, 0)] {
            assert!(!film.put(&make(x, y)));
        }
        assert_eq!(film, before);
    }

    #[test]
    fn tiles_are_filled_in_place_and_checked() {
        let mut film = Film::new(UVec2::new(4, 3));
        let tile = |x, y| Tile {
            origin: UVec2::new(x, y),
            size: UVec2::new(2, 2),
        };
        let pixels = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
        let filled = film.fill(tile(2, 1), |from, row| {
            row.copy_from_slice(&pixels[from..][..2])
        });
        assert_eq!(filled, Ok(()));
        let mut put = Film::new(UVec2::new(4, 3));
        assert!(put.put(&RadianceTile::new(tile(2, 1), pixels.to_vec()).unwrap()));
        assert_eq!(film, put);
        for (x, y) in [(3, 0), (0, 2), (u32::MAX, 0)] {
            let outside = film.fill(tile(x, y), |_, _| panic!("nothing is written"));
            assert_eq!(outside, Err(TileError::Size(UVec2::new(2, 2))));
        }
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let filled = film.fill(tile(0, 0), |from, row| {
                row.fill(Vec3::ONE);
                row[1].z = if from == 2 { bad } else { 0.0 };
            });
            assert_eq!(filled, Err(TileError::Value(3)));
        }
    }

    #[test]
    fn half_precision_keeps_three_digits_and_never_overflows() {
        let film = Film::from_radiance(UVec2::new(1, 1), vec![Vec3::new(0.3, 1.0e9, 0.0)]).unwrap();
        let half = film.quantized(Precision::Half);
        assert!((half.radiance()[0].x / 0.3 - 1.0).abs() < 1.0 / 2048.0);
        assert_eq!(half.radiance()[0].y, 65504.0);
        assert!(Film::from_radiance(UVec2::new(2, 1), vec![]).is_none());
    }
}
