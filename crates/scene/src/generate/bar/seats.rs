//! Chairs of bent wood, armchairs, and the padded bench along the south wall.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec2, Vec3};

use super::{HALF, Site, joinery::Front, model::Model, turn};
use crate::generate::{
    mesh::Mesh,
    shapes::{lathe, parametric, torus},
    sweep::{smooth, tube, turned},
};

/// From where to where the bench is, in x.
const BENCH: [f32; 2] = [-6.5, 3.3];
const SEAT_HEIGHT: f32 = 0.46;

impl Site {
    /// A café chair on its origin; whoever sits on it looks towards −z.
    pub(super) fn chair(&self) -> Model {
        let mut model = Model::default();
        let wood = self.palette.beech;
        let seat = turned(
            &[
                [0.0, 0.435],
                [0.19, 0.435],
                [0.205, 0.448],
                [0.198, 0.463],
                [0.172, 0.462],
            ],
            self.steps(2),
            self.fine(22),
        );
        model.add(wood, &seat, Vec3::ZERO);
        let weave = lathe(
            &[
                Vec2::new(0.176, 0.459),
                Vec2::new(0.09, 0.456),
                Vec2::new(0.0, 0.455),
            ],
            self.fine(22),
        );
        model.add(self.palette.cane, &weave, Vec3::ZERO);
        for (x, z) in [(-0.15, -0.13), (0.15, -0.13)] {
            let foot = Vec3::new(1.25 * x, 0.0, 1.35 * z);
            let path = smooth(
                &[
                    Vec3::new(x, 0.45, z),
                    Vec3::new(1.05 * x, 0.25, 1.08 * z),
                    foot,
                ],
                self.steps(2),
            );
            model.add(wood, &tube(&path, 0.0145, self.fine(7)), Vec3::ZERO);
        }
        let ring = torus(0.155, 0.0095, [self.fine(18), self.fine(4)]);
        model.add(wood, &ring, 0.27 * Vec3::Y);
        // One bar makes both hind legs and the back.
        let side = |x: f32| {
            [
                Vec3::new(1.15 * x, 0.0, 0.24),
                Vec3::new(1.02 * x, 0.24, 0.175),
                Vec3::new(x, 0.46, 0.165),
                Vec3::new(1.08 * x, 0.68, 0.20),
            ]
        };
        let mut outer = side(-0.165).to_vec();
        outer.push(Vec3::new(-0.13, 0.86, 0.235));
        outer.push(Vec3::new(0.0, 0.915, 0.25));
        outer.push(Vec3::new(0.13, 0.86, 0.235));
        outer.extend(side(0.165).into_iter().rev());
        let bow = tube(&smooth(&outer, self.steps(3)), 0.0145, self.fine(7));
        model.add(wood, &bow, Vec3::ZERO);
        let inner = [
            Vec3::new(-0.10, 0.455, 0.166),
            Vec3::new(-0.105, 0.62, 0.188),
            Vec3::new(-0.07, 0.745, 0.212),
            Vec3::new(0.0, 0.785, 0.22),
            Vec3::new(0.07, 0.745, 0.212),
            Vec3::new(0.105, 0.62, 0.188),
            Vec3::new(0.10, 0.455, 0.166),
        ];
        let bow = tube(&smooth(&inner, self.steps(3)), 0.010, self.fine(6));
        model.add(wood, &bow, Vec3::ZERO);
        model
    }

    /// A low armchair, a shell of leather about a round seat; it looks towards −z.
    pub(super) fn armchair(&self) -> Model {
        let mut model = Model::default();
        // From one arm round the back to the other; the shell is highest behind.
        let rim = |u: f32| {
            let angle = PI * (1.18 * u - 0.09);
            let high = 0.60 + 0.2 * (PI * u).sin().powi(2);
            (Vec3::new(angle.cos(), 0.0, angle.sin()), high)
        };
        let shell = parametric([self.fine(30), self.fine(15)], |u, v| {
            let (out, high) = rim(u);
            // Up the outer side, over the rounded edge, down the inner side.
            let (radius, height) = match v {
                v if v < 0.4 => (0.40, 0.12 + (high - 0.12) * v / 0.4),
                v if v < 0.6 => {
                    let (sin, cos) = ((v - 0.4) / 0.2 * PI).sin_cos();
                    (0.355 + 0.045 * cos, high + 0.045 * sin)
                }
                v => (0.31, high + (0.36 - high) * (v - 0.6) / 0.4),
            };
            radius * out + height * Vec3::Y
        });
        model.add(self.palette.tan, &shell, Vec3::ZERO);
        for u in [0.0, 1.0] {
            let (out, high) = rim(u);
            let ahead = Vec3::new(out.z, 0.0, -out.x) * if u == 0.0 { 1.0 } else { -1.0 };
            let end = turned(
                &[
                    [0.045, 0.12],
                    [0.045, high],
                    [0.04, high + 0.02],
                    [0.0, high + 0.045],
                ],
                self.steps(2),
                self.fine(16),
            );
            model.add(self.palette.tan, &end, 0.355 * out + 0.002 * ahead);
        }
        let cushion = turned(
            &[
                [0.0, 0.25],
                [0.29, 0.25],
                [0.29, 0.25],
                [0.308, 0.28],
                [0.306, 0.39],
                [0.27, 0.425],
                [0.0, 0.44],
            ],
            self.steps(2),
            self.fine(28),
        );
        model.add(self.palette.tan, &cushion, Vec3::ZERO);
        let base = turned(
            &[
                [0.0, 0.1],
                [0.385, 0.1],
                [0.385, 0.1],
                [0.39, 0.14],
                [0.30, 0.26],
            ],
            1,
            self.fine(28),
        );
        model.add(self.palette.ebony, &base, Vec3::ZERO);
        for leg in 0..4 {
            let way = turn((leg as f32 + 0.5) * TAU / 4.0) * Vec3::X;
            let foot = turned(&[[0.0, 0.0], [0.014, 0.0], [0.024, 0.11]], 1, self.fine(10));
            model.add(self.palette.brass, &foot, 0.3 * way);
        }
        model
    }

