//! What the edges of a polygon add to its irradiance, in double precision: the terms of a
//! small light cancel to a ten-thousandth of themselves, and there must be digits left.

/// A place or a direction.
pub(super) type Vector = [f64; 3];

/// Terms of [`angle_ratio`], from the constant on: fitted at Chebyshev's nodes, with the value
/// at 0 held. The largest relative error over `[0, 1]` is 1.7e-10, and falls with the argument:
/// the narrower a light, the less of it is left after the edges cancel.
#[allow(clippy::excessive_precision)]
const ANGLE_RATIO: [f64; 13] = [
    1.0,
    0.333_333_333_192_944,
    0.133_333_376_770_989_58,
    0.057_140_807_903_657_52,
    0.025_434_105_203_073_903,
    0.011_197_092_394_011_045,
    0.007_213_570_318_420_183,
    -0.003_928_797_903_068_78,
    0.015_288_717_833_342_22,
    -0.019_634_017_801_213_717,
    0.018_508_969_100_257_566,
    -0.009_472_394_525_790_95,
    0.002_381_564_082_417_851,
];

/// An angle over its sine, `acos(c) / √(1 − c²)`, where `1 − c` in `[0, 1]` is given.
#[inline(always)]
fn angle_ratio(one_minus_cosine: f64) -> f64 {
    let mut sum = ANGLE_RATIO[12];
    let mut term = 12;
    while term > 0 {
        term -= 1;
        sum = sum * one_minus_cosine + ANGLE_RATIO[term];
    }
    sum
}

/// The cosine between `normal` and the plane through an edge and the origin, times the angle
/// between the edge's ends: `normal · (a × b) / |a × b| · acos(a · b / (|a| |b|))`, without
/// either's trouble where the edge is short or seen along itself. The ends come with their
/// lengths.
#[inline(always)]
pub(super) fn edge_term(
    normal: Vector,
    (a, length_a): (Vector, f64),
    (b, length_b): (Vector, f64),
) -> f64 {
    let lengths = length_a * length_b;
    // With c the cosine of half the angle: lengths · 2 c², kept from 0, where the origin is on
    // the edge.
    let doubled = larger(lengths + dot(a, b), 1.0e-14 * lengths);
    // lengths · c
    let scaled = (0.5 * lengths * doubled).sqrt();
    let reciprocal = 1.0 / larger(scaled * lengths, f64::MIN_POSITIVE);
    let cosine = smaller(scaled * scaled * reciprocal, 1.0);
    // sin θ = 2 sin θ/2 cos θ/2, so that θ / sin θ is the half angle's ratio over its cosine.
    dot(normal, cross(a, b)) * angle_ratio(1.0 - cosine) * (lengths * reciprocal)
}

#[inline(always)]
pub(super) fn subtract(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - b[1] * a[2],
        a[2] * b[0] - b[2] * a[0],
        a[0] * b[1] - b[0] * a[1],
    ]
}

#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_is_within_its_error() {
        for step in 0..=100_000 {
            let cosine = f64::from(step) / 100_001.0;
            let expected = cosine.acos() / (1.0 - cosine * cosine).sqrt();
            let error = (angle_ratio(1.0 - cosine) / expected - 1.0).abs();
            assert!(
                error < 2.0e-10 * (1.0 - cosine) + 1.0e-11,
                "{error:e} at {cosine}"
            );
        }
        assert!((angle_ratio(0.0) - 1.0).abs() < f64::EPSILON);
    }

    #[test]
    fn an_edge_is_its_angle_times_a_cosine() {
        let ends = |angle: f64| {
            let b = [3.0 * angle.cos(), 3.0 * angle.sin(), 0.0];
            (([2.0, 0.0, 0.0], 2.0), (b, 3.0))
        };
        for angle in [1.0e-7, 1.0e-3, 0.5, 1.5, 1.6, 3.0, 3.13] {
            let (a, b) = ends(angle);
            let found = edge_term([0.0, 0.6, 0.8], a, b);
            // Next to the edge there is little of the cosine left.
            let room = if angle > 3.1 { 1.0e-5 } else { 1.0e-9 };
            assert!((found / (0.8 * angle) - 1.0).abs() < room, "{found}");
        }
        // Along itself, through the origin, and at it.
        for b in [[5.0, 0.0, 0.0], [-5.0, 0.0, 0.0], [0.0; 3]] {
            let length = dot(b, b).sqrt();
            let found = edge_term([0.0, 0.6, 0.8], ([2.0, 0.0, 0.0], 2.0), (b, length));
            assert!(found.abs() < 1.0e-6, "{found}");
        }
    }
}
