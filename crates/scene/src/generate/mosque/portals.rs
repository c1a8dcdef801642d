//! The end walls, and a door or a latticed window under a horseshoe arch in each aisle.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec3};

use super::{CEILING, FRONT_WALL, MIHRAB_WALL, SIDE_WALL, Site, arch::Arch, side_aisle_x};
use crate::generate::mesh::Mesh;

const ARCH: Arch = Arch {
    center: 2.75,
    inner: 1.02,
    outer: 1.46,
    half_depth: 0.14,
    below: 0.35,
    stones: 17,
};

/// An end wall as seen by one who faces it: its middle on the floor, and the way to the right.
#[derive(Clone, Copy)]
pub(super) struct Front {
    pub(super) foot: Vec3,
    /// Turns what is built for a wall at z = 0 that is seen from +z.
    pub(super) turn: Quat,
}

impl Front {
    /// The wall behind a point at `x`, at the mihrab's end or at the doors'.
    fn new(x: f32, at_mihrab: bool) -> Self {
        let (z, angle) = if at_mihrab {
            (MIHRAB_WALL, 0.0)
        } else {
            (FRONT_WALL, PI)
        };
        Self {
            foot: Vec3::new(x, 0.0, z),
            turn: Quat::from_rotation_y(angle),
        }
    }

    /// The end of the nave at the mihrab.
    pub(super) fn of_mihrab() -> Self {
        Self::new(0.0, true)
    }

    /// A box before the wall: from, to, in the wall's own directions.
    pub(super) fn block(&self, mesh: &mut Mesh, from: [f32; 3], to: [f32; 3]) {
        let (from, to) = (Vec3::from(from), Vec3::from(to));
        let mut piece = Mesh::default();
        piece.cuboid(from.min(to), from.max(to));
        self.add(mesh, &piece);
    }

    pub(super) fn add(&self, mesh: &mut Mesh, piece: &Mesh) {
        mesh.add(piece, self.turn, self.foot);
    }

    /// An arch that spans along z, turned to span along the wall.
    pub(super) fn add_arch(&self, mesh: &mut Mesh, arch: &Mesh) {
        let turn = self.turn * Quat::from_rotation_y(FRAC_PI_2);
        mesh.add(arch, turn, self.foot);
    }
}

impl Site {
    pub(super) fn add_portals(&mut self) {
        self.add_end_walls();
        let ends = [true, false];
        for (index, x) in side_aisle_x().enumerate() {
            for at_mihrab in ends {
                let name = format!(
                    "portal {index} {}",
                    if at_mihrab { "south" } else { "north" }
                );
                self.add_portal(
                    &name,
                    Front::new(x, at_mihrab),
                    !at_mihrab && index % 2 == 0,
                );
            }
        }
        self.add_portal("main portal", Front::new(0.0, false), true);
    }

    fn add_end_walls(&mut self) {
        let mut walls = Mesh::default();
        let outside = SIDE_WALL + 0.2;
        let half = Self::aisle_half(0.0);
        let top = CEILING + 0.2;
        walls.cuboid(
            Vec3::new(-outside, 0.0, FRONT_WALL),
            Vec3::new(outside, top, FRONT_WALL + 0.2),
        );
        // The mihrab's own wall stands between these.
        for (from, to) in [(-outside, -half), (half, outside)] {
            walls.cuboid(
                Vec3::new(from, 0.0, MIHRAB_WALL - 0.2),
                Vec3::new(to, top, MIHRAB_WALL),
            );
        }
        self.part("end walls", self.palette.plaster, walls);
    }

    /// Jambs, arch, a frame of mouldings round it, and what the opening is closed with.
    fn add_portal(&mut self, name: &str, front: Front, is_door: bool) {
        let foot = ARCH.center - ARCH.inner * ARCH.below.sin();
        let mut marble = Mesh::default();
        for sign in [-1.0, 1.0] {
            front.block(
                &mut marble,
                [sign * 0.98, 0.0, -0.05],
                [sign * 1.36, foot - 0.1, 0.12],
            );
            front.block(
                &mut marble,
                [sign * 0.92, foot - 0.1, -0.05],
                [sign * 1.42, foot, 0.16],
            );
            front.block(
                &mut marble,
                [sign * 1.62, 0.0, -0.05],
                [sign * 1.74, 4.52, 0.09],
            );
            // The dado beside it, as far as the columns.
            front.block(
                &mut marble,
                [sign * 1.74, 0.0, -0.05],
                [sign * 1.92, 1.15, 0.03],
            );
        }
        front.block(&mut marble, [-1.74, 4.52, -0.05], [1.74, 4.66, 0.09]);
        front.block(&mut marble, [-1.82, 4.66, -0.05], [1.82, 4.72, 0.13]);
        self.part(format!("{name} frame"), self.palette.marble, marble);
        let stones = ARCH.stones(self.steps(2));
        for (stones, (what, material)) in stones.iter().zip([
            ("light", self.palette.limestone),
            ("red", self.palette.brick),
        ]) {
            let mut mesh = Mesh::default();
            front.add_arch(&mut mesh, stones);
            self.part(format!("{name} {what} stones"), material, mesh);
        }
        let mut tile = Mesh::default();
        front.block(&mut tile, [-1.60, foot, -0.05], [1.60, 4.50, 0.02]);
        self.part(format!("{name} field"), self.palette.tile, tile);
        if is_door {
            self.add_door(name, front, foot);
        } else {
            self.add_window(name, front, foot);
        }
        self.add_lattice(name, front, 6.4);
    }

