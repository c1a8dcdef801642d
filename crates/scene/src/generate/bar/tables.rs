//! Tables and what is on them: round ones in the middle, square ones at the bench, high ones
//! in the corner.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec3};
use lie_geom::RandomKey;

use super::{
    Site,
    joinery::Front,
    model::Model,
    turn,
    vessels::{Glass, pick},
};
use crate::generate::{
    mesh::Mesh,
    shapes::{rod, sphere},
    sweep::{smooth, tube, turned},
};

/// Feet of the round tables.
pub(super) const ROUND: [Vec3; 4] = [
    Vec3::new(-3.75, 0.0, 0.62),
    Vec3::new(-1.45, 0.0, 0.82),
    Vec3::new(0.95, 0.0, 0.60),
    Vec3::new(3.30, 0.0, 0.80),
];
/// Feet of the tables at the bench.
pub(super) const BENCH: [Vec3; 5] = [
    Vec3::new(-5.5, 0.0, 3.52),
    Vec3::new(-3.55, 0.0, 3.52),
    Vec3::new(-1.6, 0.0, 3.52),
    Vec3::new(0.35, 0.0, 3.52),
    Vec3::new(2.3, 0.0, 3.52),
];
/// Feet of the high tables.
pub(super) const HIGH: [Vec3; 2] = [Vec3::new(4.45, 0.0, -3.2), Vec3::new(5.75, 0.0, -1.75)];
/// Foot of the low table between armchairs.
pub(super) const LOW: Vec3 = Vec3::new(5.35, 0.0, 3.2);

pub(super) const TABLE_TOP: f32 = 0.75;
const HIGH_TOP: f32 = 1.06;

impl Site {
    pub(super) fn add_tables(&mut self) {
        let mut room = Model::default();
        let (chair, stool) = (self.chair(), self.stool());
        const SEATS: u64 = 3;
        let round = self.pedestal_table(0.40, TABLE_TOP);
        for (index, foot) in ROUND.into_iter().enumerate() {
            let key = self.key.mix(40).mix(index as u64);
            room.place(&round, Quat::IDENTITY, foot);
            self.lay(&mut room, foot + TABLE_TOP * Vec3::Y, key, 4, 0.24);
            for seat in 0..SEATS {
                let own = key.mix(seat);
                let angle = TAU * (seat as f32 + key.uniform(0)) / SEATS as f32;
                let away = 0.60 + 0.12 * own.uniform(1);
                let at = foot + turn(angle) * (away * Vec3::Z);
                room.place(&chair, turn(angle + 0.5 * (own.uniform(2) - 0.5)), at);
            }
        }
        let square = self.square_table();
        for (index, foot) in BENCH.into_iter().enumerate() {
            let key = self.key.mix(41).mix(index as u64);
            room.place(&square, Quat::IDENTITY, foot);
            self.lay(&mut room, foot + TABLE_TOP * Vec3::Y, key, 3, 0.22);
            let at = foot + Vec3::new(0.1 * (key.uniform(1) - 0.5), 0.0, -0.52);
            room.place(&chair, turn(PI + 0.4 * (key.uniform(2) - 0.5)), at);
        }
        let high = self.pedestal_table(0.33, HIGH_TOP);
        for (index, foot) in HIGH.into_iter().enumerate() {
            let key = self.key.mix(42).mix(index as u64);
            room.place(&high, Quat::IDENTITY, foot);
            self.lay(&mut room, foot + HIGH_TOP * Vec3::Y, key, 3, 0.2);
            for seat in 0..3 {
                let angle = TAU * seat as f32 / 3.0 + TAU * key.uniform(0);
                let at = foot + turn(angle) * (0.56 * Vec3::Z);
                room.place(&stool, turn(angle), at);
            }
        }
        let low = self.pedestal_table(0.34, 0.5);
        room.place(&low, Quat::IDENTITY, LOW);
        let key = self.key.mix(43);
        self.lay(&mut room, LOW + 0.5 * Vec3::Y, key, 2, 0.19);
        let armchair = self.armchair();
        for (angle, away) in [(0.55f32, 0.86), (2.5, 0.9), (4.6, 0.92)] {
            let at = LOW + turn(angle) * (away * Vec3::Z);
            room.place(&armchair, turn(angle), at);
        }
        self.put("tables", room);
    }

