//! Pictures, the piano, fans under the ceiling, a palm.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec2, Vec3};

use super::{
    FANS, HEIGHT, Site,
    joinery::{Front, Panelling},
    model::Model,
    palette::poster,
    room::walls,
    turn,
};
use crate::{
    Material, TextureRef,
    generate::{
        bitmaps::add_texture,
        frame::frame,
        mesh::Mesh,
        shapes::{lathe, parametric, rod},
        sweep::{smooth, tube, turned},
    },
};

/// Foot of the palm.
pub(super) const PALM: Vec3 = Vec3::new(6.35, 0.0, -3.8);
/// Middle of the piano, on the floor at the wall.
pub(super) const PIANO: Vec3 = Vec3::new(-7.0, 0.0, 0.75);

/// Where a picture hangs: middle, way out of the wall, width and height.
pub(super) struct Hanging {
    pub(super) center: Vec3,
    pub(super) normal: Vec3,
    pub(super) size: Vec2,
}

/// All pictures, those over the bench first.
pub(super) fn hangings() -> [Hanging; 8] {
    let [_, (south, _), (west, _), _] = walls();
    let on = |front: Front, x: f32, y: f32, size: [f32; 2]| Hanging {
        center: front.at(x, y, 0.0),
        normal: front.right.cross(front.up),
        size: Vec2::from(size),
    };
    let [(north, _), ..] = walls();
    let tables = super::tables::BENCH.map(|foot| 7.0 - foot.x);
    [
        on(south, tables[0], 1.98, [0.72, 0.96]),
        on(south, tables[1], 1.98, [0.72, 0.96]),
        on(south, tables[2], 1.98, [0.9, 1.16]),
        on(south, tables[3], 1.98, [0.72, 0.96]),
        on(south, tables[4], 1.98, [0.72, 0.96]),
        on(west, 3.75, 2.04, [0.8, 1.06]),
        on(north, 10.75, 1.95, [0.72, 0.96]),
        on(north, 12.35, 1.95, [0.72, 0.96]),
    ]
}

impl Site {
    pub(super) fn add_decor(&mut self) {
        for (number, hanging) in hangings().into_iter().enumerate() {
            self.add_picture(number, &hanging);
        }
        self.add_piano();
        self.add_fans();
        self.add_palm();
    }

    fn add_picture(&mut self, number: usize, hanging: &Hanging) {
        let Hanging {
            center,
            normal,
            size,
        } = *hanging;
        let side = Vec3::Y.cross(normal);
        let texture = add_texture(&mut self.draft, poster(self.key.mix(60).mix(number as u64)));
        let material = self.draft.add_material(Material {
            base_color_texture: Some(TextureRef::plain(texture)),
            ..Material::diffuse(format!("poster {number}"), Vec3::ONE)
        });
        let (right, up) = (size.x * side, size.y * Vec3::Y);
        let mut canvas = Mesh::default();
        let lower_left = center + 0.03 * normal - 0.5 * right - 0.5 * up;
        canvas.textured_quad(lower_left, right, up, Vec2::ONE);
        // The image's first row is on top.
        for vertex in &mut canvas.vertices {
            vertex.uv.y = 1.0 - vertex.uv.y;
        }
        self.part(format!("poster {number}"), material, canvas);
        let bars = frame(center, [side, Vec3::Y, normal], 0.5 * size);
        self.part(format!("frame {number}"), self.palette.gilt, bars);
    }

