//! Image files to textures.

use std::io::Cursor;

use image::{ImageReader, Limits};

use crate::Texture;

/// Most bytes that one image may decode to.
const MAX_DECODED_BYTES: u64 = 1 << 30;

/// Decodes a PNG or JPEG. Its sides are checked before its texels are decoded.
pub(super) fn decode(bytes: &[u8], srgb: bool) -> Result<Texture, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| error.to_string())?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(Texture::MAX_SIDE);
    limits.max_image_height = Some(Texture::MAX_SIDE);
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(limits);
    let picture = reader
        .decode()
        .map_err(|error| error.to_string())?
        .into_rgba8();
    let (width, height) = picture.dimensions();
    let texels = picture.pixels().map(|pixel| pixel.0).collect();
    Texture::new(width, height, srgb, texels).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_images_are_refused() {
        for bytes in [
            &b""[..],
            b"not an image",
            b"\x89PNG\r\n\x1a\n",
            b"\xff\xd8\xff\xe0",
        ] {
            assert!(decode(bytes, true).is_err());
        }
    }
}
