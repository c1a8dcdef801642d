//! The niche at the end of the nave, in a wall of gold and blue.

use std::f32::consts::PI;

use glam::{Quat, Vec3};

use super::{CEILING, Site, arch::Arch, portals::Front};
use crate::generate::{
    mesh::Mesh,
    shapes::{lathe, parametric, sphere},
};

/// Radius of the niche, and half the width of the hole in the wall.
const NICHE: f32 = 1.25;
const FRAME_HALF: f32 = 2.24;
const FRAME_TOP: f32 = 5.3;

const ARCH: Arch = Arch {
    center: 2.95,
    inner: 1.16,
    outer: 2.0,
    half_depth: 0.12,
    below: 0.42,
    stones: 23,
};

/// The small blind arches above the frame.
const ROW: Arch = Arch {
    center: 6.55,
    inner: 0.24,
    outer: 0.36,
    half_depth: 0.09,
    below: 0.3,
    stones: 9,
};

impl Site {
    pub(super) fn add_mihrab(&mut self) {
        let front = Front::of_mihrab();
        self.add_mihrab_wall(front);
        self.add_niche(front);
        let steps = self.steps(5);
        let [gold, blue] = ARCH.stones(steps);
        for (name, material, stones) in [
            ("mihrab gold stones", self.palette.gold, gold),
            ("mihrab blue stones", self.palette.blue, blue),
        ] {
            let mut mesh = Mesh::default();
            front.add_arch(&mut mesh, &stones);
            self.part(name, material, mesh);
        }
        self.add_mihrab_frame(front);
        self.add_blind_row(front);
    }

    /// The wall with the hole that the arch's ring lines.
    fn add_mihrab_wall(&mut self, front: Front) {
        let half = Self::aisle_half(0.0) + 0.02;
        let mut field = Mesh::default();
        let above = ARCH.spandrel(FRAME_HALF, FRAME_TOP, 0.01, NICHE, self.fine(48));
        front.add_arch(&mut field, &above);
        for sign in [-1.0, 1.0] {
            front.block(
                &mut field,
                [sign * NICHE, 0.0, -0.2],
                [sign * FRAME_HALF, ARCH.center, 0.0],
            );
        }
        self.part("mihrab field", self.palette.tile, field);
        let mut wall = Mesh::default();
        for sign in [-1.0, 1.0] {
            front.block(
                &mut wall,
                [sign * FRAME_HALF, 0.0, -0.2],
                [sign * half, FRAME_TOP, 0.0],
            );
        }
        front.block(
            &mut wall,
            [-half, FRAME_TOP, -0.2],
            [half, CEILING + 0.2, 0.0],
        );
        self.part("mihrab wall", self.palette.plaster, wall);
    }

    /// Half a drum with a shell for a roof, seen from within.
    fn add_niche(&mut self, front: Front) {
        let mut drum = Mesh::default();
        let round = parametric([self.fine(64), self.steps(12)], |u, v| {
            let (sin, cos) = (PI * u).sin_cos();
            Vec3::new(-NICHE * cos, v * ARCH.center, -0.02 - NICHE * sin)
        });
        front.add(&mut drum, &round);
        self.part("mihrab niche", self.palette.panel, drum);
        let mut shell = Mesh::default();
        // Ribs that fan out from the foot of the back wall.
        let mut inside_out = parametric([self.fine(144), self.fine(28)], |u, v| {
            let ribs = 1.0 - 0.05 * (PI * 11.0 * u).sin().powi(2) * v.min(1.0);
            let (sin, cos) = (PI * u).sin_cos();
            let (lift, reach) = (0.5 * PI * (1.0 - v)).sin_cos();
            Vec3::new(
                -NICHE * ribs * cos * reach,
                ARCH.center + NICHE * ribs * lift,
                -0.02 - NICHE * ribs * sin * reach,
            )
        });
        inside_out.flip();
        front.add(&mut shell, &inside_out);
        self.part("mihrab shell", self.palette.gold, shell);
        let mut band = Mesh::default();
        for (y, radius) in [(1.15, 0.03), (ARCH.center, 0.05)] {
            let mut ring = parametric([self.fine(48), self.fine(8)], |u, v| {
                let (sin, cos) = (PI * u).sin_cos();
                let (tube_sin, tube_cos) = (2.0 * PI * v).sin_cos();
                let reach = NICHE - 0.01 + radius * tube_cos;
                Vec3::new(-reach * cos, y + radius * tube_sin, -0.02 - reach * sin)
            });
            ring.flip();
            front.add(&mut band, &ring);
        }
        self.part("mihrab bands", self.palette.marble, band);
    }