    /// An upright piano with its lid open and a round stool.
    fn add_piano(&mut self) {
        let (half, deep) = (0.74, 0.42);
        let corner = PIANO + half * Vec3::Z + 0.06 * Vec3::X;
        let front = Front::upright(corner, Vec3::NEG_Z);
        let width = 2.0 * half;
        let mut body = Mesh::default();
        front.board(&mut body, [0.0, width], [0.0, 1.22], [0.0, 0.26]);
        front.board(
            &mut body,
            [-0.03, width + 0.03],
            [1.22, 1.25],
            [-0.02, 0.30],
        );
        front.board(
            &mut body,
            [0.0, width],
            [0.60, 0.68],
            [0.26, 0.26 + deep - 0.1],
        );
        front.board(&mut body, [0.05, width - 0.05], [0.76, 0.80], [0.26, 0.30]);
        for x in [[0.0, 0.055], [width - 0.055, width]] {
            front.board(&mut body, x, [0.68, 0.80], [0.26, 0.26 + deep - 0.1]);
            let at = front.at(0.5 * (x[0] + x[1]), 0.0, 0.26 + deep - 0.15);
            let leg = turned(
                &[
                    [0.0, 0.0],
                    [0.028, 0.0],
                    [0.028, 0.02],
                    [0.02, 0.06],
                    [0.035, 0.2],
                    [0.024, 0.42],
                    [0.04, 0.6],
                ],
                self.steps(3),
                self.fine(18),
            );
            body.add(&leg, Quat::IDENTITY, at);
        }
        let upper = Front {
            corner: front.at(0.0, 0.0, 0.26),
            ..front
        };
        for (rise, columns) in [([0.82, 1.20], 3), ([0.05, 0.58], 2)] {
            let panelling = Panelling {
                span: [0.02, width - 0.02],
                rise,
                columns,
                rail: 0.06,
            };
            upper.panel(&mut body, &panelling);
        }
        self.part("piano", self.palette.ebony, body);
        self.add_keys(front, width, 0.26 + deep - 0.11);
        let mut music = Mesh::default();
        let sheet = front.at(0.5 * width - 0.22, 0.80, 0.335);
        music.quad(sheet, 0.44 * front.right, Vec3::new(-0.05, 0.3, 0.0));
        self.part("music", self.palette.labels[0], music);
        self.add_piano_stool();
    }

    /// Fifty-two white keys, as far out of the front as `edge`, and the black ones between.
    fn add_keys(&mut self, front: Front, width: f32, edge: f32) {
        let (mut white, mut black) = (Mesh::default(), Mesh::default());
        let pitch = (width - 0.13) / 52.0;
        for key in 0..52 {
            let x = 0.065 + pitch * key as f32;
            let z = [0.27, edge];
            front.board(
                &mut white,
                [x + 0.0007, x + pitch - 0.0007],
                [0.68, 0.702],
                z,
            );
            // Seven white keys, five black: none after the third and the seventh.
            if ![2, 6].contains(&(key % 7)) && key < 51 {
                let x = x + 0.7 * pitch;
                front.board(&mut black, [x, x + 0.6 * pitch], [0.7, 0.713], [0.27, 0.47]);
            }
        }
        self.part("ivories", self.palette.china, white);
        self.part("ebonies", self.palette.iron, black);
    }

    fn add_piano_stool(&mut self) {
        let mut model = Model::default();
        let seat = turned(
            &[
                [0.0, 0.45],
                [0.16, 0.45],
                [0.16, 0.45],
                [0.175, 0.47],
                [0.16, 0.50],
                [0.0, 0.51],
            ],
            self.steps(2),
            self.fine(32),
        );
        model.add(self.palette.oxblood, &seat, Vec3::ZERO);
        let column = turned(
            &[
                [0.0, 0.0],
                [0.17, 0.0],
                [0.17, 0.0],
                [0.175, 0.015],
                [0.05, 0.06],
                [0.03, 0.2],
                [0.03, 0.38],
                [0.12, 0.45],
            ],
            self.steps(2),
            self.fine(24),
        );
        model.add(self.palette.ebony, &column, Vec3::ZERO);
        let mut placed = Model::default();
        placed.place(&model, Quat::IDENTITY, PIANO + Vec3::new(1.02, 0.0, 0.05));
        self.put("piano stool", placed);
    }

    fn add_fans(&mut self) {
        let mut fans = Model::default();
        for (index, foot) in FANS.into_iter().enumerate() {
            let hub = foot.with_y(HEIGHT - 0.52);
            let stem = rod(hub, foot.with_y(HEIGHT), 0.012, self.fine(12));
            fans.add(self.palette.brass, &stem, Vec3::ZERO);
            let motor = turned(
                &[
                    [0.0, -0.10],
                    [0.05, -0.09],
                    [0.10, -0.04],
                    [0.115, 0.0],
                    [0.09, 0.05],
                    [0.03, 0.07],
                    [0.02, 0.12],
                ],
                self.steps(3),
                self.fine(32),
            );
            fans.add(self.palette.brass, &motor, hub);
            for blade in 0..5 {
                let about = turn(blade as f32 * TAU / 5.0 + 0.4 + 0.6 * index as f32);
                let shape = self.fan_blade();
                fans.of(self.palette.oak).add(&shape, about, hub);
                let arm = rod(
                    Vec3::new(0.09, 0.0, 0.0),
                    Vec3::new(0.26, 0.0, 0.0),
                    0.009,
                    6,
                );
                fans.of(self.palette.brass).add(&arm, about, hub);
            }
        }
        self.put("fans", fans);
    }

