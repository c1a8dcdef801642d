use glam::{Vec2, Vec4};

/// An image that repeats in both directions, 8 bits per channel, red, green, blue, alpha.
///
/// Invariant: sides lie in `1..=MAX_SIDE`, and there are `width × height` texels, row 0 first.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    width: u32,
    height: u32,
    srgb: bool,
    texels: Vec<[u8; 4]>,
    linear_of: Box<[f32; 256]>,
}

/// Why data could not become a [`Texture`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// A side is zero or too long, or the number of texels is not their product.
    #[error("a texture of {width} × {height} with {texels} texels is not possible (sides 1 to {max})", max = Texture::MAX_SIDE)]
    Size {
        /// Texels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Texels given.
        texels: usize,
    },
}

impl Texture {
    /// Longest side in texels.
    pub const MAX_SIDE: u32 = 16_384;

    /// Checks the size. `srgb` says that red, green and blue are encoded by the sRGB curve.
    ///
    /// # Errors
    /// [`TextureError::Size`].
    pub fn new(
        width: u32,
        height: u32,
        srgb: bool,
        texels: Vec<[u8; 4]>,
    ) -> Result<Self, TextureError> {
        let sides = 1..=Self::MAX_SIDE;
        if !sides.contains(&width)
            || !sides.contains(&height)
            || texels.len() as u64 != u64::from(width) * u64::from(height)
        {
            return Err(TextureError::Size {
                width,
                height,
                texels: texels.len(),
            });
        }
        let linear_of = std::array::from_fn(|byte| {
            let encoded = byte as f32 / 255.0;
            if !srgb {
                encoded
            } else if encoded <= 0.04045 {
                encoded / 12.92
            } else {
                ((encoded + 0.055) / 1.055).powf(2.4)
            }
        });
        Ok(Self {
            width,
            height,
            srgb,
            texels,
            linear_of: Box::new(linear_of),
        })
    }

    /// Texels per row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Whether the colours are encoded by the sRGB curve.
    #[must_use]
    pub fn is_srgb(&self) -> bool {
        self.srgb
    }

    /// The texels, row by row.
    #[must_use]
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }

    /// The bilinearly filtered texel at texture coordinates, decoded to linear; alpha is
    /// linear as it is. Coordinates repeat; undefined ones read the first texel.
    #[must_use]
    #[inline(always)]
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        let size = Vec2::new(self.width as f32, self.height as f32);
        let wrapped = uv - uv.floor();
        let position = wrapped * size - Vec2::splat(0.5);
        let corner = position.floor();
        let weight = position - corner;
        let [left, right] = neighbours(corner.x, self.width);
        let [above, below] = neighbours(corner.y, self.height);
        let top = self.texel(left, above);
        let top = top.lerp(self.texel(right, above), weight.x);
        let bottom = self.texel(left, below);
        let bottom = bottom.lerp(self.texel(right, below), weight.x);
        let filtered = top.lerp(bottom, weight.y);
        if filtered.is_finite() {
            filtered
        } else {
            self.texel(0, 0)
        }
    }

    /// The mean over all texels, decoded to linear.
    #[must_use]
    pub fn mean(&self) -> Vec4 {
        let mut sums = [0.0f64; 4];
        for [r, g, b, a] in &self.texels {
            for (sum, byte) in sums.iter_mut().zip([r, g, b]) {
                *sum += f64::from(self.linear_of[usize::from(*byte)]);
            }
            sums[3] += f64::from(*a) / 255.0;
        }
        Vec4::from_array(sums.map(|sum| (sum / self.texels.len() as f64) as f32))
    }

    #[inline]
    fn texel(&self, x: usize, y: usize) -> Vec4 {
        let [r, g, b, a] = self.texels[y * self.width as usize + x];
        let linear = |byte: u8| self.linear_of[usize::from(byte)];
        Vec4::new(linear(r), linear(g), linear(b), f32::from(a) / 255.0)
    }
}

/// A texel's number, from −1 to `count` − 1, and the next one's, both wrapped; numbers
/// beyond, and undefined ones, become the first.
#[inline]
fn neighbours(number: f32, count: u32) -> [usize; 2] {
    let count = count as usize;
    let first = if number < 0.0 {
        count - 1
    } else {
        number as usize
    };
    let first = if first < count { first } else { 0 };
    let second = first + 1;
    [first, if second < count { second } else { 0 }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_are_met_at_their_centres_and_repeat() {
        let texels = vec![
            [255, 0, 0, 255],
            [0, 255, 0, 255],
            [0, 0, 255, 0],
            [255, 255, 255, 255],
        ];
        let texture = Texture::new(2, 2, false, texels).unwrap();
        assert_eq!(
            texture.sample(Vec2::new(0.25, 0.25)),
            Vec4::new(1.0, 0.0, 0.0, 1.0)
        );
        assert_eq!(
            texture.sample(Vec2::new(-0.75, 3.75)),
            Vec4::new(0.0, 0.0, 1.0, 0.0)
        );
        assert_eq!(
            texture.sample(Vec2::new(0.5, 0.25)),
            Vec4::new(0.5, 0.5, 0.0, 1.0)
        );
        assert!(texture.sample(Vec2::splat(f32::NAN)).is_finite());
        assert!(texture.sample(Vec2::splat(1.0e30)).is_finite());
    }

    #[test]
    fn srgb_is_decoded_and_wrong_sizes_are_refused() {
        let texture = Texture::new(1, 1, true, vec![[188, 0, 255, 128]]).unwrap();
        assert!((texture.sample(Vec2::ZERO).x - 0.503).abs() < 1.0e-3);
        assert!((texture.sample(Vec2::ZERO).w - 0.502).abs() < 1.0e-3);
        assert!((texture.mean() - texture.sample(Vec2::ZERO)).length() < 1.0e-6);
        assert!(Texture::new(0, 1, true, vec![]).is_err());
        assert!(Texture::new(2, 1, true, vec![[0; 4]]).is_err());
    }
}
