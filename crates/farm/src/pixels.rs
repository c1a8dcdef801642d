//! A tile's pixels as bytes and back.

use std::borrow::Cow;

use glam::Vec3;
use half::{f16, slice::HalfFloatSliceExt};
use lie_protocol::{Compression, PixelFormat};

/// Channels that are converted at once: few enough to stay in the nearest cache.
const RUN: usize = 768;

/// Why bytes are not a tile's pixels.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the pixels cannot be unpacked: {0}")]
pub struct PixelError(String);

/// Packs radiance. `F32` is exact; `F16` clamps each channel to what a half can hold.
#[must_use]
pub fn pack(radiance: &[Vec3], format: PixelFormat, compression: Compression) -> Vec<u8> {
    let channels: &[f32] = bytemuck::cast_slice(radiance);
    let mut plain = vec![0; channels.len() * channel_bytes(format)];
    match format {
        PixelFormat::F32 => {
            let places = plain.as_chunks_mut().0;
            for (place, channel) in places.iter_mut().zip(channels) {
                *place = channel.to_le_bytes();
            }
        }
        PixelFormat::F16 => pack_halves(channels, plain.as_chunks_mut().0),
    }
    match compression {
        Compression::None => plain,
        Compression::Lz4 => lz4_flex::block::compress(&plain),
    }
}

fn pack_halves(channels: &[f32], places: &mut [[u8; 2]]) {
    let (mut clamped, mut halves) = ([0.0; RUN], [f16::ZERO; RUN]);
    for (channels, places) in channels.chunks(RUN).zip(places.chunks_mut(RUN)) {
        let (clamped, halves) = (&mut clamped[..places.len()], &mut halves[..places.len()]);
        for (clamped, channel) in clamped.iter_mut().zip(channels) {
            *clamped = channel.min(f16::MAX.to_f32_const());
        }
        halves.convert_from_f32_slice(clamped);
        for (place, half) in places.iter_mut().zip(halves) {
            *place = half.to_le_bytes();
        }
    }
}

/// A tile's pixels as they travelled, neither too many nor too few. Of their values nothing
/// is known.
#[derive(Debug)]
pub struct PackedPixels<'a> {
    plain: Cow<'a, [u8]>,
    format: PixelFormat,
}

impl<'a> PackedPixels<'a> {
    /// Checks that there are exactly `pixels` pixels; nothing longer is ever allocated.
    ///
    /// # Errors
    /// [`PixelError`] if there are more or fewer, or the packing is damaged.
    pub fn new(
        bytes: &'a [u8],
        pixels: usize,
        format: PixelFormat,
        compression: Compression,
    ) -> Result<Self, PixelError> {
        let expected = pixels * 3 * channel_bytes(format);
        let plain = match compression {
            Compression::None => Cow::Borrowed(bytes),
            Compression::Lz4 => {
                let mut buffer = vec![0; expected];
                let length = lz4_flex::block::decompress_into(bytes, &mut buffer)
                    .map_err(|error| PixelError(error.to_string()))?;
                buffer.truncate(length);
                Cow::Owned(buffer)
            }
        };
        if plain.len() == expected {
            Ok(Self { plain, format })
        } else {
            let message = format!("{} bytes instead of {expected}", plain.len());
            Err(PixelError(message))
        }
    }

    /// Unpacks as many pixels as `into` has, from that number on.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn unpack(&self, from: usize, into: &mut [Vec3]) {
        let pixel_bytes = 3 * channel_bytes(self.format);
        let bytes = &self.plain[from * pixel_bytes..][..into.len() * pixel_bytes];
        let channels: &mut [f32] = bytemuck::cast_slice_mut(into);
        match self.format {
            PixelFormat::F32 => {
                let singles = bytes.as_chunks().0;
                for (channel, single) in channels.iter_mut().zip(singles) {
                    *channel = f32::from_le_bytes(*single);
                }
            }
            PixelFormat::F16 => unpack_halves(bytes.as_chunks().0, channels),
        }
    }
}

fn unpack_halves(bytes: &[[u8; 2]], channels: &mut [f32]) {
    let mut halves = [f16::ZERO; RUN];
    for (bytes, channels) in bytes.chunks(RUN).zip(channels.chunks_mut(RUN)) {
        let halves = &mut halves[..bytes.len()];
        for (half, bytes) in halves.iter_mut().zip(bytes) {
            *half = f16::from_le_bytes(*bytes);
        }
        halves.convert_to_f32_slice(channels);
    }
}

fn channel_bytes(format: PixelFormat) -> usize {
    match format {
        PixelFormat::F16 => 2,
        PixelFormat::F32 => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unpacked(
        bytes: &[u8],
        pixels: usize,
        format: PixelFormat,
        compression: Compression,
    ) -> Result<Vec<Vec3>, PixelError> {
        let packed = PackedPixels::new(bytes, pixels, format, compression)?;
        let mut radiance = vec![Vec3::ZERO; pixels];
        // Row by row: what a film does.
        for (index, row) in radiance.chunks_mut(2).enumerate() {
            packed.unpack(2 * index, row);
        }
        Ok(radiance)
    }

    #[test]
    fn singles_are_exact_and_halves_are_clamped() {
        let radiance = [Vec3::new(0.1, 1.0e9, 3.0e-9), Vec3::new(0.0, 1.5, f32::MAX)];
        for compression in [Compression::None, Compression::Lz4] {
            let bytes = pack(&radiance, PixelFormat::F32, compression);
            let back = unpacked(&bytes, 2, PixelFormat::F32, compression).unwrap();
            assert_eq!(back, radiance);
            let bytes = pack(&radiance, PixelFormat::F16, compression);
            let back = unpacked(&bytes, 2, PixelFormat::F16, compression).unwrap();
            assert_eq!(back[1].to_array(), [0.0, 1.5, 65504.0]);
            assert_eq!(back[0].y, 65504.0);
            assert!((back[0].x - 0.1).abs() < 1.0e-4);
        }
    }

    /// A film that is rounded to halves is what comes out of the wire, bit for bit.
    #[test]
    fn many_at_once_are_converted_as_one_by_one() {
        let channel = |at: usize| (0.37 * at as f32).exp2() * 1.0e-9;
        let radiance: Vec<Vec3> = (0..999)
            .map(|pixel| Vec3::from_array([0, 1, 2].map(|at| channel(3 * (pixel % 64) + at))))
            .collect();
        let bytes = pack(&radiance, PixelFormat::F16, Compression::None);
        let rounded = |channel: f32| f16::from_f32(channel.min(65504.0));
        let channels = radiance.iter().flat_map(|pixel| pixel.to_array());
        let halves: Vec<f16> = channels.map(rounded).collect();
        let expected: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        assert!(bytes == expected);
        let back = unpacked(&bytes, 999, PixelFormat::F16, Compression::None).unwrap();
        let back = back.iter().flat_map(|pixel| pixel.to_array());
        assert!(back.eq(halves.iter().map(|half| half.to_f32())));
    }

    #[test]
    fn too_few_too_many_and_damaged_bytes_are_refused() {
        for format in [PixelFormat::F16, PixelFormat::F32] {
            for compression in [Compression::None, Compression::Lz4] {
                let bytes = pack(&[Vec3::ONE; 5], format, compression);
                assert!(PackedPixels::new(&bytes, 4, format, compression).is_err());
                assert!(PackedPixels::new(&bytes, 6, format, compression).is_err());
                assert!(PackedPixels::new(&bytes[1..], 5, format, compression).is_err());
            }
        }
    }
}
