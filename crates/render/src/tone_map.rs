use glam::Vec3;

use crate::Film;

/// From radiance to what a display shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneMap {
    /// Stops: radiance is multiplied by 2 to this power first.
    pub exposure_stops: f32,
    /// The curve.
    pub curve: ToneCurve,
}

/// How bright is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneCurve {
    /// As it is, cut at white. What measurements use.
    Linear,
    /// A filmic shoulder and toe (Narkowicz 2015, *ACES Filmic Tone Mapping Curve*).
    #[default]
    Aces,
}

impl ToneMap {
    /// The display value of a radiance: sRGB-encoded, in `[0, 1]`.
    #[must_use]
    pub fn display(&self, radiance: Vec3) -> Vec3 {
        let exposed = radiance * self.exposure_stops.exp2();
        let shown = match self.curve {
            ToneCurve::Linear => exposed,
            ToneCurve::Aces => {
                // Bounded first: the quotient of two infinities is not a number.
                let x = exposed.min(Vec3::splat(1.0e6)) * 0.6;
                (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)
            }
        };
        Vec3::from_array(
            shown
                .clamp(Vec3::ZERO, Vec3::ONE)
                .to_array()
                .map(srgb_encoded),
        )
    }

    /// The film as 8-bit sRGB, row by row.
    #[must_use]
    pub fn bytes(&self, film: &Film) -> Vec<u8> {
        film.radiance()
            .iter()
            .flat_map(|&value| self.display(value).to_array())
            .map(|channel| (channel * 255.0 + 0.5) as u8)
            .collect()
    }
}

fn srgb_encoded(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_from_black_to_white() {
        for curve in [ToneCurve::Linear, ToneCurve::Aces] {
            let map = ToneMap {
                exposure_stops: 1.0,
                curve,
            };
            assert_eq!(map.display(Vec3::ZERO), Vec3::ZERO);
            assert!(map.display(Vec3::splat(f32::MAX)).min_element() > 0.99);
            let steps: Vec<f32> = (0..100)
                .map(|i| map.display(Vec3::splat(i as f32 * 0.005)).x)
                .collect();
            assert!(steps.windows(2).all(|pair| pair[0] < pair[1]));
        }
        let linear = ToneMap {
            exposure_stops: 0.0,
            curve: ToneCurve::Linear,
        };
        assert!((linear.display(Vec3::splat(0.5)).x - 0.7354).abs() < 1.0e-3);
    }
}
