//! The counter, what stands on it, the rack of glasses above, the stools before it.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

use super::{
    HALF, HEIGHT, Site,
    joinery::{Front, Panelling},
    model::Model,
    turn,
    vessels::Glass,
};
use crate::generate::{
    mesh::Mesh,
    shapes::{lathe, parametric, rod, sphere, torus},
    sweep::{smooth, tube, turned},
};

/// Ends of the long side.
const SPAN: [f32; 2] = [-5.3, 2.6];
/// The body, from the staff's side to the guests'.
const DEPTH: [f32; 2] = [-2.82, -2.3];
/// Inner side of the short side, which closes the bar towards the door.
const RETURN: f32 = 2.08;
const TOP: f32 = 1.1;
const SLAB: f32 = 0.05;
/// How far the top reaches beyond the guests' front.
const NOSE: f32 = 0.24;
/// Where the stools stand.
const STOOLS_Z: f32 = -1.68;

impl Site {
    pub(super) fn add_counter(&mut self) {
        self.add_counter_body();
        self.add_counter_top();
        self.add_foot_rail();
        self.add_counter_things();
        self.add_rack();
        self.add_stools();
    }

    fn add_counter_body(&mut self) {
        let under = TOP - SLAB;
        let length = SPAN[1] - SPAN[0];
        let mut wood = Mesh::default();
        let mut plinth = Mesh::default();
        let long = Front::upright(Vec3::new(SPAN[0], 0.0, DEPTH[1]), Vec3::X);
        let short = Front::upright(Vec3::new(SPAN[1], 0.0, DEPTH[1]), Vec3::NEG_Z);
        let end = Front::upright(Vec3::new(SPAN[0], 0.0, DEPTH[0]), Vec3::Z);
        let deep = DEPTH[1] - DEPTH[0];
        for (front, width, columns) in [
            (long, length, 10),
            (short, HALF[1] + DEPTH[1], 3),
            (end, deep, 1),
        ] {
            let panelling = Panelling {
                span: [0.0, width],
                rise: [0.14, under],
                columns,
                rail: 0.1,
            };
            front.panel(&mut wood, &panelling);
            front.board(&mut plinth, [0.0, width], [0.0, 0.14], [-0.01, 0.012]);
            front.board(
                &mut plinth,
                [0.0, width],
                [under - 0.05, under],
                [0.0, 0.06],
            );
        }
        // Pilasters part the long front into five.
        for index in 0..6 {
            let x = 0.05 + index as f32 * (length - 0.1) / 5.0;
            let sides = [x - 0.05, x + 0.05];
            long.board(&mut wood, sides, [0.14, under - 0.05], [0.0, 0.05]);
        }
        wood.cuboid(
            Vec3::new(SPAN[0] + 0.001, 0.0, DEPTH[0]),
            Vec3::new(SPAN[1] - 0.001, under, DEPTH[1] - 0.001),
        );
        wood.cuboid(
            Vec3::new(RETURN, 0.0, -HALF[1]),
            Vec3::new(SPAN[1] - 0.002, under - 0.001, DEPTH[0] + 0.01),
        );
        self.part("counter", self.palette.walnut, wood);
        self.part("counter trim", self.palette.ebony, plinth);
    }

    /// A slab with a round nose towards the guests.
    fn add_counter_top(&mut self) {
        let mut slab = Mesh::default();
        let front = Front::upright(Vec3::new(SPAN[0], 0.0, DEPTH[1]), Vec3::X);
        let length = SPAN[1] - SPAN[0];
        let thick = [TOP - SLAB, TOP];
        let back = DEPTH[0] - DEPTH[1] - 0.03;
        front.board(&mut slab, [-0.06, length + NOSE], thick, [back, NOSE]);
        let side = Front::upright(Vec3::new(RETURN - 0.03, 0.0, -HALF[1]), Vec3::X);
        let reach = DEPTH[0] - 0.03 + HALF[1];
        let width = SPAN[1] - RETURN + 0.03 + NOSE;
        side.board(&mut slab, [0.0, width], thick, [0.0, reach]);
        let radius = 0.5 * SLAB;
        let nose = parametric([1, self.fine(12)], |u, v| {
            let (sin, cos) = ((v - 0.5) * std::f32::consts::PI).sin_cos();
            front.at(
                u * (length + NOSE + 0.06) - 0.06,
                TOP - radius + radius * sin,
                NOSE + radius * cos,
            )
        });
        slab.add(&nose, Quat::IDENTITY, Vec3::ZERO);
        self.part("counter top", self.palette.mahogany, slab);
    }

