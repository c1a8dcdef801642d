//! Capitals: a bell with two rows of leaves, four volutes under the corners, a slab on top.
//! Carved by a displacement that is the same on every machine but for rounding.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use glam::{Quat, Vec2, Vec3};

use super::{Site, column::NECK, place};
use crate::generate::{
    mesh::Mesh,
    shapes::{parametric, sphere, sweep},
};

/// Height of the bell; the slab lies on it.
const BELL: f32 = 0.5;
/// Height of bell and slab.
pub(super) const HEIGHT: f32 = 0.6;

/// How one kind of capital is carved.
#[derive(Clone, Copy)]
struct Carving {
    /// Leaves in each row.
    leaves: f32,
    /// How deep the leaves' edges are cut, relative to their width.
    lobes: f32,
    /// How far the tips reach.
    curl_m: f32,
}

const CARVINGS: [Carving; 3] = [
    Carving {
        leaves: 8.0,
        lobes: 0.22,
        curl_m: 0.075,
    },
    Carving {
        leaves: 8.0,
        lobes: 0.0,
        curl_m: 0.085,
    },
    Carving {
        leaves: 12.0,
        lobes: 0.15,
        curl_m: 0.06,
    },
];

impl Site {
    /// The kinds of capital, each standing on y = 0.
    pub(super) fn capitals(&self) -> [Mesh; 3] {
        CARVINGS.map(|carving| self.capital(carving))
    }

    fn capital(&self, carving: Carving) -> Mesh {
        let counts = [self.fine(54), self.fine(20)];
        let mut mesh = parametric(counts, |u, v| bell(carving, u, v));
        let volute = self.volute();
        for corner in 0..4 {
            let turn = FRAC_PI_4 + FRAC_PI_2 * corner as f32;
            mesh.add(&volute, Quat::from_rotation_y(turn), Vec3::ZERO);
        }
        place(&mut mesh, &self.abacus(), BELL * Vec3::Y);
        mesh
    }

    /// A scroll in the plane of x and y, that leans out under a corner of the slab.
    fn volute(&self) -> Mesh {
        const TURNS: f32 = 1.6;
        let center = Vec3::new(0.325, 0.425, 0.0);
        let ribbon: Vec<Vec2> = (0..6)
            .map(|index| {
                let (sin, cos) = (index as f32 / 6.0 * TAU).sin_cos();
                Vec2::new(0.034 * cos, 0.014 * sin)
            })
            .collect();
        let mut mesh = sweep(&ribbon, self.fine(12), |t, p| {
            let angle = FRAC_PI_2 + t * TURNS * TAU;
            let radius = 0.068 - 0.05 * t + p.y * (1.0 - 0.5 * t);
            let (sin, cos) = angle.sin_cos();
            center + Vec3::new(-radius * cos, radius * sin, p.x)
        });
        place(&mut mesh, &sphere(0.024, self.fine(6)), center);
        mesh
    }

    /// The slab on top, its four sides hollow.
    fn abacus(&self) -> Mesh {
        let side = self.steps(4);
        let outline = |half: f32, height: f32| {
            (0..4 * side)
                .map(move |index| {
                    let along = (index % side) as f32 / side as f32 * 2.0 - 1.0;
                    let hollow = half - 0.045 * (1.0 - along * along);
                    let turn = FRAC_PI_2 * (index / side) as f32;
                    Quat::from_rotation_y(turn) * Vec3::new(hollow, height, -along * half)
                })
                .collect::<Vec<_>>()
        };
        let rings = [
            (0.29, 0.0),
            (0.33, 0.035),
            (0.33, 0.055),
            (0.345, 0.06),
            (0.345, HEIGHT - BELL),
        ];
        let mut mesh = Mesh::default();
        for pair in rings.windows(2) {
            let (lower, upper) = (outline(pair[0].0, pair[0].1), outline(pair[1].0, pair[1].1));
            for index in 0..lower.len() {
                let next = (index + 1) % lower.len();
                mesh.quadrangle([lower[index], lower[next], upper[next], upper[index]]);
            }
        }
        for (half, height, is_top) in [(0.29, 0.0, false), (0.345, HEIGHT - BELL, true)] {
            let rim = outline(half, height);
            let middle = height * Vec3::Y;
            for index in 0..rim.len() {
                let (a, b) = (rim[index], rim[(index + 1) % rim.len()]);
                let (a, b) = if is_top { (a, b) } else { (b, a) };
                mesh.triangle([middle, a, b]);
            }
        }
        mesh
    }
}

/// The bell's surface: `u` goes round, `v` up.
fn bell(carving: Carving, u: f32, v: f32) -> Vec3 {
    let flare = 0.012 + 0.085 * v.max(0.0).powi(3);
    let relief = leaf(carving, u * carving.leaves, (v - 0.03) / 0.44).max(leaf(
        carving,
        u * carving.leaves + 0.5,
        (v - 0.26) / 0.5,
    ));
    let radius = NECK + flare + relief;
    let (sin, cos) = (u * TAU).sin_cos();
    Vec3::new(radius * cos, BELL * v, -radius * sin)
}

/// How far a row of leaves stands out at `phase` leaves round and `t` of its height.
fn leaf(carving: Carving, phase: f32, t: f32) -> f32 {
    if t <= 0.0 {
        return 0.0;
    }
    let across = phase - phase.round();
    let lobes = 1.0 - carving.lobes * (t * 5.5 * std::f32::consts::PI).sin().abs();
    let half = 0.49 * lobes * (1.0 - 0.45 * t * t);
    let body = (1.0 - (across / half).powi(2)).max(0.0).sqrt();
    let curl = smooth(0.45, 1.0, t).powi(2);
    let rib = 1.0 - 0.28 * (-(across / 0.06).powi(2)).exp();
    let veins = 1.0 - 0.10 * (9.0 * t - 14.0 * across.abs()).sin().powi(2);
    let end = 1.0 - smooth(1.0, 1.10, t);
    body * rib * veins * (0.022 + carving.curl_m * curl) * end
}

fn smooth(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
