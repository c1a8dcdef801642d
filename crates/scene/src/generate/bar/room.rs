//! The shell: floor, walls, panelling, ceiling, door.

use glam::Vec3;

use super::{
    HALF, HEIGHT, Site,
    joinery::{Front, Panelling},
};
use crate::generate::{
    mesh::Mesh,
    shapes::{sphere, torus},
};

/// Height of the panelling along the walls.
const WAINSCOT: f32 = 1.12;
/// Where the door is along the east wall, frame included.
const DOOR: [f32; 2] = [0.55, 2.65];
const DOOR_HEIGHT: f32 = 2.42;
/// Undersides of the beams.
const BEAM: f32 = HEIGHT - 0.3;

impl Site {
    pub(super) fn add_room(&mut self) {
        self.add_floor();
        self.add_walls();
        self.add_wainscot();
        self.add_door();
        self.add_ceiling();
    }

    fn add_floor(&mut self) {
        const BORDER: f32 = 0.3;
        let [x, z] = HALF;
        let slab = |mesh: &mut Mesh, x: [f32; 2], z: [f32; 2]| {
            mesh.quad(
                Vec3::new(x[0], 0.0, z[1]),
                (x[1] - x[0]) * Vec3::X,
                (z[0] - z[1]) * Vec3::Z,
            );
        };
        let mut tiles = Mesh::default();
        slab(
            &mut tiles,
            [BORDER - x, x - BORDER],
            [BORDER - z, z - BORDER],
        );
        self.part("floor", self.palette.floor, tiles);
        let mut border = Mesh::default();
        slab(&mut border, [-x, x], [-z, BORDER - z]);
        slab(&mut border, [-x, x], [z - BORDER, z]);
        slab(&mut border, [-x, BORDER - x], [BORDER - z, z - BORDER]);
        slab(&mut border, [x - BORDER, x], [BORDER - z, z - BORDER]);
        self.part("floor border", self.palette.floor_border, border);
    }

    fn add_walls(&mut self) {
        let mut paper = Mesh::default();
        for (front, length) in walls() {
            paper.quad(front.corner, length * front.right, HEIGHT * Vec3::Y);
        }
        self.part("walls", self.palette.wallpaper, paper);
    }

    fn add_wainscot(&mut self) {
        let mut wood = Mesh::default();
        let mut trim = Mesh::default();
        let [_, south, west, east] = walls();
        let [north, ..] = walls();
        // The north wall's panelling begins where the counter ends; the east wall's leaves
        // out the door.
        let east_z = |z: f32| z + HALF[1];
        for ((front, _), span) in [
            (north, [9.7, 14.0]),
            (north, [0.0, 1.75]),
            (south, [0.0, 14.0]),
            (west, [0.0, 9.0]),
            (east, [0.0, east_z(DOOR[0])]),
            (east, [east_z(DOOR[1]), 9.0]),
        ] {
            let width = span[1] - span[0];
            front.panel(
                &mut wood,
                &Panelling {
                    span,
                    rise: [0.16, WAINSCOT],
                    columns: (width / 0.62).round().max(1.0) as u32,
                    rail: 0.085,
                },
            );
            front.board(&mut trim, span, [0.0, 0.16], [0.0, 0.034]);
            front.board(&mut trim, span, [WAINSCOT, WAINSCOT + 0.028], [0.0, 0.052]);
            front.board(
                &mut trim,
                span,
                [WAINSCOT - 0.035, WAINSCOT],
                [0.022, 0.036],
            );
        }
        for (front, length) in walls() {
            let all = [0.0, length];
            front.board(&mut trim, all, [2.78, 2.82], [0.0, 0.022]);
            front.board(&mut trim, all, [HEIGHT - 0.20, HEIGHT - 0.08], [0.0, 0.05]);
            front.board(&mut trim, all, [HEIGHT - 0.08, HEIGHT], [0.0, 0.11]);
        }
        self.part("wainscot", self.palette.walnut, wood);
        self.part("wainscot trim", self.palette.ebony, trim);
    }

