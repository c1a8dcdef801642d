//! The seventy spots, and the lamps that they shine from. No light touches its lamp, and no
//! lamp encloses its light.

use glam::{Quat, Vec2, Vec3};

use super::{
    HALF, HEIGHT, Site,
    decor::{PALM, PIANO, hangings},
    model::Model,
    room::walls,
    tables::{BENCH, HIGH, LOW, ROUND},
};
use crate::{
    Light, LightKind,
    generate::{
        shapes::{lathe, rod, torus},
        sweep::{profile, turned},
    },
};

/// Colours relative to white, at equal luminance or so.
const WARM: Vec3 = Vec3::new(1.22, 0.95, 0.63);
const AMBER: Vec3 = Vec3::new(1.38, 0.89, 0.42);
const NEUTRAL: Vec3 = Vec3::new(1.1, 0.98, 0.84);

/// Distance from a light to the lamp behind it.
const CLEARANCE: f32 = 0.025;

/// A cone of light, at half angles from its axis.
#[derive(Clone, Copy)]
struct Cone {
    inner_degrees: f32,
    outer_degrees: f32,
}

const fn cone(inner_degrees: f32, outer_degrees: f32) -> Cone {
    Cone {
        inner_degrees,
        outer_degrees,
    }
}

impl Site {
    pub(super) fn add_lamps(&mut self) {
        self.add_pendants();
        self.add_shelf_spots();
        self.add_sconces();
        self.add_picture_spots();
        self.add_floods();
        self.add_accents();
    }

    fn spot(
        &mut self,
        name: String,
        position: Vec3,
        direction: Vec3,
        radiant_intensity: Vec3,
        cone: Cone,
    ) {
        self.draft.lights.push(Light {
            name,
            kind: LightKind::Spot {
                position,
                direction: direction.normalize_or(Vec3::NEG_Y),
                radiant_intensity,
                cos_inner: cone.inner_degrees.to_radians().cos(),
                cos_outer: cone.outer_degrees.to_radians().cos(),
            },
        });
    }

    /// Over the counter, over every table.
    fn add_pendants(&mut self) {
        let mut lamps = Model::default();
        let over_counter = (0..7).map(|index| {
            let at = Vec3::new(-4.8 + 1.1 * index as f32, 2.02, -2.12);
            ("counter pendant", at, 4.6 * AMBER, cone(17.0, 80.0))
        });
        let over = |name, feet: Vec<Vec3>, height: f32, intensity: f32, cone: Cone| {
            feet.into_iter()
                .map(move |foot| (name, foot.with_y(height), intensity * WARM, cone))
        };
        let all: Vec<_> = over_counter
            .chain(over(
                "table pendant",
                ROUND.to_vec(),
                1.92,
                5.2,
                cone(17.0, 80.0),
            ))
            .chain(over(
                "bench pendant",
                BENCH.to_vec(),
                1.82,
                3.9,
                cone(17.0, 80.0),
            ))
            .chain(over(
                "high table pendant",
                HIGH.to_vec(),
                2.0,
                4.2,
                cone(17.0, 80.0),
            ))
            .collect();
        let pendant = self.pendant();
        for (index, (name, at, intensity, cone)) in all.into_iter().enumerate() {
            lamps.place(&pendant, Quat::IDENTITY, at);
            let cable = rod(at + 0.15 * Vec3::Y, at.with_y(HEIGHT), 0.004, self.fine(6));
            lamps.add(self.palette.iron, &cable, Vec3::ZERO);
            let rose = rod(
                at.with_y(HEIGHT - 0.02),
                at.with_y(HEIGHT),
                0.045,
                self.fine(14),
            );
            lamps.add(self.palette.brass, &rose, Vec3::ZERO);
            self.spot(format!("{name} {index}"), at, Vec3::NEG_Y, intensity, cone);
        }
        self.put("pendants", lamps);
    }

    /// A flat enamelled dome over its light, and in its mouth a ring of opal glass that catches
    /// the rim of the cone.
    fn pendant(&self) -> Model {
        let mut model = Model::default();
        let segments = self.fine(24);
        let outside = profile(
            &[
                [0.165, -0.012],
                [0.158, 0.012],
                [0.12, 0.05],
                [0.06, 0.085],
                [0.028, 0.10],
            ],
            self.steps(1),
        );
        model.add(self.palette.enamel, &lathe(&outside, segments), Vec3::ZERO);
        let inside: Vec<Vec2> = outside
            .iter()
            .rev()
            .map(|point| Vec2::new(point.x - 0.003, point.y - 0.003))
            .collect();
        model.add(self.palette.opal, &lathe(&inside, segments), Vec3::ZERO);
        let rim = torus(0.1635, 0.003, [segments, self.fine(4)]);
        model.add(self.palette.brass, &rim, -0.0135 * Vec3::Y);
        let neck = turned(
            &[[0.03, 0.096], [0.026, 0.13], [0.012, 0.15], [0.006, 0.17]],
            self.steps(2),
            self.fine(12),
        );
        model.add(self.palette.brass, &neck, Vec3::ZERO);
        model.place(&self.opal_ring(), Quat::IDENTITY, Vec3::ZERO);
        model
    }

