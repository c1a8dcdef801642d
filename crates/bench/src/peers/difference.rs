use std::path::Path;

use lie_render::{Film, compare};

use super::{
    PeersConfig, area_side,
    harness::{Order, read_picture},
    has_area_lights,
    round::Peer,
};
use crate::{BenchError, Stage};

/// How far a picture is from one that another program made of the same scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Root mean square error over all channels, divided by the other picture's mean.
    pub relative_rmse: f64,
    /// The same without the thousandth of the pixels whose error is largest: edges of shapes and
    /// of shadows fall on one pixel or the next.
    pub relative_rmse_p999: f64,
    /// Share of the pixels in which a channel is off by more than a hundredth of the other
    /// picture's mean and of the channel's own value there.
    pub differing: f64,
}

impl Difference {
    const TOLERANCE: f32 = 0.01;

    pub(super) fn between(
        stage: &Stage,
        picture: &Film,
        reference: &Film,
    ) -> Result<Self, BenchError> {
        let figures = compare(picture, reference, stage.exposure_stops())?;
        let count = reference.radiance().len();
        let values = reference.radiance().iter();
        let sum: f64 = values.map(|value| f64::from(value.element_sum())).sum();
        let mean = (sum / (3 * count) as f64) as f32;
        let pairs = picture.radiance().iter().zip(reference.radiance());
        let is_off = |(a, b): &(&glam::Vec3, &glam::Vec3)| {
            let most = Self::TOLERANCE * b.max(glam::Vec3::splat(mean));
            (**a - **b).abs().cmpgt(most).any()
        };
        Ok(Self {
            relative_rmse: figures.relative_rmse,
            relative_rmse_p999: figures.relative_rmse_p999,
            differing: pairs.filter(is_off).count() as f64 / count as f64,
        })
    }
}

/// The other program's pictures.
pub(super) struct References {
    /// Of each variant.
    own: Vec<Film>,
    /// Of all that have shadows, as free of noise as it is made.
    shaded: Option<Film>,
    /// Cosines of the primary rays.
    primary: Option<Film>,
}

impl References {
    /// Times as many shadow rays along a side of an area light as in the frames that are timed.
    const FINER: u32 = 4;

    /// One frame of each variant, not timed; and one with many samples, if lights have an extent.
    pub(super) fn render(peer: &Peer<'_>, config: &PeersConfig) -> Result<Self, BenchError> {
        let (stage, folder) = (peer.stage, peer.folder.path());
        let (own, readings) = render(peer, config, &config.variants, 1, &folder.join("own"))?;
        let last_shaded = readings.iter().rposition(|is_primary| !is_primary);
        let shaded = match last_shaded {
            Some(index) if has_area_lights(stage) => {
                let variant = &config.variants[index..=index];
                let fine = folder.join("fine");
                render(peer, config, variant, Self::FINER, &fine)?.0.pop()
            }
            other => other.map(|index| own[index].clone()),
        };
        let primary = readings.iter().position(|is_primary| *is_primary);
        let primary = primary.map(|index| own[index].clone());
        Ok(Self {
            own,
            shaded,
            primary,
        })
    }

    /// What a picture of all light is compared with.
    pub(super) fn shaded(&self) -> Option<&Film> {
        self.shaded.as_ref()
    }

    /// What cosines of primary rays are compared with.
    pub(super) fn primary(&self) -> Option<&Film> {
        self.primary.as_ref()
    }

    /// The picture of a variant, by its place.
    pub(super) fn of_variant(&self, index: usize) -> &Film {
        &self.own[index]
    }
}

/// Pictures of some variants, and which are of primary rays alone.
fn render(
    peer: &Peer<'_>,
    config: &PeersConfig,
    variants: &[String],
    finer: u32,
    prefix: &Path,
) -> Result<(Vec<Film>, Vec<bool>), BenchError> {
    let readings = config.harness.run(&Order {
        scene: &peer.file,
        variants,
        threads: config.threads.iter().copied().max().unwrap_or(1),
        frames: 0,
        area_side: finer * area_side(peer.stage),
        pictures: Some(prefix),
    })?;
    let size = peer.stage.settings().size;
    let mut films = vec![];
    for variant in variants {
        films.push(read_picture(prefix, variant, size)?);
    }
    let primary = readings.iter().map(|reading| reading.is_primary);
    Ok((films, primary.collect()))
}
