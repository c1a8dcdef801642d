//! Warps from the unit square to the shapes that lights and pixels are sampled on.

use glam::{Vec2, Vec3};

/// Barycentric weights of a uniform point on a triangle, for its second and third vertex
/// (Heitz 2019, *A Low-Distortion Map Between Triangle and Square*).
#[must_use]
#[inline]
pub fn square_to_triangle(square: Vec2) -> Vec2 {
    if square.y > square.x {
        let x = 0.5 * square.x;
        Vec2::new(x, square.y - x)
    } else {
        let y = 0.5 * square.y;
        Vec2::new(square.x - y, y)
    }
}

/// A cosine-distributed direction on the hemisphere around +z (Shirley and Chiu's
/// concentric disk, raised).
#[must_use]
pub fn square_to_cosine_hemisphere(square: Vec2) -> Vec3 {
    let offset = 2.0 * square - Vec2::ONE;
    let disk = if offset == Vec2::ZERO {
        Vec2::ZERO
    } else if offset.x.abs() > offset.y.abs() {
        offset.x * Vec2::from_angle(std::f32::consts::FRAC_PI_4 * (offset.y / offset.x))
    } else {
        let angle =
            std::f32::consts::FRAC_PI_2 - std::f32::consts::FRAC_PI_4 * (offset.x / offset.y);
        offset.y * Vec2::from_angle(angle)
    };
    disk.extend((1.0 - disk.length_squared()).max(0.0).sqrt())
}

/// Columns and rows of the stratification of `count` samples: the most nearly square grid
/// with exactly `count` cells.
#[must_use]
pub fn strata(count: u32) -> (u32, u32) {
    let mut rows = (count.max(1) as f32).sqrt() as u32;
    while rows > 1 && !count.is_multiple_of(rows) {
        rows -= 1;
    }
    (count.max(1) / rows.max(1), rows.max(1))
}

/// A point of the unit square inside stratum `index` of `strata` (columns, rows), where
/// `jitter` in `[0, 1)²` says where.
#[must_use]
#[inline]
pub fn stratified((columns, rows): (u32, u32), index: u32, jitter: Vec2) -> Vec2 {
    let cell = Vec2::new((index % columns) as f32, (index / columns) as f32);
    ((cell + jitter) / Vec2::new(columns as f32, rows as f32))
        .min(Vec2::splat(1.0 - f32::EPSILON / 2.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strata_multiply_to_the_count() {
        for count in 1..200 {
            let (columns, rows) = strata(count);
            assert_eq!(columns * rows, count);
        }
        assert_eq!(strata(64), (8, 8));
        assert_eq!(strata(0), (1, 1));
    }

    #[test]
    fn triangle_weights_stay_inside_and_balance() {
        let n = 64;
        let mut sum = Vec2::ZERO;
        for i in 0..n * n {
            let p = square_to_triangle(stratified((n, n), i, Vec2::splat(0.5)));
            assert!(p.x >= 0.0 && p.y >= 0.0 && p.x + p.y <= 1.0);
            sum += p;
        }
        let mean = sum / (n * n) as f32;
        assert!((mean - Vec2::splat(1.0 / 3.0)).length() < 1.0e-3, "{mean}");
    }

    #[test]
    fn the_hemisphere_is_cosine_weighted() {
        let n = 64;
        let mean: f32 = (0..n * n)
            .map(|i| square_to_cosine_hemisphere(stratified((n, n), i, Vec2::splat(0.5))).z)
            .sum::<f32>()
            / (n * n) as f32;
        // E[cos] under a cosine density is 2/3; midpoints overrate the rim a little.
        assert!((mean - 2.0 / 3.0).abs() < 2.0e-3, "{mean}");
    }
}
