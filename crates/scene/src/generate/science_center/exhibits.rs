//! What there is to see besides the whale: a globe, a helix, and solids on plinths.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

use super::{Site, cuboid};
use crate::generate::{
    mesh::Mesh,
    shapes::{lathe, rod, sphere, torus},
};

impl Site {
    pub(super) fn add_exhibits(&mut self) {
        self.add_globe(Vec3::new(3.0, 0.0, 5.0));
        self.add_helix(Vec3::new(-3.6, 0.0, 4.2));
        for (index, z) in [-6.2, -0.4, 5.4].into_iter().enumerate() {
            self.add_solid(index, Vec3::new(-9.2, 0.0, z));
        }
    }

    /// A globe in a brass ring on a round foot.
    fn add_globe(&mut self, foot: Vec3) {
        let center = foot + 1.55 * Vec3::Y;
        let tilt = Quat::from_rotation_z(-0.41);
        let mut mesh = Mesh::default();
        let mut ball = sphere(0.85, self.fine(14));
        for vertex in &mut ball.vertices {
            // The lathe's v is a height; the map's runs from pole to pole.
            vertex.uv.y = 0.5 - 0.5 * vertex.uv.y / 0.85;
        }
        mesh.add(&ball, tilt, center);
        self.part("globe", self.palette.globe, mesh);
        let mut brass = Mesh::default();
        let ring = torus(0.98, 0.035, [self.fine(18), self.fine(3)]);
        brass.add(&ring, Quat::from_rotation_x(0.25 * TAU), center);
        for sign in [-1.0, 1.0] {
            let pole = tilt * (sign * Vec3::Y);
            brass.add(
                &rod(center + 0.83 * pole, center + 0.99 * pole, 0.03, 5),
                Quat::IDENTITY,
                Vec3::ZERO,
            );
        }
        self.part("globe ring", self.palette.brass, brass);
        let profile = [
            [0.62, 0.0],
            [0.62, 0.12],
            [0.20, 0.2],
            [0.12, 0.60],
            [0.0, 0.62],
        ];
        let mut stand = Mesh::default();
        let turned = lathe(&profile.map(Vec2::from), self.fine(12));
        stand.add(&turned, Quat::IDENTITY, foot);
        self.part("globe foot", self.palette.concrete, stand);
    }

    /// Two strands of balls with rungs between them.
    fn add_helix(&mut self, foot: Vec3) {
        const RUNGS: u32 = 9;
        let mut base = Mesh::default();
        let profile = [[0.7, 0.0], [0.7, 0.3], [0.0, 0.3]];
        base.add(
            &lathe(&profile.map(Vec2::from), self.fine(14)),
            Quat::IDENTITY,
            foot,
        );
        let axis = rod(foot + 0.3 * Vec3::Y, foot + 3.55 * Vec3::Y, 0.03, 6);
        base.add(&axis, Quat::IDENTITY, Vec3::ZERO);
        self.part("helix foot", self.palette.concrete, base);
        let ball = sphere(0.115, self.fine(6));
        let mut strands = [Mesh::default(), Mesh::default()];
        let mut rungs = Mesh::default();
        for rung in 0..RUNGS {
            let turn = TAU * rung as f32 / 8.0;
            let out = 0.48 * Vec3::new(turn.cos(), 0.0, turn.sin());
            let center = foot + (0.55 + 0.345 * rung as f32) * Vec3::Y;
            for (strand, sign) in strands.iter_mut().zip([1.0, -1.0]) {
                strand.add(&ball, Quat::IDENTITY, center + sign * out);
            }
            rungs.add(
                &rod(center - out, center + out, 0.03, 4),
                Quat::IDENTITY,
                Vec3::ZERO,
            );
        }
        let [first, second] = strands;
        self.part("helix first strand", self.palette.paints[0], first);
        self.part("helix second strand", self.palette.paints[2], second);
        self.part("helix rungs", self.palette.paints[4], rungs);
    }

    /// A plinth with something round or edged on it.
    fn add_solid(&mut self, index: usize, foot: Vec3) {
        let mut plinth = Mesh::default();
        let (low, high) = (foot.to_array(), foot + 0.95 * Vec3::Y);
        cuboid(
            &mut plinth,
            [low[0] - 0.32, 0.0, low[2] - 0.32],
            [low[0] + 0.32, high.y, low[2] + 0.32],
        );
        self.part(format!("plinth {index}"), self.palette.column, plinth);
        let center = high + 0.34 * Vec3::Y;
        let mut mesh = Mesh::default();
        match index {
            0 => octahedron(&mut mesh, center, 0.34),
            1 => {
                let ring = torus(0.24, 0.095, [self.fine(12), self.fine(5)]);
                mesh.add(&ring, Quat::from_rotation_z(0.25 * TAU), center);
            }
            _ => mesh.add(&sphere(0.33, 3 * self.fine(3)), Quat::IDENTITY, center),
        }
        self.part(
            format!("solid {index}"),
            self.palette.paints[[3, 1, 2][index % 3]],
            mesh,
        );
    }
}

fn octahedron(mesh: &mut Mesh, center: Vec3, radius: f32) {
    for turn in 0..4 {
        let spin = Quat::from_rotation_y(0.25 * TAU * turn as f32 + 0.3);
        let (a, b) = (spin * (radius * Vec3::X), spin * (-radius * Vec3::Z));
        let tip = radius * Vec3::Y;
        mesh.triangle([center + a, center + b, center + tip]);
        mesh.triangle([center + b, center + a, center - tip]);
    }
}