    /// A round top on a turned column.
    fn pedestal_table(&self, radius: f32, top: f32) -> Model {
        let mut model = Model::default();
        let slab = turned(
            &[
                [0.0, top - 0.032],
                [radius - 0.02, top - 0.032],
                [radius - 0.02, top - 0.032],
                [radius - 0.004, top - 0.026],
                [radius, top - 0.014],
                [radius - 0.004, top - 0.003],
                [radius - 0.014, top],
                [radius - 0.014, top],
                [0.0, top],
            ],
            self.steps(2),
            self.fine(36),
        );
        let mut slab = slab;
        // A lathe's coordinates run round: wood and stone want them flat.
        for vertex in &mut slab.vertices {
            vertex.uv = glam::Vec2::new(vertex.position.x, vertex.position.z);
        }
        let material = if radius > 0.36 {
            self.palette.mahogany
        } else {
            self.palette.marble
        };
        model.add(material, &slab, Vec3::ZERO);
        let neck = top - 0.032;
        let foot = 0.62 * radius;
        let column = turned(
            &[
                [0.0, 0.0],
                [foot, 0.0],
                [foot, 0.0],
                [foot + 0.006, 0.014],
                [0.8 * foot, 0.03],
                [0.055, 0.07],
                [0.034, 0.14],
                [0.052, 0.24 * top],
                [0.030, 0.36 * top],
                [0.027, neck - 0.12],
                [0.05, neck - 0.04],
                [0.12, neck],
            ],
            self.steps(2),
            self.fine(20),
        );
        model.add(self.palette.iron, &column, Vec3::ZERO);
        model
    }

    /// A wooden top on a cross of iron feet.
    fn square_table(&self) -> Model {
        let mut model = Model::default();
        let half = 0.33;
        let front = Front::upright(Vec3::ZERO, Vec3::X);
        let wood = model.of(self.palette.mahogany);
        front.board(
            wood,
            [-half, half],
            [TABLE_TOP - 0.03, TABLE_TOP],
            [-half, half],
        );
        let inner = half - 0.05;
        front.board(
            wood,
            [-inner, inner],
            [TABLE_TOP - 0.075, TABLE_TOP - 0.03],
            [-inner, inner],
        );
        let column = turned(
            &[
                [0.0, 0.05],
                [0.05, 0.05],
                [0.034, 0.12],
                [0.028, 0.35],
                [0.03, 0.6],
                [0.09, TABLE_TOP - 0.075],
            ],
            self.steps(2),
            self.fine(18),
        );
        model.add(self.palette.iron, &column, Vec3::ZERO);
        for leg in 0..4 {
            let way = turn((leg as f32 + 0.5) * std::f32::consts::FRAC_PI_2) * Vec3::X;
            let path = smooth(
                &[
                    0.09 * Vec3::Y,
                    0.16 * way + 0.055 * Vec3::Y,
                    0.3 * way + 0.018 * Vec3::Y,
                ],
                self.steps(3),
            );
            let leg = tube(&path, 0.018, self.fine(7));
            model.add(self.palette.iron, &leg, Vec3::ZERO);
        }
        model
    }