    fn add_foot_rail(&mut self) {
        let z = DEPTH[1] + 0.22;
        let mut brass = Mesh::default();
        let (from, to) = (SPAN[0] + 0.05, SPAN[1] + 0.1);
        let rail = rod(
            Vec3::new(from, 0.2, z),
            Vec3::new(to, 0.2, z),
            0.026,
            self.fine(20),
        );
        brass.add(&rail, Quat::IDENTITY, Vec3::ZERO);
        for x in [from, to] {
            let end = sphere(0.038, self.fine(20));
            brass.add(&end, Quat::IDENTITY, Vec3::new(x, 0.2, z));
        }
        for index in 0..7 {
            let x = from + 0.25 + index as f32 * (to - from - 0.6) / 6.0;
            let bracket = smooth(
                &[
                    Vec3::new(x, 0.11, DEPTH[1]),
                    Vec3::new(x, 0.11, z - 0.06),
                    Vec3::new(x, 0.19, z),
                ],
                self.steps(4),
            );
            let bracket = tube(&bracket, 0.013, self.fine(10));
            brass.add(&bracket, Quat::IDENTITY, Vec3::ZERO);
        }
        self.part("foot rail", self.palette.brass, brass);
    }

    fn add_counter_things(&mut self) {
        let mut things = Model::default();
        let middle = 0.5 * (DEPTH[0] + DEPTH[1]);
        let at = |x: f32, out: f32| Vec3::new(x, TOP, middle + out);
        things.place(&self.tap(), Quat::IDENTITY, at(-1.35, -0.05));
        for (x, out) in [(-4.3, 0.05), (0.75, -0.02)] {
            things.place(&self.bowl_of_lemons(), turn(x), at(x, out));
        }
        let palette = &self.palette;
        let drinks = [
            (-4.72, 0.30, self.drink(Glass::Cocktail, palette.rum)),
            (-3.62, 0.31, self.mug()),
            (-3.45, 0.22, self.mug()),
            (-2.66, 0.32, self.drink(Glass::Wine, palette.wine)),
            (-1.72, 0.29, self.mug()),
            (-0.58, 0.30, self.drink(Glass::Cocktail, palette.lemon)),
            (-0.40, 0.24, self.drink(Glass::Tumbler, palette.rum)),
            (0.36, 0.33, self.drink(Glass::Wine, palette.wine)),
            (1.42, 0.30, self.drink(Glass::Highball, palette.beer)),
            (1.62, 0.26, self.drink(Glass::Cocktail, palette.rose)),
            (1.95, 0.05, self.drink(Glass::Tumbler, palette.rum)),
        ];
        let mat = [
            Vec2::new(0.05, 0.0),
            Vec2::new(0.05, 0.003),
            Vec2::new(0.0, 0.003),
        ];
        let mat = lathe(&mat, self.fine(24));
        for (index, (x, out, drink)) in drinks.into_iter().enumerate() {
            things.add(palette.labels[index % 2], &mat, at(x, out));
            things.place(&drink, turn(2.4 * x), at(x, out) + 0.0035 * Vec3::Y);
        }
        for (index, x) in [-3.05f32, -2.92, -2.78, 1.05, 1.18, 1.3]
            .into_iter()
            .enumerate()
        {
            let bottle = self.bottle(self.key.mix(30).mix(index as u64));
            things.place(&bottle, turn(x), at(x, -0.1 - 0.05 * (index % 2) as f32));
        }
        for (x, out) in [(-2.1, -0.12), (-1.98, -0.05), (0.1, -0.1)] {
            things.add(palette.steel, &self.shaker(), at(x, out));
        }
        // Tumblers upside down, in a pyramid.
        let tumbler = self.glass(Glass::Tumbler);
        for (level, count) in [(0u8, 4u8), (1, 3), (2, 2)] {
            for place in 0..count {
                let x = -0.02 + 0.086 * (f32::from(place) - 0.5 * f32::from(count));
                let foot = at(x - 3.9, -0.12) + (0.093 * f32::from(level + 1)) * Vec3::Y;
                let over = Quat::from_rotation_x(std::f32::consts::PI);
                things.of(palette.glass).add(&tumbler, over, foot);
            }
        }
        self.put("counter things", things);
    }