    /// A blade along x, closed, a little pitched.
    fn fan_blade(&self) -> Mesh {
        parametric([self.fine(14), self.fine(12)], |u, v| {
            let x = 0.2 + 0.55 * u;
            let half = (0.055 + 0.03 * u) * (1.0 - (2.0 * u - 1.0).powi(8)).max(0.0).sqrt();
            let (sin, cos) = (v * TAU).sin_cos();
            let across = half * cos;
            Vec3::new(x, 0.006 * sin * half / 0.08 + 0.22 * across, -across)
        })
    }

    /// A palm in a pot.
    fn add_palm(&mut self) {
        let mut model = Model::default();
        let pot = turned(
            &[
                [0.0, 0.0],
                [0.17, 0.0],
                [0.17, 0.0],
                [0.19, 0.05],
                [0.24, 0.34],
                [0.26, 0.36],
                [0.265, 0.42],
                [0.245, 0.425],
                [0.235, 0.38],
                [0.0, 0.37],
            ],
            self.steps(2),
            self.fine(40),
        );
        model.add(self.palette.clay, &pot, Vec3::ZERO);
        let soil = lathe(
            &[Vec2::new(0.236, 0.385), Vec2::new(0.0, 0.395)],
            self.fine(24),
        );
        model.add(self.palette.bark, &soil, Vec3::ZERO);
        for index in 0..13 {
            let own = self.key.mix(70).mix(index);
            let angle = 2.4 * index as f32 + 0.4 * own.uniform(0);
            let out = turn(angle) * Vec3::X;
            // Leaves that would grow into a wall stay short and steep.
            let room = if out.x > 0.3 || out.z < -0.3 {
                0.36
            } else {
                0.85
            };
            let reach = room * (0.75 + 0.35 * own.uniform(1));
            let rise = 1.25 + 0.65 * own.uniform(2);
            self.add_frond(&mut model, out, reach, rise);
        }
        let mut placed = Model::default();
        placed.place(&model, Quat::IDENTITY, PALM);
        self.put("palm", placed);
    }

    /// A stalk that bends outwards, with leaflets along both sides.
    fn add_frond(&self, model: &mut Model, out: Vec3, reach: f32, rise: f32) {
        let stalk = smooth(
            &[
                0.38 * Vec3::Y + 0.03 * out,
                (0.38 + 0.55 * rise) * Vec3::Y + 0.18 * reach * out,
                (0.38 + 0.95 * rise) * Vec3::Y + 0.6 * reach * out,
                (0.38 + 0.88 * rise) * Vec3::Y + reach * out,
            ],
            self.steps(6),
        );
        model.add(
            self.palette.leaf,
            &tube(&stalk, 0.007, self.fine(6)),
            Vec3::ZERO,
        );
        let side = Vec3::Y.cross(out);
        let count = self.fine(22);
        let leaves = model.of(self.palette.leaf);
        for index in 0..count {
            let s = 0.38 + 0.62 * index as f32 / (count - 1) as f32;
            let place = s * (stalk.len() - 1) as f32;
            let (low, part) = ((place as usize).min(stalk.len() - 2), place.fract());
            let part = if s >= 1.0 { 1.0 } else { part };
            let at = stalk[low].lerp(stalk[low + 1], part);
            let ahead = (stalk[low + 1] - stalk[low]).normalize_or(out);
            let length = 0.26 * (PI * (0.12 + 0.8 * (s - 0.38) / 0.62)).sin().max(0.2);
            for sign in [-1.0, 1.0] {
                let way = (0.75 * sign * side + 0.55 * ahead - 0.3 * Vec3::Y).normalize_or(out);
                let tip = at + length * way;
                let middle = at + 0.45 * length * way + 0.03 * length * Vec3::Y;
                let broad = 0.014 * ahead;
                leaves.quadrangle([at, middle - broad, tip, middle + broad]);
            }
        }
    }
}