    /// A ring about a light that shines down from the origin.
    fn opal_ring(&self) -> Model {
        let mut model = Model::default();
        let ring = torus(0.150, 0.0105, [self.fine(22), self.fine(5)]);
        model.add(self.palette.opal, &ring, -0.020 * Vec3::Y);
        model
    }

    /// Small spots under the ceiling that shine on the bottles.
    fn add_shelf_spots(&mut self) {
        let mut lamps = Model::default();
        let z = -3.32;
        let rail = rod(
            Vec3::new(-5.1, 3.2, z),
            Vec3::new(1.9, 3.2, z),
            0.012,
            self.fine(10),
        );
        lamps.add(self.palette.iron, &rail, Vec3::ZERO);
        for x in [-4.9, -3.0, -0.2, 1.7] {
            let hanger = rod(Vec3::new(x, 3.2, z), Vec3::new(x, HEIGHT, z), 0.006, 6);
            lamps.add(self.palette.iron, &hanger, Vec3::ZERO);
        }
        for index in 0..7 {
            let x = -4.68 + 1.03 * index as f32;
            let at = Vec3::new(x, 3.06, z - 0.05);
            let target = Vec3::new(x, 1.52, -4.36);
            self.add_housed_spot(
                &mut lamps,
                format!("shelf spot {index}"),
                [at, target, Vec3::new(x, 3.2, z)],
                10.5 * NEUTRAL,
                cone(14.0, 68.0),
            );
        }
        self.put("shelf spots", lamps);
    }

    /// A spot before a small cylinder that `stem` holds; `places` are the light's, its
    /// target's and the stem's.
    fn add_housed_spot(
        &mut self,
        lamps: &mut Model,
        name: String,
        places: [Vec3; 3],
        intensity: Vec3,
        cone: Cone,
    ) {
        let [at, target, stem] = places;
        let direction = (target - at).normalize_or(Vec3::NEG_Y);
        let mouth = at - CLEARANCE * direction;
        let housing = rod(mouth, mouth - 0.11 * direction, 0.034, self.fine(18));
        lamps.add(self.palette.iron, &housing, Vec3::ZERO);
        let arm = rod(mouth - 0.06 * direction, stem, 0.007, self.fine(6));
        lamps.add(self.palette.iron, &arm, Vec3::ZERO);
        self.spot(name, at, direction, intensity, cone);
    }

    /// Lamps on the walls that shine up and down.
    fn add_sconces(&mut self) {
        let mut lamps = Model::default();
        let [(north, _), (south, _), (west, _), (east, _)] = walls();
        let between = |a: usize| 7.0 - 0.5 * (BENCH[a].x + BENCH[a + 1].x);
        let places = [
            (south, between(0)),
            (south, between(1)),
            (south, between(2)),
            (south, between(3)),
            (south, 2.2),
            (west, 1.3),
            (west, 6.9),
            (east, 4.15),
            (east, 8.05),
            (north, 11.55),
        ];
        for (index, (front, x)) in places.into_iter().enumerate() {
            const OUT: f32 = 0.13;
            let at = front.at(x, 1.92, OUT);
            let brass = self.palette.brass;
            let body = turned(
                &[
                    [0.0, -0.11],
                    [0.044, -0.11],
                    [0.044, -0.11],
                    [0.05, -0.08],
                    [0.038, 0.0],
                    [0.05, 0.08],
                    [0.044, 0.11],
                    [0.044, 0.11],
                    [0.0, 0.11],
                ],
                self.steps(2),
                self.fine(20),
            );
            lamps.add(brass, &body, at);
            let arm = rod(front.at(x, 1.92, 0.0), at, 0.012, self.fine(10));
            lamps.add(brass, &arm, Vec3::ZERO);
            let plate = rod(
                front.at(x, 1.92, 0.0),
                front.at(x, 1.92, 0.014),
                0.06,
                self.fine(20),
            );
            lamps.add(brass, &plate, Vec3::ZERO);
            for (way, sign, lean, strength) in [("down", -1.0, -0.3, 3.4), ("up", 1.0, 0.1, 6.5)] {
                let light = at + sign * (0.11 + CLEARANCE) * Vec3::Y;
                let direction = sign * Vec3::Y + lean * front.right.cross(front.up);
                let name = format!("sconce {index} {way}");
                self.spot(name, light, direction, strength * AMBER, cone(26.0, 80.0));
            }
        }
        self.put("sconces", lamps);
    }

