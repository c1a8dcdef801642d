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
        for (index, (x, z)) in [(7.3, 0.1), (9.5, 3.6), (7.0, 6.2)].into_iter().enumerate() {
            self.add_table(index, Vec3::new(x, 0.0, z));
        }
    }

    /// A slatted bench, its length along z before it is turned.
    fn add_bench(&mut self, index: usize, foot: Vec3, turn: f32) {
        let spin = Quat::from_rotation_y(turn);
        let (mut seat, mut legs) = (Mesh::default(), Mesh::default());
        for slat in 0..3 {
            let x = -0.24 + 0.17 * slat as f32;
            cuboid(&mut seat, [x, 0.40, -1.1], [x + 0.14, 0.45, 1.1]);
        }
        for z in [-0.8, 0.8] {
            cuboid(&mut legs, [-0.22, 0.0, z - 0.04], [0.22, 0.41, z + 0.04]);
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
        let profile = [
            [0.26, 0.0],
            [0.04, 0.05],
            [0.04, 0.70],
            [0.42, 0.71],
            [0.42, 0.745],
            [0.0, 0.745],
        ];
        let mut table = Mesh::default();
        table.add(
            &lathe(&profile.map(Vec2::from), self.fine(9)),
            Quat::IDENTITY,
            foot,
        );
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

/// A chair that looks towards −x.
fn chair_mesh() -> Mesh {
    let mut mesh = Mesh::default();
    cuboid(&mut mesh, [-0.21, 0.43, -0.21], [0.21, 0.46, 0.21]);
    cuboid(&mut mesh, [0.18, 0.58, -0.20], [0.21, 0.86, 0.20]);
    for z in [-0.18, 0.18] {
        cuboid(
            &mut mesh,
            [-0.20, 0.0, z - 0.015],
            [-0.16, 0.435, z + 0.015],
        );
        cuboid(&mut mesh, [0.165, 0.0, z - 0.015], [0.205, 0.72, z + 0.015]);
    }
    mesh
}
