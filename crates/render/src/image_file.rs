use std::path::{Path, PathBuf};

use exr::prelude::{Image, ReadChannels, ReadLayers, SpecificChannels, WritableImage};
use glam::{UVec2, Vec3};

use crate::{Film, Precision, ToneMap};

/// Why a picture could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file could not be written or read.
    #[error("{path}: {problem}")]
    File {
        /// Which file.
        path: PathBuf,
        /// What went wrong.
        problem: String,
    },
    /// The ending names no format that is known.
    #[error("{0}: not a picture that can be read here (expected .exr or .png)")]
    Format(PathBuf),
    /// Two pictures cannot be compared.
    #[error("the pictures differ in size: {0} and {1} pixels")]
    Sizes(UVec2, UVec2),
    /// A picture holds something that is no colour.
    #[error("{0}: pixel ({1}, {2}) is not a number")]
    NotFinite(PathBuf, usize, usize),
}

impl ImageError {
    pub(crate) fn file(path: &Path, problem: impl std::fmt::Display) -> Self {
        Self::File {
            path: path.to_owned(),
            problem: problem.to_string(),
        }
    }
}

/// Largest picture that is read, in pixels.
const MAX_PIXELS: usize = 1 << 28;

/// Writes a film as OpenEXR: linear RGB radiance.
///
/// # Errors
/// [`ImageError::File`] if the file cannot be written.
pub fn write_exr(path: &Path, film: &Film, precision: Precision) -> Result<(), ImageError> {
    let (width, height) = (film.size().x as usize, film.size().y as usize);
    let pixel = |at: exr::math::Vec2<usize>| film.radiance()[at.y() * width + at.x()];
    let to_half = |channel: f32| half::f16::from_f32(channel.min(half::f16::MAX.to_f32()));
    // Blocks in order, so that equal pictures are equal files.
    let written = match precision {
        Precision::Float => {
            let channels = SpecificChannels::rgb(|at| <[f32; 3]>::from(pixel(at)).into());
            Image::from_channels((width, height), channels)
                .write()
                .non_parallel()
                .to_file(path)
        }
        Precision::Half => {
            let channels = SpecificChannels::rgb(|at| pixel(at).to_array().map(to_half).into());
            Image::from_channels((width, height), channels)
                .write()
                .non_parallel()
                .to_file(path)
        }
    };
    written.map_err(|problem| ImageError::file(path, problem))
}

/// Writes a film as an 8-bit sRGB PNG.
///
/// # Errors
/// [`ImageError::File`] if the file cannot be written.
pub fn write_png(path: &Path, film: &Film, tone_map: &ToneMap) -> Result<(), ImageError> {
    let bytes = tone_map.bytes(film);
    let kind = image::ExtendedColorType::Rgb8;
    image::save_buffer_with_format(
        path,
        &bytes,
        film.size().x,
        film.size().y,
        kind,
        image::ImageFormat::Png,
    )
    .map_err(|problem| ImageError::file(path, problem))
}

/// Reads an EXR or a PNG as linear RGB; a PNG's bytes are taken as sRGB.
///
/// # Errors
/// [`ImageError`] if there is no such file, or it is no picture, or too large, or holds
/// values that are not finite.
pub fn read_image(path: &Path) -> Result<Film, ImageError> {
    let ending = path
        .extension()
        .and_then(|ending| ending.to_str())
        .map(str::to_ascii_lowercase);
    let film = match ending.as_deref() {
        Some("exr") => read_exr(path)?,
        Some("png") => read_png(path)?,
        _ => return Err(ImageError::Format(path.to_owned())),
    };
    if let Some(index) = film.radiance().iter().position(|value| !value.is_finite()) {
        let width = film.size().x as usize;
        return Err(ImageError::NotFinite(
            path.to_owned(),
            index % width,
            index / width,
        ));
    }
    Ok(film)
}

fn read_exr(path: &Path) -> Result<Film, ImageError> {
    let failed = |problem: exr::error::Error| ImageError::file(path, problem);
    // The header alone first: a size is checked before it is believed.
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(failed)?;
    let size = meta.headers.first().map(|header| header.layer_size);
    if size.is_none_or(|size| size.x().saturating_mul(size.y()) > MAX_PIXELS) {
        return Err(ImageError::file(
            path,
            format!("more than {MAX_PIXELS} pixels"),
        ));
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.x(), vec![Vec3::ZERO; size.area()]),
            |(width, pixels), at, (r, g, b): (f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(failed)?;
    let size = image.layer_data.size;
    let (_, pixels) = image.layer_data.channel_data.pixels;
    Film::from_radiance(UVec2::new(size.x() as u32, size.y() as u32), pixels)
        .ok_or_else(|| ImageError::file(path, "the number of pixels is not the area"))
}

fn read_png(path: &Path) -> Result<Film, ImageError> {
    let failed = |problem: image::ImageError| ImageError::file(path, problem);
    let mut reader =
        image::ImageReader::open(path).map_err(|problem| ImageError::file(path, problem))?;
    reader.set_format(image::ImageFormat::Png);
    let picture = reader.decode().map_err(failed)?.into_rgb8();
    let size = UVec2::new(picture.width(), picture.height());
    let radiance = picture
        .pixels()
        .map(|pixel| Vec3::from_array(pixel.0.map(|byte| srgb_decoded(f32::from(byte) / 255.0))))
        .collect();
    Film::from_radiance(size, radiance)
        .ok_or_else(|| ImageError::file(path, "the number of pixels is not the area"))
}

fn srgb_decoded(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ToneCurve;

    fn gradient() -> Film {
        let pixels = (0..35)
            .map(|i| Vec3::new(i as f32 / 35.0, 0.25, 1.5))
            .collect();
        Film::from_radiance(UVec2::new(7, 5), pixels).unwrap()
    }

    #[test]
    fn an_exr_keeps_what_it_was_given() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write_exr(&path, &gradient(), Precision::Float).unwrap();
        assert_eq!(read_image(&path).unwrap(), gradient());
        write_exr(&path, &gradient(), Precision::Half).unwrap();
        assert_eq!(
            read_image(&path).unwrap(),
            gradient().quantized(Precision::Half)
        );
    }

    #[test]
    fn a_png_keeps_eight_bits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let map = ToneMap {
            exposure_stops: 0.0,
            curve: ToneCurve::Linear,
        };
        write_png(&path, &gradient(), &map).unwrap();
        let back = read_image(&path).unwrap();
        for (a, b) in back.radiance().iter().zip(gradient().radiance()) {
            assert!((*a - b.min(Vec3::ONE)).abs().max_element() < 0.01);
        }
    }

    #[test]
    fn what_is_not_a_picture_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.exr");
        std::fs::write(&path, b"not an exr").unwrap();
        assert!(
            read_image(&path)
                .unwrap_err()
                .to_string()
                .contains("broken.exr")
        );
        assert!(
            read_image(&folder.path().join("absent.png"))
                .unwrap_err()
                .to_string()
                .contains("absent.png")
        );
        assert!(matches!(
            read_image("x.txt".as_ref()),
            Err(ImageError::Format(_))
        ));
        assert!(
            write_exr(
                &folder.path().join("no/such.exr"),
                &gradient(),
                Precision::Half
            )
            .is_err()
        );
    }
}
