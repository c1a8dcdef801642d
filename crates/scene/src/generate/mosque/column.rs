//! Bases and shafts. A column stands on the floor, about the y axis.

use glam::Vec2;

use super::{Site, slab};
use crate::generate::{
    mesh::Mesh,
    shapes::{lathe, parametric},
};

/// Where the shaft ends and the capital begins.
pub(super) const SHAFT_TOP: f32 = 2.6;
/// Radius of the shaft below its capital.
pub(super) const NECK: f32 = 0.205;
const BASE_TOP: f32 = 0.42;

impl Site {
    /// Plinth, two rounds and the hollow between them.
    pub(super) fn base(&self) -> Mesh {
        let mut profile = vec![Vec2::new(0.31, 0.119)];
        let mut round = |center: [f32; 2], radius: f32, outwards: f32, steps: u32| {
            for step in 0..=steps {
                let angle = (step as f32 / steps as f32 - 0.5) * std::f32::consts::PI;
                let way = Vec2::new(outwards * angle.cos(), angle.sin());
                profile.push(Vec2::from(center) + radius * way);
            }
        };
        let steps = self.steps(3);
        round([0.27, 0.175], 0.05, 1.0, steps);
        round([0.265, 0.275], 0.04, -1.0, steps);
        round([0.235, 0.35], 0.032, 1.0, steps);
        profile.push(Vec2::new(0.225, BASE_TOP));
        let mut mesh = lathe(&profile, self.fine(24));
        slab(&mut mesh, glam::Vec3::ZERO, [0.325, 0.325], [0.0, 0.12]);
        mesh
    }

    /// The three kinds of shaft: plain with a swelling, with straight flutes, with flutes that
    /// wind.
    pub(super) fn shafts(&self) -> [Mesh; 3] {
        let plain = self.shaft([28, 6], |_, _| 0.0);
        let flute = |angle: f32| 0.012 * (1.0 - (0.5 * angle).sin().abs()).powi(2);
        let straight = self.shaft([72, 4], |turn, _| -flute(18.0 * turn));
        let winding = self.shaft([72, 14], |turn, v| -flute(12.0 * turn + 9.0 * v));
        [plain, straight, winding]
    }

    fn shaft(&self, counts: [u32; 2], relief: impl Fn(f32, f32) -> f32) -> Mesh {
        let counts = [self.fine(counts[0]), self.steps(counts[1])];
        let mut mesh = parametric(counts, |u, v| {
            let angle = u * std::f32::consts::TAU;
            // Flutes fade before both ends.
            let fade = (14.0 * (v - 0.05).min(0.95 - v)).clamp(0.0, 1.0);
            let swelling = 0.014 * (1.0 - v) + 0.008 * (v * std::f32::consts::PI).sin();
            let radius = NECK + swelling + fade * relief(angle, v);
            let (sin, cos) = angle.sin_cos();
            let height = BASE_TOP + v * (SHAFT_TOP - BASE_TOP);
            glam::Vec3::new(radius * cos, height, -radius * sin)
        });
        let collar = [
            [NECK, 2.5],
            [NECK + 0.028, 2.52],
            [NECK + 0.034, 2.545],
            [NECK + 0.028, 2.57],
            [NECK, 2.59],
        ]
        .map(Vec2::from);
        super::place(&mut mesh, &lathe(&collar, self.fine(24)), glam::Vec3::ZERO);
        mesh
    }
}
