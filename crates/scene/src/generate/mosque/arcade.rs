//! The arcades: columns, piers on them, and two tiers of arches from pier to pier.

use glam::Vec3;

use super::{
    ARCADE_TOP, BAY, BAYS, Site, arcade_x, arch::Arch, capital, column::SHAFT_TOP, place, slab,
};
use crate::generate::mesh::Mesh;

/// Where the lower arches stand: on the blocks above the capitals.
const IMPOST: f32 = 3.52;
/// Where the upper arches stand: on the heads of the piers.
const PIER_TOP: f32 = 6.0;

const LOWER: Arch = Arch {
    center: 3.98,
    inner: 1.18,
    outer: 1.56,
    half_depth: 0.25,
    below: 0.40,
    stones: 19,
};

const UPPER: Arch = Arch {
    center: PIER_TOP,
    inner: 1.24,
    outer: 1.58,
    half_depth: 0.34,
    below: 0.0,
    stones: 21,
};

impl Site {
    pub(super) fn add_arcades(&mut self) {
        let (base, shafts, capitals) = (self.base(), self.shafts(), self.capitals());
        let capital_y = SHAFT_TOP * Vec3::Y;
        for (row, x) in arcade_x().enumerate() {
            for index in 0..=BAYS {
                let foot = Vec3::new(x, 0.0, -BAY * index as f32);
                let own = self.key.mix(row as u64).mix(u64::from(index));
                let pick = |draw: u32, of: usize| (own.uniform(draw) * of as f32) as usize % of;
                let name = format!("column {row}.{index}");
                let stone = self.palette.stones[pick(0, self.palette.stones.len())];
                // Every other one is plain, as old shafts brought from elsewhere are.
                let shaft = &shafts[pick(1, 6).saturating_sub(3)];
                let mut mesh = Mesh::default();
                let turn = glam::Quat::from_rotation_y(std::f32::consts::TAU * own.uniform(2));
                mesh.add(shaft, turn, foot);
                self.part(format!("{name} shaft"), stone, mesh);
                let mut mesh = Mesh::default();
                place(&mut mesh, &base, foot);
                place(&mut mesh, &capitals[pick(3, 3)], foot + capital_y);
                self.part(
                    format!("{name} base and capital"),
                    self.palette.marble,
                    mesh,
                );
            }
            self.add_piers(&format!("arcade {row}"), x);
            self.add_arches(&format!("arcade {row}"), x);
        }
    }

    /// What stands on the capitals.
    fn add_piers(&mut self, name: &str, x: f32) {
        let mut mesh = Mesh::default();
        let mut pilasters = Mesh::default();
        for index in 0..=BAYS {
            let foot = Vec3::new(x, 0.0, -BAY * index as f32);
            let low = SHAFT_TOP + capital::HEIGHT;
            flare(
                &mut mesh,
                foot,
                [[0.31, 0.31], [0.37, 0.42]],
                [low, IMPOST - 0.09],
            );
            slab(&mut mesh, foot, [0.38, 0.52], [IMPOST - 0.09, IMPOST]);
            slab(&mut mesh, foot, [0.31, 0.22], [IMPOST, PIER_TOP - 0.55]);
            flare(
                &mut mesh,
                foot,
                [[0.31, 0.22], [0.36, 0.385]],
                [PIER_TOP - 0.55, PIER_TOP - 0.1],
            );
            slab(&mut mesh, foot, [0.37, 0.395], [PIER_TOP - 0.1, PIER_TOP]);
            slab(
                &mut pilasters,
                foot,
                [0.37, 0.13],
                [PIER_TOP, ARCADE_TOP - 0.01],
            );
        }
        // Into the end walls.
        for (index, sign) in [(0, 1.0), (BAYS, -1.0)] {
            let z = -BAY * index as f32 + sign * 0.3;
            let middle = Vec3::new(x, 0.0, z);
            slab(&mut mesh, middle, [0.305, 0.1], [IMPOST, PIER_TOP]);
            slab(
                &mut mesh,
                middle,
                [0.305, 0.31],
                [PIER_TOP, ARCADE_TOP - 0.01],
            );
        }
        self.part(format!("{name} piers"), self.palette.limestone, mesh);
        self.part(
            format!("{name} pilasters"),
            self.palette.limestone,
            pilasters,
        );
    }

    fn add_arches(&mut self, name: &str, x: f32) {
        let steps = self.steps(2);
        let (lower, upper) = (LOWER.stones(steps), UPPER.stones(steps));
        let wall = UPPER.spandrel(0.5 * BAY, ARCADE_TOP, 0.3, 1.42, self.fine(20));
        let mut meshes = [Mesh::default(), Mesh::default()];
        let mut walls = Mesh::default();
        for bay in 0..BAYS {
            let middle = Vec3::new(x, 0.0, -BAY * (bay as f32 + 0.5));
            for (mesh, stones) in meshes.iter_mut().zip(lower.iter().zip(&upper)) {
                place(mesh, stones.0, middle);
                place(mesh, stones.1, middle);
            }
            place(&mut walls, &wall, middle);
        }
        let [light, red] = meshes;
        self.part(
            format!("{name} light stones"),
            self.palette.limestone,
            light,
        );
        self.part(format!("{name} red stones"), self.palette.brick, red);
        self.part(format!("{name} wall"), self.palette.plaster, walls);
    }
}

/// A block that widens upwards: half sizes along x and z below and above.
fn flare(mesh: &mut Mesh, foot: Vec3, half: [[f32; 2]; 2], up: [f32; 2]) {
    let corners = |level: usize| {
        let [x, z] = half[level];
        [[x, z], [x, -z], [-x, -z], [-x, z]].map(|[x, z]| foot + Vec3::new(x, up[level], z))
    };
    let (low, high) = (corners(0), corners(1));
    for side in 0..4 {
        let next = (side + 1) % 4;
        mesh.quadrangle([low[side], low[next], high[next], high[side]]);
    }
    mesh.quadrangle(high);
    mesh.quadrangle([low[3], low[2], low[1], low[0]]);
}
