use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
};
use half::f16;

use super::{AovPixel, Aovs, CellAov, CostModel};
use crate::{Film, ImageError, Precision};

/// A channel's name and its value at a pixel.
type Channel = (&'static str, fn(&AovPixel) -> f32);

/// Channels of every frame, by the names that viewers and compositors know.
const ALWAYS: [Channel; 12] = [
    ("albedo.R", |pixel| pixel.albedo.x),
    ("albedo.G", |pixel| pixel.albedo.y),
    ("albedo.B", |pixel| pixel.albedo.z),
    ("normal.X", |pixel| pixel.normal.x),
    ("normal.Y", |pixel| pixel.normal.y),
    ("normal.Z", |pixel| pixel.normal.z),
    ("cost.Y", |pixel| {
        CostModel::default().cost_ns(&pixel.work) as f32
    }),
    ("work.primary", |pixel| pixel.work.primary_rays as f32),
    ("work.evaluations", |pixel| pixel.work.evaluations() as f32),
    ("work.list", |pixel| pixel.work.list_rays as f32),
    ("work.tests", |pixel| pixel.work.occluder_tests() as f32),
    ("work.shadow", |pixel| pixel.work.shadow_rays as f32),
];

/// Channels of a frame with LIEs.
const OF_CELLS: [Channel; 8] = [
    ("lights.unoccluded", |pixel| cell(pixel).unoccluded),
    ("lights.partial", |pixel| cell(pixel).partial),
    ("lights.traced", |pixel| cell(pixel).traced),
    ("lights.masked", |pixel| cell(pixel).masked),
    ("lights.hidden", |pixel| cell(pixel).hidden),
    ("cell.depth", |pixel| cell(pixel).depth),
    ("cell.samples", |pixel| cell(pixel).samples),
    ("expected_error.Y", |pixel| cell(pixel).expected_error),
];

fn cell(pixel: &AovPixel) -> CellAov {
    pixel.cell.unwrap_or_default()
}

/// Writes one OpenEXR file with a picture and its arbitrary output variables, as channels of
/// one part: `R`, `G`, `B` are the picture in some precision; all others are 32 bits, their
/// layer's name before the last point.
///
/// # Errors
/// [`ImageError`] if picture and variables differ in size, or the file cannot be written.
pub fn write_aovs(
    path: &Path,
    film: &Film,
    precision: Precision,
    aovs: &Aovs,
) -> Result<(), ImageError> {
    if film.size() != aovs.size() {
        return Err(ImageError::Sizes(film.size(), aovs.size()));
    }
    let rgb = ["R", "G", "B"].iter().enumerate().map(|(index, &name)| {
        let values = film.radiance().iter().map(|radiance| radiance[index]);
        AnyChannel::new(name, samples(values, precision))
    });
    let has_cells = aovs.pixels().iter().any(|pixel| pixel.cell.is_some());
    let of_cells = if has_cells { &OF_CELLS[..] } else { &[] };
    let others = ALWAYS.iter().chain(of_cells).map(|(name, value)| {
        let values = aovs.pixels().iter().map(value);
        AnyChannel::new(*name, samples(values, Precision::Float))
    });
    let layer = Layer::new(
        (film.size().x as usize, film.size().y as usize),
        LayerAttributes::default(),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(rgb.chain(others).collect()),
    );
    // Blocks in order, so that equal pictures are equal files.
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_file(path)
        .map_err(|problem| ImageError::file(path, problem))
}

fn samples(values: impl Iterator<Item = f32>, precision: Precision) -> FlatSamples {
    match precision {
        Precision::Float => FlatSamples::F32(values.collect()),
        Precision::Half => {
            let largest = f16::MAX.to_f32();
            FlatSamples::F16(
                values
                    .map(|value| f16::from_f32(value.min(largest)))
                    .collect(),
            )
        }
    }
}