    /// Two leaves in a frame, shut.
    fn add_door(&mut self) {
        let [_, _, _, (wall, _)] = walls();
        let door = Front {
            corner: wall.corner + (DOOR[0] + HALF[1]) * wall.right,
            ..wall
        };
        let width = DOOR[1] - DOOR[0];
        let (post, depth) = (0.16, 0.075);
        let mut frame = Mesh::default();
        for x in [[0.0, post], [width - post, width]] {
            door.board(&mut frame, x, [0.0, DOOR_HEIGHT], [0.0, depth]);
        }
        let lintel = [DOOR_HEIGHT, DOOR_HEIGHT + 0.2];
        door.board(&mut frame, [-0.05, width + 0.05], lintel, [0.0, depth]);
        let crown = [DOOR_HEIGHT + 0.2, DOOR_HEIGHT + 0.25];
        door.board(&mut frame, [-0.09, width + 0.09], crown, [0.0, 0.13]);
        self.part("door frame", self.palette.ebony, frame);
        let mut leaves = Mesh::default();
        let middle = 0.5 * width;
        for span in [[post, middle - 0.004], [middle + 0.004, width - post]] {
            for rise in [[0.02, 0.95], [0.95, DOOR_HEIGHT]] {
                let panelling = Panelling {
                    span,
                    rise,
                    columns: 2,
                    rail: 0.1,
                };
                door.panel(&mut leaves, &panelling);
            }
        }
        self.part("door leaves", self.palette.mahogany, leaves);
        let mut brass = Mesh::default();
        for x in [middle - 0.07, middle + 0.07] {
            door.board(
                &mut brass,
                [x - 0.025, x + 0.025],
                [0.92, 1.16],
                [0.022, 0.028],
            );
            let knob = sphere(0.03, self.fine(20));
            let at = door.at(x, 1.02, 0.075);
            brass.add(&knob, glam::Quat::IDENTITY, at);
            let stem = [[x - 0.008, x + 0.008], [1.012, 1.028], [0.028, 0.055]];
            door.board(&mut brass, stem[0], stem[1], stem[2]);
        }
        self.part("door brass", self.palette.brass, brass);
    }

    /// Plaster between beams, and a rose around each fan's rod.
    fn add_ceiling(&mut self) {
        let [x, z] = HALF;
        let mut plaster = Mesh::default();
        plaster.quad(
            Vec3::new(-x, HEIGHT, -z),
            2.0 * x * Vec3::X,
            2.0 * z * Vec3::Z,
        );
        for fan in super::FANS {
            let rose = torus(0.16, 0.03, [self.fine(40), self.fine(12)]);
            plaster.add(&rose, glam::Quat::IDENTITY, fan.with_y(HEIGHT));
        }
        self.part("ceiling", self.palette.plaster, plaster);
        let mut beams = Mesh::default();
        let across = Front {
            corner: Vec3::new(0.0, 0.0, -z),
            right: Vec3::NEG_Z,
            up: Vec3::Y,
        };
        for index in 0..7 {
            let at = -6.0 + 2.0 * index as f32;
            let sides = [at - 0.09, at + 0.09];
            across.board(&mut beams, [-2.0 * z, 0.0], [BEAM, HEIGHT], sides);
        }
        // A little shallower, so that no two faces share a plane.
        let along = Front::upright(Vec3::ZERO, Vec3::X);
        for at in [-2.4, 0.75 - 1.4, 0.75 + 1.4] {
            let sides = [at - 0.07, at + 0.07];
            along.board(&mut beams, [-x, x], [BEAM + 0.06, HEIGHT], sides);
        }
        self.part("beams", self.palette.ebony, beams);
    }
}

/// The walls' fronts, north, south, west and east, each from its lower left corner, and
/// their lengths.
pub(super) fn walls() -> [(Front, f32); 4] {
    let [x, z] = HALF;
    [
        (Vec3::new(-x, 0.0, -z), Vec3::X, 2.0 * x),
        (Vec3::new(x, 0.0, z), Vec3::NEG_X, 2.0 * x),
        (Vec3::new(-x, 0.0, z), Vec3::NEG_Z, 2.0 * z),
        (Vec3::new(x, 0.0, -z), Vec3::Z, 2.0 * z),
    ]
    .map(|(corner, right, length)| (Front::upright(corner, right), length))
}