    fn add_mihrab_frame(&mut self, front: Front) {
        let mut gold = Mesh::default();
        let mut marble = Mesh::default();
        let foot = ARCH.center - ARCH.inner * ARCH.below.sin();
        for sign in [-1.0, 1.0] {
            let upright = |mesh: &mut Mesh, x: [f32; 2], up: [f32; 2], depth: f32| {
                front.block(
                    mesh,
                    [sign * x[0], up[0], -0.05],
                    [sign * x[1], up[1], depth],
                );
            };
            upright(&mut marble, [1.06, 1.36], [0.0, foot - 0.12], 0.11);
            upright(&mut marble, [0.99, 1.42], [foot - 0.12, foot], 0.15);
            upright(&mut marble, [1.36, 2.06], [0.0, 1.2], 0.05);
            upright(&mut gold, [2.06, 2.16], [0.0, FRAME_TOP - 0.2], 0.07);
            upright(&mut marble, [2.16, 2.34], [0.0, FRAME_TOP], 0.10);
            self.add_colonnette(front, sign);
        }
        front.block(
            &mut gold,
            [-2.16, FRAME_TOP - 0.2, -0.05],
            [2.16, FRAME_TOP - 0.1, 0.07],
        );
        front.block(
            &mut marble,
            [-2.34, FRAME_TOP, -0.05],
            [2.34, FRAME_TOP + 0.12, 0.13],
        );
        front.block(
            &mut gold,
            [-2.42, FRAME_TOP + 0.12, -0.05],
            [2.42, FRAME_TOP + 0.2, 0.17],
        );
        // A row of bosses along the frame's lintel.
        let boss = sphere(0.045, self.fine(10));
        for index in 0..21 {
            let mut moved = Mesh::default();
            let x = -2.0 + 0.2 * index as f32;
            super::place(&mut moved, &boss, Vec3::new(x, FRAME_TOP - 0.05, 0.005));
            front.add(&mut gold, &moved);
        }
        self.part("mihrab gold frame", self.palette.gold, gold);
        self.part("mihrab marble frame", self.palette.marble, marble);
    }

    /// A slender column before the jamb.
    fn add_colonnette(&mut self, front: Front, sign: f32) {
        let profile = [
            [0.09, 0.0],
            [0.09, 0.06],
            [0.065, 0.10],
            [0.06, 0.14],
            [0.056, 1.9],
            [0.07, 1.93],
            [0.056, 1.96],
            [0.075, 2.12],
            [0.11, 2.2],
            [0.11, 2.28],
        ];
        let piece = lathe(&profile.map(glam::Vec2::from), self.fine(24));
        let mut moved = Mesh::default();
        moved.add(&piece, Quat::IDENTITY, Vec3::new(sign * 1.20, 0.0, 0.2));
        let mut mesh = Mesh::default();
        front.add(&mut mesh, &moved);
        let stone = self.palette.stones[if sign < 0.0 { 0 } else { 1 }];
        self.part(format!("mihrab colonnette {sign}"), stone, mesh);
    }

    fn add_blind_row(&mut self, front: Front) {
        let stones = ROW.stones(self.steps(2));
        let mut meshes = [Mesh::default(), Mesh::default()];
        let (mut posts, mut fields) = (Mesh::default(), Mesh::default());
        for index in 0..6 {
            let x = -1.875 + 0.75 * index as f32;
            let here = Front {
                foot: front.foot + x * Vec3::X,
                ..front
            };
            for (mesh, stones) in meshes.iter_mut().zip(&stones) {
                here.add_arch(mesh, stones);
            }
            here.block(&mut fields, [-0.30, 5.68, -0.05], [0.30, 6.75, 0.015]);
            for sign in [-1.0, 1.0] {
                here.block(
                    &mut posts,
                    [sign * 0.23, 5.62, -0.05],
                    [sign * 0.31, 6.4, 0.06],
                );
                here.block(
                    &mut posts,
                    [sign * 0.20, 6.4, -0.05],
                    [sign * 0.345, 6.47, 0.1],
                );
            }
        }
        front.block(&mut posts, [-2.4, 5.56, -0.05], [2.4, 5.62, 0.12]);
        front.block(&mut posts, [-2.4, 7.05, -0.05], [2.4, 7.15, 0.12]);
        let [gold, blue] = meshes;
        self.part("blind arches gold", self.palette.gold, gold);
        self.part("blind arches blue", self.palette.blue, blue);
        self.part("blind arches posts", self.palette.marble, posts);
        self.part("blind arches fields", self.palette.tile, fields);
    }
}