    fn add_door(&mut self, name: &str, front: Front, foot: f32) {
        let mut door = Mesh::default();
        for sign in [-1.0, 1.0] {
            front.block(
                &mut door,
                [sign * 0.01, 0.02, -0.05],
                [sign * 0.98, foot, 0.05],
            );
            for row in 0..4 {
                let low = 0.14 + row as f32 * 0.55;
                front.block(
                    &mut door,
                    [sign * 0.12, low, 0.0],
                    [sign * 0.87, low + 0.43, 0.075],
                );
                front.block(
                    &mut door,
                    [sign * 0.24, low + 0.1, 0.0],
                    [sign * 0.75, low + 0.33, 0.095],
                );
            }
        }
        self.part(format!("{name} door"), self.palette.door, door);
    }

    /// A parapet, and a lattice of star-like openings above it.
    fn add_window(&mut self, name: &str, front: Front, foot: f32) {
        let mut parapet = Mesh::default();
        front.block(&mut parapet, [-0.98, 0.0, -0.05], [0.98, 0.95, 0.06]);
        front.block(&mut parapet, [-0.98, 0.95, -0.05], [0.98, 1.03, 0.09]);
        self.part(format!("{name} parapet"), self.palette.panel, parapet);
        let mut pane = Mesh::default();
        front.block(&mut pane, [-0.98, 1.03, -0.05], [0.98, foot, 0.01]);
        self.part(format!("{name} pane"), self.palette.shade, pane);
        let mut lattice = Mesh::default();
        bars(&mut lattice, front, [-0.98, 0.98], [1.03, foot], 7);
        self.part(format!("{name} lattice"), self.palette.limestone, lattice);
    }

    /// A square latticed opening high in the wall.
    fn add_lattice(&mut self, name: &str, front: Front, middle: f32) {
        let (low, high) = (middle - 0.75, middle + 0.75);
        let mut frame = Mesh::default();
        for sign in [-1.0, 1.0] {
            front.block(
                &mut frame,
                [sign * 0.75, low, -0.05],
                [sign * 0.9, high, 0.08],
            );
        }
        front.block(&mut frame, [-0.98, low - 0.15, -0.05], [0.98, low, 0.10]);
        front.block(&mut frame, [-0.98, high, -0.05], [0.98, high + 0.15, 0.10]);
        bars(&mut frame, front, [-0.75, 0.75], [low, high], 6);
        self.part(format!("{name} high window"), self.palette.limestone, frame);
        let mut pane = Mesh::default();
        front.block(&mut pane, [-0.75, low, -0.05], [0.75, high, 0.01]);
        self.part(format!("{name} high pane"), self.palette.shade, pane);
    }
}

/// Bars both ways across a rectangle, with a boss wherever two meet. Those that lie stand out
/// less than those that stand.
fn bars(mesh: &mut Mesh, front: Front, x: [f32; 2], y: [f32; 2], count: u32) {
    let at = |range: [f32; 2], index: u32, count: u32| {
        range[0] + (range[1] - range[0]) * index as f32 / count as f32
    };
    let rows = ((y[1] - y[0]) / (x[1] - x[0]) * count as f32).round() as u32;
    for column in 1..count {
        let middle = at(x, column, count);
        front.block(
            mesh,
            [middle - 0.022, y[0], -0.04],
            [middle + 0.022, y[1], 0.05],
        );
        for row in 1..rows {
            let height = at(y, row, rows);
            let mut boss = Mesh::default();
            let half = 0.062;
            boss.block(
                Vec3::new(middle, height - half, -0.04),
                Vec3::new(half, half, 0.0),
                Vec3::new(-half, half, 0.0),
                0.10 * Vec3::Z,
            );
            front.add(mesh, &boss);
        }
    }
    for row in 1..rows {
        let height = at(y, row, rows);
        front.block(
            mesh,
            [x[0], height - 0.022, -0.04],
            [x[1], height + 0.022, 0.045],
        );
    }
}
