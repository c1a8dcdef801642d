use glam::DVec3;

use crate::{Film, ImageError, ToneCurve, ToneMap};

/// How far a picture is from a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Root mean square error over all channels, divided by the reference's mean.
    pub relative_rmse: f64,
    /// The same without the thousandth of the pixels whose error is largest.
    pub relative_rmse_p999: f64,
    /// Peak signal to noise ratio in dB of the displayed pictures; infinite if they are equal.
    pub psnr_db: f64,
    /// Mean of NVIDIA's FLIP of the displayed pictures: 0 is equal, 1 is far apart.
    pub flip_mean: f64,
    /// Share of the pixels that differ at all.
    pub differing: f64,
}

/// Compares two pictures of one size; the second is the reference. PSNR and FLIP look at
/// them as displayed with this exposure and a linear curve.
///
/// # Errors
/// [`ImageError::Sizes`] if the sizes differ.
pub fn compare(
    picture: &Film,
    reference: &Film,
    exposure_stops: f32,
) -> Result<Comparison, ImageError> {
    if picture.size() != reference.size() {
        return Err(ImageError::Sizes(picture.size(), reference.size()));
    }
    let mut errors: Vec<f64> = picture
        .radiance()
        .iter()
        .zip(reference.radiance())
        .map(|(a, b)| (a.as_dvec3() - b.as_dvec3()).length_squared())
        .collect();
    let total: DVec3 = reference
        .radiance()
        .iter()
        .map(|value| value.as_dvec3())
        .sum();
    let mean = total.element_sum() / (3 * errors.len()) as f64;
    let differing =
        errors.iter().filter(|&&error| error > 0.0).count() as f64 / errors.len() as f64;
    errors.sort_by(f64::total_cmp);
    let kept = errors.len() - errors.len() / 1000;
    let relative = |errors: &[f64]| {
        let rmse = (errors.iter().sum::<f64>() / (3 * errors.len()) as f64).sqrt();
        // Against a black reference any error is infinitely large, and none is none.
        if rmse == 0.0 { 0.0 } else { rmse / mean }
    };
    let map = ToneMap {
        exposure_stops,
        curve: ToneCurve::Linear,
    };
    Ok(Comparison {
        relative_rmse: relative(&errors),
        relative_rmse_p999: relative(&errors[..kept]),
        psnr_db: psnr(picture, reference, &map),
        flip_mean: flip(picture, reference, &map),
        differing,
    })
}

fn psnr(picture: &Film, reference: &Film, map: &ToneMap) -> f64 {
    let sum: f64 = picture
        .radiance()
        .iter()
        .zip(reference.radiance())
        .map(|(a, b)| {
            (map.display(*a) - map.display(*b))
                .as_dvec3()
                .length_squared()
        })
        .sum();
    -10.0 * (sum / (3 * picture.radiance().len()) as f64).log10()
}

fn flip(picture: &Film, reference: &Film, map: &ToneMap) -> f64 {
    let (width, height) = (picture.size().x, picture.size().y);
    let image = |film: &Film| nv_flip::FlipImageRgb8::with_data(width, height, &map.bytes(film));
    let error_map = nv_flip::flip(
        image(reference),
        image(picture),
        nv_flip::DEFAULT_PIXELS_PER_DEGREE,
    );
    f64::from(nv_flip::FlipPool::from_image(&error_map).mean())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec2, Vec3};

    #[test]
    fn known_errors_are_measured() {
        let reference =
            Film::from_radiance(UVec2::new(32, 32), vec![Vec3::splat(0.5); 1024]).unwrap();
        let same = compare(&reference, &reference, 0.0).unwrap();
        assert_eq!(
            (same.relative_rmse, same.flip_mean, same.differing),
            (0.0, 0.0, 0.0)
        );
        assert_eq!(same.psnr_db, f64::INFINITY);
        // One pixel off by 0.5 in every channel: RMSE is 0.5 / 32.
        let mut pixels = vec![Vec3::splat(0.5); 1024];
        pixels[77] = Vec3::ONE;
        let other = Film::from_radiance(UVec2::new(32, 32), pixels).unwrap();
        let one = compare(&other, &reference, 0.0).unwrap();
        assert!((one.relative_rmse - 1.0 / 32.0).abs() < 1.0e-9);
        assert_eq!(one.relative_rmse_p999, 0.0);
        assert!((one.differing - 1.0 / 1024.0).abs() < 1.0e-12);
        assert!(one.flip_mean > 0.0 && one.psnr_db < 60.0);
        assert!(compare(&Film::new(UVec2::new(2, 2)), &reference, 0.0).is_err());
    }
}
