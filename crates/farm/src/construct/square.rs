use glam::UVec2;

/// A part of a view: up to 16 × 16 pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    /// Its first pixel.
    origin: UVec2,
    /// Columns and rows.
    size: UVec2,
}

impl Square {
    /// Pixels along a side.
    const SIDE: u32 = 16;

    /// Those of a picture, row by row.
    pub(super) fn all(size: UVec2) -> impl Iterator<Item = Self> {
        let starts =
            grid(size.map(|side| side.div_ceil(Self::SIDE))).map(|place| place * Self::SIDE);
        starts.map(move |origin| Self {
            origin,
            size: (size - origin).min(UVec2::splat(Self::SIDE)),
        })
    }

    /// Its place among a picture's squares along a curve that keeps neighbours together, its bits
    /// reversed: squares in the order of this are spread over all of the picture, however few.
    pub(super) fn spread(&self) -> u64 {
        let place = self.origin / Self::SIDE;
        (interleaved(place.x) | interleaved(place.y) << 1).reverse_bits()
    }

    pub(super) fn pixels(&self) -> u64 {
        u64::from(self.size.x) * u64::from(self.size.y)
    }

    /// Its pixels, in blocks of up to 4 × 4.
    pub(super) fn blocks(self) -> impl Iterator<Item = impl Iterator<Item = UVec2>> {
        let starts = grid(self.size.map(|side| side.div_ceil(4))).map(|block| 4 * block);
        starts.map(move |start| {
            let size = (self.size - start).min(UVec2::splat(4));
            grid(size).map(move |offset| self.origin + start + offset)
        })
    }
}

fn grid(size: UVec2) -> impl Iterator<Item = UVec2> {
    (0..size.y).flat_map(move |y| (0..size.x).map(move |x| UVec2::new(x, y)))
}

/// A number's bits, with a zero between each two.
fn interleaved(number: u32) -> u64 {
    (0..32).fold(0, |bits, bit| {
        bits | u64::from(number >> bit & 1) << (2 * bit)
    })
}