    /// Lays a table: something in the middle, and drinks around it.
    fn lay(&self, room: &mut Model, top: Vec3, key: RandomKey, guests: u32, reach: f32) {
        let palette = &self.palette;
        match (key.uniform(10) * 3.0) as u32 {
            0 => room.place(&self.flowers(key.mix(90)), turn(1.0), top),
            1 => room.place(&self.bottle(key.mix(91)), turn(4.0), top),
            _ => room.place(&self.candlestick(), Quat::IDENTITY, top),
        }
        let begin = TAU * key.uniform(11);
        for guest in 0..guests {
            let own = key.mix(50 + u64::from(guest));
            let angle = begin + TAU * guest as f32 / guests as f32 + 0.5 * own.uniform(0);
            let at = top + turn(angle) * ((reach + 0.06 * own.uniform(1)) * Vec3::Z);
            let drinks = [palette.wine, palette.rum, palette.beer, palette.lemon];
            let kind = [
                Glass::Wine,
                Glass::Tumbler,
                Glass::Highball,
                Glass::Cocktail,
            ][(own.uniform(2) * 4.0) as usize % 4];
            let drink = match own.uniform(3) {
                chance if chance < 0.22 => self.mug(),
                _ => self.drink(kind, pick(&drinks, own.uniform(4))),
            };
            room.place(&drink, turn(3.0 * angle), at);
        }
        if key.uniform(12) < 0.6 {
            let at = top + turn(begin + 0.7) * (0.5 * reach * Vec3::Z);
            room.add(palette.china, &self.saucer(), at);
        }
    }

    fn saucer(&self) -> Mesh {
        turned(
            &[
                [0.0, 0.0],
                [0.04, 0.0],
                [0.04, 0.0],
                [0.045, 0.006],
                [0.068, 0.02],
                [0.066, 0.021],
                [0.042, 0.009],
                [0.0, 0.006],
            ],
            self.steps(2),
            self.fine(20),
        )
    }

    /// A small vase with three roses.
    fn flowers(&self, key: RandomKey) -> Model {
        let mut model = Model::default();
        let vase = turned(
            &[
                [0.0, 0.0],
                [0.026, 0.0],
                [0.026, 0.0],
                [0.036, 0.03],
                [0.034, 0.06],
                [0.016, 0.095],
                [0.021, 0.12],
                [0.018, 0.12],
                [0.012, 0.096],
                [0.0, 0.07],
            ],
            self.steps(2),
            self.fine(18),
        );
        model.add(self.palette.china, &vase, Vec3::ZERO);
        for stem in 0..3 {
            let own = key.mix(stem);
            let way = turn(2.1 * stem as f32 + own.uniform(0)) * Vec3::X;
            let head =
                (0.035 + 0.03 * own.uniform(1)) * way + (0.19 + 0.05 * own.uniform(2)) * Vec3::Y;
            let path = smooth(
                &[0.075 * Vec3::Y, 0.008 * way + 0.13 * Vec3::Y, head],
                self.steps(3),
            );
            let stem = tube(&path, 0.002, self.fine(6));
            model.add(self.palette.leaf, &stem, Vec3::ZERO);
            let ball = sphere(0.021, self.fine(14));
            model.add(self.palette.rose, &ball, head + 0.012 * Vec3::Y);
            let sepal = rod(head - 0.012 * Vec3::Y, head, 0.009, self.fine(8));
            model.add(self.palette.leaf, &sepal, Vec3::ZERO);
        }
        model
    }

    /// A brass stick with a candle that nobody has lit yet.
    fn candlestick(&self) -> Model {
        let mut model = Model::default();
        let stick = turned(
            &[
                [0.0, 0.0],
                [0.045, 0.0],
                [0.045, 0.0],
                [0.047, 0.006],
                [0.03, 0.012],
                [0.009, 0.03],
                [0.008, 0.07],
                [0.016, 0.085],
                [0.009, 0.098],
                [0.02, 0.112],
                [0.02, 0.118],
                [0.0, 0.118],
            ],
            self.steps(2),
            self.fine(18),
        );
        model.add(self.palette.brass, &stick, Vec3::ZERO);
        let candle = turned(
            &[
                [0.0105, 0.118],
                [0.0105, 0.205],
                [0.008, 0.209],
                [0.0, 0.207],
            ],
            1,
            self.fine(16),
        );
        model.add(self.palette.china, &candle, Vec3::ZERO);
        let wick = rod(0.206 * Vec3::Y, 0.217 * Vec3::Y, 0.001, 6);
        model.add(self.palette.iron, &wick, Vec3::ZERO);
        model
    }
}
