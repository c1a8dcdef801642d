//! The wall with the bottles: cupboards, shelves, a cornice, and what stands on them.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

use super::{
    HALF, Site,
    joinery::{Front, Panelling},
    model::Model,
    turn,
    vessels::Glass,
};
use crate::generate::{
    mesh::Mesh,
    shapes::{lathe, rod, sphere, torus},
};

/// From where to where along the wall.
const SPAN: [f32; 2] = [-5.2, 2.0];
const BAYS: u32 = 3;
const PILASTER: f32 = 0.16;
/// Tops of the boards that bottles stand on; the first is the cupboards'.
const BOARDS: [f32; 4] = [0.95, 1.33, 1.70, 2.06];
const SHELF_DEPTH: f32 = 0.24;
const TOP: f32 = 2.46;

impl Site {
    pub(super) fn add_back_bar(&mut self) {
        let front = Front::upright(Vec3::new(SPAN[0], 0.0, -HALF[1]), Vec3::X);
        self.add_cupboards(front);
        self.add_shelves(front);
        self.add_stock(front);
        self.add_clock(front);
        self.add_barrels();
    }

    fn add_cupboards(&mut self, front: Front) {
        let width = SPAN[1] - SPAN[0];
        let (depth, top) = (0.46, BOARDS[0]);
        let mut wood = Mesh::default();
        front.board(
            &mut wood,
            [0.0, width],
            [0.09, top - 0.04],
            [0.0, depth - 0.03],
        );
        let face = Front {
            corner: front.at(0.0, 0.0, depth - 0.03),
            ..front
        };
        for bay in 0..BAYS {
            let pitch = width / BAYS as f32;
            let span = [pitch * bay as f32, pitch * (bay + 1) as f32];
            face.panel(
                &mut wood,
                &Panelling {
                    span,
                    rise: [0.09, top - 0.04],
                    columns: 4,
                    rail: 0.07,
                },
            );
        }
        self.part("cupboards", self.palette.walnut, wood);
        let mut plinth = Mesh::default();
        front.board(&mut plinth, [0.0, width], [0.0, 0.09], [0.0, depth - 0.08]);
        self.part("cupboard plinth", self.palette.ebony, plinth);
        let mut slab = Mesh::default();
        front.board(
            &mut slab,
            [-0.02, width + 0.02],
            [top - 0.04, top],
            [0.0, depth + 0.02],
        );
        self.part("cupboard top", self.palette.marble, slab);
        let mut knobs = Mesh::default();
        for index in 0..12 {
            let at = face.at((index as f32 + 0.5) * width / 12.0 + 0.16, 0.55, 0.035);
            knobs.add(&sphere(0.016, self.fine(12)), Quat::IDENTITY, at);
        }
        self.part("cupboard knobs", self.palette.brass, knobs);
    }

    fn add_shelves(&mut self, front: Front) {
        let width = SPAN[1] - SPAN[0];
        let mut wood = Mesh::default();
        let mut back = Mesh::default();
        front.board(&mut back, [0.0, width], [BOARDS[0], TOP], [0.0, 0.012]);
        for (from, to) in bays() {
            for top in &BOARDS[1..] {
                front.board(
                    &mut wood,
                    [from, to],
                    [top - 0.026, *top],
                    [0.012, SHELF_DEPTH],
                );
            }
        }
        let pitch = (width - PILASTER) / BAYS as f32;
        for index in 0..=BAYS {
            let x = pitch * index as f32;
            let sides = [x, x + PILASTER];
            front.board(
                &mut wood,
                sides,
                [BOARDS[0], TOP],
                [0.0, SHELF_DEPTH + 0.03],
            );
            // Flutes stand out as three slim rods.
            for flute in 0..3 {
                let x = x + PILASTER * (0.25 + 0.25 * flute as f32);
                let z = SHELF_DEPTH + 0.03;
                let bar = rod(
                    front.at(x, BOARDS[0] + 0.14, z),
                    front.at(x, TOP - 0.14, z),
                    0.014,
                    self.fine(10),
                );
                wood.add(&bar, Quat::IDENTITY, Vec3::ZERO);
            }
            for y in [[BOARDS[0], BOARDS[0] + 0.1], [TOP - 0.1, TOP]] {
                let wide = [sides[0] - 0.012, sides[1] + 0.012];
                front.board(&mut wood, wide, y, [SHELF_DEPTH, SHELF_DEPTH + 0.055]);
            }
        }
        self.part("shelves", self.palette.walnut, wood);
        self.part("shelf backs", self.palette.ebony, back);
        let mut cornice = Mesh::default();
        for (bottom, top, out) in [
            (TOP, TOP + 0.13, 0.30),
            (TOP + 0.13, TOP + 0.18, 0.34),
            (TOP + 0.18, TOP + 0.22, 0.39),
        ] {
            let over = out - 0.28;
            front.board(
                &mut cornice,
                [-over, width + over],
                [bottom, top],
                [0.0, out],
            );
        }
        self.part("shelf cornice", self.palette.mahogany, cornice);
        let mut rails = Mesh::default();
        for (from, to) in bays() {
            for top in &BOARDS[1..] {
                let rail = rod(
                    front.at(from, top + 0.03, SHELF_DEPTH - 0.012),
                    front.at(to, top + 0.03, SHELF_DEPTH - 0.012),
                    0.004,
                    self.fine(8),
                );
                rails.add(&rail, Quat::IDENTITY, Vec3::ZERO);
            }
        }
        self.part("shelf rails", self.palette.brass, rails);
    }