    /// A bench with a buttoned back.
    pub(super) fn add_bench(&mut self) {
        let front = Front::upright(Vec3::new(BENCH[1], 0.0, HALF[1]), Vec3::NEG_X);
        let length = BENCH[1] - BENCH[0];
        let mut wood = Mesh::default();
        front.board(&mut wood, [0.0, length], [0.0, 0.09], [0.04, 0.44]);
        front.board(&mut wood, [0.0, length], [0.09, 0.33], [0.03, 0.50]);
        front.board(&mut wood, [0.0, length], [0.33, 1.16], [0.03, 0.09]);
        front.board(&mut wood, [-0.04, length + 0.04], [1.16, 1.20], [0.0, 0.22]);
        for x in [[-0.04, 0.0], [length, length + 0.04]] {
            front.board(&mut wood, x, [0.0, 0.62], [0.0, 0.56]);
            front.board(&mut wood, x, [0.62, 1.16], [0.0, 0.20]);
        }
        self.part("bench frame", self.palette.walnut, wood);
        let mut padding = Mesh::default();
        let mut buttons = Mesh::default();
        let count = (length / 0.98).round();
        let pitch = length / count;
        let button = turned(
            &[[0.012, 0.0], [0.009, 0.006], [0.0, 0.008]],
            1,
            self.fine(8),
        );
        for index in 0..count as u32 {
            let x = [
                pitch * index as f32 + 0.004,
                pitch * (index + 1) as f32 - 0.004,
            ];
            padding.add(&self.seat_cushion(front, x), Quat::IDENTITY, Vec3::ZERO);
            padding.add(&self.back_cushion(front, x), Quat::IDENTITY, Vec3::ZERO);
            let towards_room = Quat::from_rotation_arc(Vec3::Y, Vec3::NEG_Z);
            for (u, v) in BUTTONS {
                let (x, y) = (x[0] + u * (x[1] - x[0]), back_height(v));
                buttons.add(&button, towards_room, front.at(x, y, 0.145));
            }
        }
        self.part("bench padding", self.palette.oxblood, padding);
        self.part("bench buttons", self.palette.brass, buttons);
    }

    fn seat_cushion(&self, front: Front, x: [f32; 2]) -> Mesh {
        let counts = [self.fine(8), self.fine(14)];
        parametric(counts, |u, v| {
            // From the front's lower edge round to the top's hind edge.
            let (z, y) = match v {
                v if v < 0.2 => (0.545, 0.33 + 0.07 * v / 0.2),
                v if v < 0.5 => {
                    let (sin, cos) = ((v - 0.2) / 0.3 * 0.5 * PI).sin_cos();
                    (0.485 + 0.06 * cos, 0.40 + 0.06 * sin)
                }
                v => (0.485 - 0.385 * (v - 0.5) / 0.5, SEAT_HEIGHT),
            };
            let pillow = edge(u).min(edge(0.5 + 0.5 * v));
            front.at(x[0] + u * (x[1] - x[0]), y - 0.035 * (1.0 - pillow), z)
        })
    }

    /// Padding that is drawn in at its buttons.
    fn back_cushion(&self, front: Front, x: [f32; 2]) -> Mesh {
        let counts = [self.fine(20), self.fine(14)];
        parametric(counts, |u, v| {
            let width = x[1] - x[0];
            let dimple: f32 = BUTTONS
                .iter()
                .map(|&(bu, bv)| {
                    let (across, up) = ((u - bu) * width, 0.68 * (v - bv));
                    (-(across * across + up * up) / 0.0042).exp()
                })
                .sum();
            let z = 0.09 + 0.105 * edge(u).min(edge(v)) - 0.055 * dimple.min(1.0);
            front.at(x[0] + u * width, back_height(v), z)
        })
    }
}

/// Places of the buttons on a back cushion, from 0 to 1 across and up.
const BUTTONS: [(f32, f32); 8] = [
    (0.2, 0.34),
    (0.5, 0.34),
    (0.8, 0.34),
    (0.35, 0.58),
    (0.65, 0.58),
    (0.2, 0.82),
    (0.5, 0.82),
    (0.8, 0.82),
];

fn back_height(v: f32) -> f32 {
    SEAT_HEIGHT - 0.02 + 0.71 * v
}

/// 1 in the middle and 0 at both ends, rising like a quarter circle.
fn edge(s: f32) -> f32 {
    let near = ((0.5 - (s - 0.5).abs()) / 0.1).clamp(0.0, 1.0);
    (near * (2.0 - near)).sqrt()
}
