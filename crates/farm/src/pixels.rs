//! A tile's pixels as bytes and back.

use glam::Vec3;
use half::f16;
use lie_protocol::{Compression, PixelFormat};

/// Why bytes are not a tile's pixels.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the pixels cannot be unpacked: {0}")]
pub struct PixelError(String);

/// Packs radiance. `F32` is exact; `F16` clamps each channel to what a half can hold.
#[must_use]
pub fn pack(radiance: &[Vec3], format: PixelFormat, compression: Compression) -> Vec<u8> {
    let channels = radiance.iter().flat_map(|pixel| pixel.to_array());
    let plain: Vec<u8> = match format {
        PixelFormat::F32 => channels.flat_map(f32::to_le_bytes).collect(),
        PixelFormat::F16 => channels
            .flat_map(|channel| f16::from_f32(channel.min(f16::MAX.to_f32())).to_le_bytes())
            .collect(),
    };
    match compression {
        Compression::None => plain,
        Compression::Lz4 => lz4_flex::block::compress(&plain),
    }
}

/// Unpacks exactly `pixels` pixels; nothing longer is ever allocated.
///
/// # Errors
/// [`PixelError`] if there are more or fewer, or the packing is damaged.
pub fn unpack(
    bytes: &[u8],
    pixels: usize,
    format: PixelFormat,
    compression: Compression,
) -> Result<Vec<[f32; 3]>, PixelError> {
    let channel_bytes = match format {
        PixelFormat::F16 => 2,
        PixelFormat::F32 => 4,
    };
    let expected = pixels * 3 * channel_bytes;
    let unpacked;
    let plain = match compression {
        Compression::None => bytes,
        Compression::Lz4 => {
            let mut buffer = vec![0; expected];
            let length = lz4_flex::block::decompress_into(bytes, &mut buffer)
                .map_err(|error| PixelError(error.to_string()))?;
            buffer.truncate(length);
            unpacked = buffer;
            &unpacked
        }
    };
    if plain.len() != expected {
        return Err(PixelError(format!(
            "{} bytes instead of {expected}",
            plain.len()
        )));
    }
    let channel = |bytes: &[u8]| match *bytes {
        [a, b] => f16::from_le_bytes([a, b]).to_f32(),
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
        _ => 0.0,
    };
    Ok(plain
        .chunks_exact(3 * channel_bytes)
        .map(|pixel| {
            std::array::from_fn(|at| channel(&pixel[at * channel_bytes..][..channel_bytes]))
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn singles_are_exact_and_halves_are_clamped() {
        let radiance = [Vec3::new(0.1, 1.0e9, 3.0e-9), Vec3::new(0.0, 1.5, f32::MAX)];
        for compression in [Compression::None, Compression::Lz4] {
            let bytes = pack(&radiance, PixelFormat::F32, compression);
            let back = unpack(&bytes, 2, PixelFormat::F32, compression).unwrap();
            assert_eq!(back, radiance.map(|pixel| pixel.to_array()));
            let bytes = pack(&radiance, PixelFormat::F16, compression);
            let back = unpack(&bytes, 2, PixelFormat::F16, compression).unwrap();
            assert_eq!(back[1], [0.0, 1.5, 65504.0]);
            assert_eq!(back[0][1], 65504.0);
            assert!((back[0][0] - 0.1).abs() < 1.0e-4);
        }
    }

    #[test]
    fn too_few_too_many_and_damaged_bytes_are_refused() {
        for format in [PixelFormat::F16, PixelFormat::F32] {
            for compression in [Compression::None, Compression::Lz4] {
                let bytes = pack(&[Vec3::ONE; 5], format, compression);
                assert!(unpack(&bytes, 4, format, compression).is_err());
                assert!(unpack(&bytes, 6, format, compression).is_err());
                assert!(unpack(&bytes[1..], 5, format, compression).is_err());
            }
        }
    }
}