    /// A brass column with three taps.
    fn tap(&self) -> Model {
        let mut model = Model::default();
        let column = turned(
            &[
                [0.0, 0.0],
                [0.075, 0.0],
                [0.075, 0.0],
                [0.078, 0.018],
                [0.045, 0.04],
                [0.036, 0.10],
                [0.036, 0.30],
                [0.055, 0.325],
                [0.058, 0.36],
                [0.035, 0.40],
                [0.0, 0.42],
            ],
            self.steps(3),
            self.fine(28),
        );
        model.add(self.palette.brass, &column, Vec3::ZERO);
        let bar = rod(
            Vec3::new(-0.2, 0.315, 0.0),
            Vec3::new(0.2, 0.315, 0.0),
            0.028,
            self.fine(20),
        );
        model.add(self.palette.brass, &bar, Vec3::ZERO);
        for (index, x) in [-0.17f32, 0.0, 0.17].into_iter().enumerate() {
            let spout = smooth(
                &[
                    Vec3::new(x, 0.315, -0.02),
                    Vec3::new(x, 0.315, -0.09),
                    Vec3::new(x, 0.285, -0.13),
                    Vec3::new(x, 0.215, -0.13),
                ],
                self.steps(4),
            );
            let spout = tube(&spout, 0.011, self.fine(12));
            model.add(self.palette.brass, &spout, Vec3::ZERO);
            let handle = turned(
                &[
                    [0.0, 0.0],
                    [0.008, 0.0],
                    [0.008, 0.03],
                    [0.014, 0.06],
                    [0.019, 0.13],
                    [0.013, 0.17],
                    [0.0, 0.178],
                ],
                self.steps(2),
                self.fine(14),
            );
            let colors = [
                self.palette.oxblood,
                self.palette.china,
                self.palette.enamel,
            ];
            let lean = Quat::from_rotation_x(-0.25);
            let foot = Vec3::new(x, if x == 0.0 { 0.41 } else { 0.335 }, -0.015);
            model.of(colors[index]).add(&handle, lean, foot);
        }
        model
    }

    fn bowl_of_lemons(&self) -> Model {
        let mut model = Model::default();
        let bowl = turned(
            &[
                [0.0, 0.0],
                [0.055, 0.0],
                [0.055, 0.0],
                [0.055, 0.012],
                [0.10, 0.04],
                [0.135, 0.085],
                [0.131, 0.086],
                [0.095, 0.045],
                [0.0, 0.025],
            ],
            self.steps(3),
            self.fine(36),
        );
        model.add(self.palette.china, &bowl, Vec3::ZERO);
        let lemon = turned(
            &[
                [0.0, -0.042],
                [0.008, -0.038],
                [0.026, -0.022],
                [0.0315, 0.0],
                [0.026, 0.022],
                [0.008, 0.038],
                [0.0, 0.042],
            ],
            self.steps(2),
            self.fine(10),
        );
        for index in 0..7 {
            let (ring, up) = if index < 5 {
                (0.062, 0.072)
            } else {
                (0.02, 0.112)
            };
            let angle = index as f32 * 2.513 + if index == 6 { 0.65 } else { 0.0 };
            let (sin, cos) = angle.sin_cos();
            let lie = Quat::from_rotation_y(1.7 * index as f32) * Quat::from_rotation_x(1.35);
            let at = Vec3::new(ring * cos, up, ring * sin);
            model.of(self.palette.lemon).add(&lemon, lie, at);
        }
        model
    }

    fn shaker(&self) -> Mesh {
        turned(
            &[
                [0.0, 0.0],
                [0.036, 0.0],
                [0.036, 0.0],
                [0.043, 0.05],
                [0.046, 0.14],
                [0.046, 0.14],
                [0.044, 0.143],
                [0.038, 0.17],
                [0.021, 0.19],
                [0.021, 0.19],
                [0.021, 0.215],
                [0.012, 0.226],
                [0.0, 0.228],
            ],
            self.steps(2),
            self.fine(26),
        )
    }