    fn add_picture_spots(&mut self) {
        let mut lamps = Model::default();
        for (number, hanging) in hangings().into_iter().enumerate() {
            let at = hanging.center.with_y(3.16) + 0.95 * hanging.normal;
            let wide = (0.56 * hanging.size.length() / (at - hanging.center).length())
                .atan()
                .to_degrees();
            self.add_housed_spot(
                &mut lamps,
                format!("picture spot {number}"),
                [
                    at,
                    hanging.center,
                    at.with_y(HEIGHT) - 0.02 * hanging.normal,
                ],
                10.0 * NEUTRAL,
                cone(0.6 * wide, wide + 36.0),
            );
        }
        self.put("picture spots", lamps);
    }

    /// Spots on the counter's front, wide ones that fill the shadows, and some on top of the shelves that light the ceiling.
    fn add_floods(&mut self) {
        let mut lamps = Model::default();
        for index in 0..5 {
            let x = -4.6 + 1.7 * index as f32;
            let at = Vec3::new(x, 3.12, -0.75);
            let target = Vec3::new(x, 1.25, -2.5);
            let places = [at, target, at.with_y(HEIGHT)];
            let name = format!("counter spot {index}");
            self.add_housed_spot(&mut lamps, name, places, 7.0 * WARM, cone(13.0, 70.0));
        }
        for (name, at, target, intensity, cone) in [
            (
                "west flood",
                [-6.5, 3.1, -3.1],
                [1.2, 0.4, 1.0],
                12.0,
                cone(12.0, 66.0),
            ),
            (
                "east flood",
                [6.5, 3.1, 4.0],
                [-1.2, 0.4, -1.0],
                12.0,
                cone(12.0, 66.0),
            ),
            (
                "bench flood",
                [-1.6, 3.12, 1.0],
                [-1.6, 0.9, 4.2],
                6.0,
                cone(20.0, 74.0),
            ),
            (
                "corner flood",
                [4.4, 3.12, -0.5],
                [5.3, 0.9, -3.6],
                8.0,
                cone(18.0, 74.0),
            ),
        ] {
            let at = Vec3::from(at);
            let places = [at, Vec3::from(target), at.with_y(HEIGHT)];
            self.add_housed_spot(&mut lamps, name.into(), places, intensity * WARM, cone);
        }
        for index in 0..4 {
            let at = Vec3::new(-4.7 + 2.05 * index as f32, 2.74, -HALF[1] + 0.2);
            let target = at + Vec3::new(0.0, 1.0, 0.55);
            let places = [at, target, at - 0.06 * Vec3::Y];
            let name = format!("cornice light {index}");
            self.add_housed_spot(&mut lamps, name, places, 4.2 * WARM, cone(28.0, 78.0));
        }
        self.put("floods", lamps);
    }

    /// On the piano, over the door, among the armchairs, up through the palm.
    fn add_accents(&mut self) {
        let mut lamps = Model::default();
        let keys = PIANO + Vec3::new(0.5, 0.75, 0.0);
        let door = Vec3::new(HALF[0] - 1.2, 0.1, 1.6);
        let palm = PALM + Vec3::new(-0.15, 1.6, 0.12);
        for (name, at, target, stem, intensity, cone) in [
            (
                "piano spot",
                PIANO + Vec3::new(1.5, 2.75, 0.0),
                keys,
                PIANO + Vec3::new(1.5, HEIGHT, 0.0),
                13.0 * WARM,
                cone(12.0, 50.0),
            ),
            (
                "door spot",
                Vec3::new(HALF[0] - 0.55, 3.0, 1.6),
                door,
                Vec3::new(HALF[0] - 0.5, HEIGHT, 1.6),
                13.0 * WARM,
                cone(16.0, 56.0),
            ),
            (
                "armchair spot",
                LOW + Vec3::new(-0.3, 3.0, -0.2),
                LOW,
                LOW + Vec3::new(-0.3, HEIGHT, -0.2),
                16.0 * WARM,
                cone(14.0, 52.0),
            ),
            (
                "palm spot",
                PALM + Vec3::new(-0.42, 0.16, 0.42),
                palm,
                PALM + Vec3::new(-0.45, 0.0, 0.45),
                9.0 * WARM,
                cone(20.0, 56.0),
            ),
        ] {
            let places = [at, target, stem];
            self.add_housed_spot(&mut lamps, name.into(), places, intensity, cone);
        }
        self.put("accent spots", lamps);
    }
}
