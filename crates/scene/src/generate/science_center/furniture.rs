//! Benches in the atrium, a café below the balcony, a desk at the entrance.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

use super::{BALCONY, Site, cuboid};
use crate::generate::{mesh::Mesh, shapes::lathe};

impl Site {
    pub(super) fn add_furniture(&mut self) {
        self.add_desk();
        for (index, (x, z, y)) in [
            (-3.9, -2.2, 0.0),
            (3.9, -2.2, 0.0),
            (0.0, 8.6, 0.0),
            (-9.6, 1.6, BALCONY),
        ]
        .into_iter()
        .enumerate()
        {
            let turn = if x == 0.0 { 0.25 * TAU } else { 0.0 };
            self.add_bench(index, Vec3::new(x, y, z), turn);
        }
        for (index, (x, z)) in [(4.7, 0.6), (5.0, 3.4), (7.0, 6.4)].into_iter().enumerate() {
            self.add_table(index, Vec3::new(x, 0.0, z));
        }
    }

    /// A bench, its length along z before it is turned.
    fn add_bench(&mut self, index: usize, foot: Vec3, turn: f32) {
        let spin = Quat::from_rotation_y(turn);
        let (mut seat, mut legs) = (Mesh::default(), Mesh::default());
        cuboid(&mut seat, [-0.24, 0.39, -1.1], [0.24, 0.45, 1.1]);
        for z in [-0.8, 0.8] {
            cuboid(&mut legs, [-0.20, 0.0, z - 0.05], [0.20, 0.40, z + 0.05]);
        }
        for (name, material, mesh) in [
            ("seat", self.palette.oak, seat),
            ("legs", self.palette.steel, legs),
        ] {
            let mut turned = Mesh::default();
            turned.add(&mesh, spin, foot);
            self.part(format!("bench {index} {name}"), material, turned);
        }
    }

    /// A round table with two chairs about it, pulled out more or less.
    fn add_table(&mut self, index: usize, foot: Vec3) {
        let own = self.key.mix(40 + index as u64);
        let mut table = Mesh::default();
        let top = lathe(
            &[[0.42, 0.71], [0.42, 0.745], [0.0, 0.745]].map(Vec2::from),
            8,
        );
        table.add(&top, Quat::IDENTITY, foot);
        for (half, low, high) in [(0.26, 0.0, 0.03), (0.035, 0.02, 0.72)] {
            cuboid(
                &mut table,
                [foot.x - half, low, foot.z - half],
                [foot.x + half, high, foot.z + half],
            );
        }
        self.part(format!("table {index}"), self.palette.column, table);
        for chair in 0..2 {
            let turn = TAU * (chair as f32 / 2.0 + 0.2 * own.uniform(chair)) + index as f32;
            let out = 0.62 + 0.2 * own.uniform(3 + chair);
            let spin = Quat::from_rotation_y(turn);
            let material = self.palette.paints[(own.uniform(6 + chair) * 4.0) as usize % 4];
            let mut mesh = Mesh::default();
            mesh.add(&chair_mesh(), spin, foot + spin * Vec3::new(out, 0.0, 0.0));
            self.part(format!("chair {index}.{chair}"), material, mesh);
        }
    }

    /// The information desk beside the stairs.
    fn add_desk(&mut self) {
        let (mut body, mut top) = (Mesh::default(), Mesh::default());
        cuboid(&mut body, [3.4, 0.0, -8.4], [5.6, 1.02, -7.8]);
        cuboid(&mut top, [3.3, 1.02, -8.5], [5.7, 1.08, -7.7]);
        self.part("desk", self.palette.paints[0], body);
        self.part("desk top", self.palette.oak, top);
    }
}

/// A chair that looks towards −x: a seat and a back between two boards.
fn chair_mesh() -> Mesh {
    let mut mesh = Mesh::default();
    cuboid(&mut mesh, [-0.21, 0.42, -0.19], [0.20, 0.46, 0.19]);
    cuboid(&mut mesh, [0.17, 0.56, -0.19], [0.20, 0.86, 0.19]);
    for z in [-0.19, 0.17] {
        cuboid(&mut mesh, [-0.20, 0.0, z], [-0.12, 0.44, z + 0.02]);
        cuboid(&mut mesh, [0.13, 0.0, z], [0.21, 0.86, z + 0.02]);
    }
    mesh
}