    /// Two wooden trays under the ceiling, wine glasses hanging from them by the foot.
    fn add_rack(&mut self) {
        let mut rack = Model::default();
        let (z, under) = (-2.66, 2.2);
        for (tray, (from, to)) in [(-4.4, -1.95), (-0.75, 1.7)].into_iter().enumerate() {
            let front = Front::upright(Vec3::new(0.0, 0.0, z), Vec3::X);
            let wood = rack.of(self.palette.mahogany);
            front.board(wood, [from, to], [under + 0.03, under + 0.07], [-0.2, 0.2]);
            for out in [-0.19, 0.19] {
                let sides = [out - 0.012, out + 0.012];
                front.board(
                    wood,
                    [from - 0.01, to + 0.01],
                    [under + 0.02, under + 0.10],
                    sides,
                );
            }
            for x in [from + 0.2, to - 0.2] {
                let hanger = rod(
                    Vec3::new(x, under + 0.06, z),
                    Vec3::new(x, HEIGHT, z),
                    0.009,
                    self.fine(8),
                );
                rack.add(self.palette.brass, &hanger, Vec3::ZERO);
            }
            let glass = self.glass(Glass::Wine);
            let over = Quat::from_rotation_x(std::f32::consts::PI);
            for (row, out) in [-0.1, 0.1].into_iter().enumerate() {
                let key = self.key.mix(31).mix(2 * tray as u64 + row as u64);
                // Rails on both sides of the stems carry the feet.
                for side in [-0.017, 0.017] {
                    let rail = rod(
                        Vec3::new(from, under - 0.012, z + out + side),
                        Vec3::new(to, under - 0.012, z + out + side),
                        0.004,
                        self.fine(6),
                    );
                    rack.add(self.palette.brass, &rail, Vec3::ZERO);
                }
                let count = 15;
                for index in 0..count {
                    if key.uniform(index) < 0.12 {
                        continue;
                    }
                    let x = from + 0.09 + index as f32 * (to - from - 0.18) / (count - 1) as f32;
                    let at = Vec3::new(x, under, z + out);
                    rack.of(self.palette.glass).add(&glass, over, at);
                }
                let ends = [from, to].map(|x| Vec3::new(x, under + 0.03, z + out));
                for end in ends {
                    let tie = rod(end - 0.045 * Vec3::Y, end, 0.005, 6);
                    rack.add(self.palette.brass, &tie, Vec3::ZERO);
                }
            }
        }
        self.put("glass rack", rack);
    }

    fn add_stools(&mut self) {
        let mut stools = Model::default();
        let stool = self.stool();
        for index in 0..7 {
            let own = self.key.mix(32).mix(index);
            let x = -4.6 + 1.02 * index as f32 + 0.08 * (own.uniform(0) - 0.5);
            let at = Vec3::new(x, 0.0, STOOLS_Z + 0.06 * own.uniform(1));
            stools.place(&stool, turn(TAU * own.uniform(2)), at);
        }
        self.put("stools", stools);
    }

    /// A padded seat on a brass column with a ring for the feet.
    pub(super) fn stool(&self) -> Model {
        let mut model = Model::default();
        let column = turned(
            &[
                [0.0, 0.0],
                [0.20, 0.0],
                [0.20, 0.0],
                [0.205, 0.012],
                [0.16, 0.028],
                [0.05, 0.05],
                [0.03, 0.09],
                [0.027, 0.4],
                [0.027, 0.66],
                [0.06, 0.70],
                [0.15, 0.715],
            ],
            self.steps(1),
            self.fine(22),
        );
        model.add(self.palette.brass, &column, Vec3::ZERO);
        let ring = torus(0.17, 0.011, [self.fine(24), self.fine(6)]);
        model.add(self.palette.brass, &ring, 0.29 * Vec3::Y);
        for spoke in 0..3 {
            let way = turn(spoke as f32 * TAU / 3.0) * Vec3::X;
            let spoke = rod(0.02 * way, 0.17 * way, 0.008, self.fine(6));
            model.add(self.palette.brass, &spoke, 0.29 * Vec3::Y);
        }
        let seat = turned(
            &[
                [0.0, 0.712],
                [0.165, 0.712],
                [0.165, 0.712],
                [0.188, 0.725],
                [0.195, 0.752],
                [0.182, 0.782],
                [0.12, 0.795],
                [0.0, 0.798],
            ],
            self.steps(2),
            self.fine(24),
        );
        model.add(self.palette.oxblood, &seat, Vec3::ZERO);
        let band = torus(0.188, 0.007, [self.fine(24), self.fine(4)]);
        model.add(self.palette.brass, &band, 0.72 * Vec3::Y);
        model
    }
}