    /// Bottles in ranks with a gap here and there, and ranks of glasses among them.
    fn add_stock(&mut self, front: Front) {
        let mut stock = Model::default();
        for (bay, (from, to)) in bays().enumerate() {
            for (level, height) in BOARDS.into_iter().enumerate() {
                let key = self.key.mix(20).mix(bay as u64).mix(level as u64);
                let is_glasses = (bay + 2 * level) % 5 == 4;
                let pitch = if is_glasses { 0.108 } else { 0.154 };
                let depth = if level == 0 { 0.27 } else { 0.13 };
                let count = ((to - from - 0.08) / pitch).floor();
                let margin = 0.5 * (to - from - pitch * (count - 1.0));
                for place in 0..count as u32 {
                    let own = key.mix(u64::from(place));
                    let shift = 0.016 * (own.uniform2(8) - Vec2::splat(0.5));
                    let x = from + margin + pitch * place as f32 + shift.x;
                    let at = front.at(x, height, depth + shift.y);
                    if is_glasses {
                        let kind = [Glass::Wine, Glass::Cocktail, Glass::Highball][bay];
                        stock.add(self.palette.glass, &self.glass(kind), at);
                    } else if own.uniform(9) > 0.07 {
                        let about = turn(TAU * own.uniform(10));
                        stock.place(&self.bottle(key.mix(u64::from(place / 2))), about, at);
                    }
                }
            }
        }
        self.put("stock", stock);
    }

    /// A clock over the middle bay, a little after ten.
    fn add_clock(&mut self, front: Front) {
        let center = front.at(0.5 * (SPAN[1] - SPAN[0]), TOP + 0.46, 0.05);
        let facing = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let mut model = Model::default();
        let dial = lathe(&[Vec2::new(0.21, 0.0), Vec2::new(0.0, 0.0)], self.fine(48));
        let case = torus(0.22, 0.028, [self.fine(48), self.fine(14)]);
        let back = lathe(
            &[Vec2::new(0.22, -0.05), Vec2::new(0.22, 0.0)],
            self.fine(48),
        );
        model.add(self.palette.china, &dial, Vec3::ZERO);
        model.add(self.palette.brass, &case, Vec3::ZERO);
        model.add(self.palette.brass, &back, Vec3::ZERO);
        let iron = self.palette.iron;
        for hour in 0..12 {
            let way = turn(hour as f32 * TAU / 12.0) * Vec3::X;
            let mark = rod(0.165 * way, 0.195 * way, 0.005, 6);
            model.add(iron, &mark, 0.004 * Vec3::Y);
        }
        for (length, hours) in [(0.11f32, 10.15f32), (0.165, 1.8)] {
            let angle = hours / 12.0 * TAU;
            let way = Vec3::new(angle.sin(), 0.0, -angle.cos());
            let hand = rod(-0.02 * way, length * way, 0.005, 6);
            model.add(iron, &hand, 0.009 * Vec3::Y);
        }
        let mut placed = Model::default();
        placed.place(&model, facing, center);
        self.put("clock", placed);
    }

    /// Two casks in the corner, and one on top.
    fn add_barrels(&mut self) {
        let mut model = Model::default();
        let barrel = self.barrel();
        for (x, z, angle) in [(-6.45, -3.95, 0.2), (-5.75, -4.08, 1.1)] {
            model.place(&barrel, turn(angle), Vec3::new(x, 0.0, z));
        }
        model.place(&barrel, turn(0.7), Vec3::new(-6.36, 0.9, -4.0));
        self.put("barrels", model);
    }

    fn barrel(&self) -> Model {
        let mut model = Model::default();
        let radius = |y: f32| 0.33 - 0.3 * (y - 0.45).powi(2);
        let levels: Vec<f32> = (0..=12).map(|level| 0.9 * level as f32 / 12.0).collect();
        let mut profile: Vec<Vec2> = levels.iter().map(|&y| Vec2::new(radius(y), y)).collect();
        profile.push(Vec2::new(radius(0.9) - 0.03, 0.9));
        profile.push(Vec2::new(radius(0.9) - 0.035, 0.87));
        profile.push(Vec2::new(0.0, 0.87));
        let mut body = lathe(&profile, self.fine(30));
        // Staves run up: the grain's texture is in metres, u along them.
        for vertex in &mut body.vertices {
            vertex.uv = Vec2::new(vertex.uv.y, 2.0 * vertex.uv.x);
        }
        model.add(self.palette.oak, &body, Vec3::ZERO);
        for (low, high) in [
            (0.0, 0.05),
            (0.13, 0.17),
            (0.28, 0.32),
            (0.58, 0.62),
            (0.73, 0.77),
            (0.85, 0.9),
        ] {
            let hoop = lathe(
                &[
                    Vec2::new(radius(low), low),
                    Vec2::new(radius(low) + 0.004, low),
                    Vec2::new(radius(high) + 0.004, high),
                    Vec2::new(radius(high), high),
                ],
                self.fine(30),
            );
            model.add(self.palette.iron, &hoop, Vec3::ZERO);
        }
        model
    }
}

/// From where to where each bay is, between its pilasters.
fn bays() -> impl Iterator<Item = (f32, f32)> {
    let pitch = (SPAN[1] - SPAN[0] - PILASTER) / BAYS as f32;
    (0..BAYS).map(move |bay| {
        let left = pitch * bay as f32 + PILASTER;
        (left, left + pitch - PILASTER)
    })
}
