//! The entrance hall and the corridor behind it.

use glam::Vec3;

use super::{
    COOL, Site, WARM,
    walls::{Opening, Room, Wall},
};
use crate::generate::mesh::Mesh;

pub(super) const HALL_HEIGHT: f32 = 5.0;
pub(super) const CORRIDOR_HEIGHT: f32 = 3.4;
/// Where the doors from the corridor to the galleries are, along z.
pub(super) const GALLERY_DOOR_Z: f32 = -4.5;

impl Site {
    pub(super) fn add_hall(&mut self) {
        let room = Room::new([-5.0, 5.0], [0.0, 7.0], HALL_HEIGHT);
        self.add_slabs("hall", room, self.palette.checker);
        self.add_coffers("hall", room, [6, 4], 0.3);
        self.add_hall_walls(room);
        for (side, x) in [("west", -2.6), ("east", 2.6)] {
            for (index, z) in [1.5, 3.5, 5.5].into_iter().enumerate() {
                let foot = Vec3::new(x, 0.0, z);
                self.add_column(&format!("{side} column {index}"), foot, HALL_HEIGHT - 0.3);
            }
        }
        // Between the columns: lamps along the middle, spots down the walls' niches.
        for (index, z) in [1.1, 3.5, 5.9].into_iter().enumerate() {
            let place = Vec3::new(0.0, 3.15, z);
            self.add_lantern(
                &format!("hall lantern {index}"),
                place,
                HALL_HEIGHT - 0.28,
                9.0 * WARM,
            );
        }
        for (index, (x, z)) in [(-4.2, 2.5), (-4.2, 4.5), (4.2, 2.5), (4.2, 4.5)]
            .into_iter()
            .enumerate()
        {
            let lamp = Vec3::new(x, HALL_HEIGHT - 0.55, z);
            let target = Vec3::new(1.16 * x, 1.2, z);
            let name = format!("hall spot {index}");
            self.add_spot(
                &name,
                lamp,
                target,
                30.0 * WARM,
                [16.0, 34.0],
                lamp + 0.35 * Vec3::Y,
            );
            self.add_vase_on_stand(index as u32, Vec3::new(1.08 * x, 0.0, z));
        }
        self.add_bench("hall bench west", Vec3::new(-4.4, 0.0, 6.2), Vec3::X, 1.0);
        self.add_bench("hall bench east", Vec3::new(4.4, 0.0, 6.2), Vec3::X, 1.0);
    }

    fn add_hall_walls(&mut self, room: Room) {
        let plaster = self.palette.plaster;
        let wall = |origin, along, through, length| Wall {
            origin,
            along,
            through,
            length,
            height: HALL_HEIGHT,
            thickness: 0.3,
        };
        let north = wall(Vec3::new(-5.3, 0.0, 0.0), Vec3::X, Vec3::NEG_Z, 10.6);
        self.add_wall(
            "hall north wall",
            plaster,
            &north,
            &[Opening::arch(5.3, 2.4, 3.1)],
            [true, false],
        );
        let south = wall(Vec3::new(-5.3, 0.0, 7.0), Vec3::X, Vec3::Z, 10.6);
        self.add_wall("hall south wall", plaster, &south, &[], [true, false]);
        let west = wall(Vec3::new(-5.0, 0.0, 0.0), Vec3::Z, Vec3::NEG_X, 7.0);
        self.add_wall("hall west wall", plaster, &west, &[], [true, false]);
        let east = wall(Vec3::new(5.0, 0.0, 0.0), Vec3::Z, Vec3::X, 7.0);
        self.add_wall("hall east wall", plaster, &east, &[], [true, false]);
        let mut cornice = Mesh::default();
        for (wall, span) in [
            (&north, [0.3, 10.3]),
            (&south, [0.3, 10.3]),
            (&west, [0.0, 7.0]),
            (&east, [0.0, 7.0]),
        ] {
            wall.add_cornice(&mut cornice, HALL_HEIGHT - 0.3, true, span);
        }
        self.part("hall cornice", self.palette.trim, cornice);
        // The entrance: two panelled leaves in the south wall.
        let mut door = Mesh::default();
        for left in [-1.1, 0.01] {
            let z = room.max.z;
            door.cuboid(
                Vec3::new(left, 0.0, z - 0.05),
                Vec3::new(left + 1.09, 2.9, z - 0.005),
            );
            for (bottom, top) in [(0.2, 0.9), (1.05, 2.0), (2.15, 2.75)] {
                door.cuboid(
                    Vec3::new(left + 0.15, bottom, z - 0.075),
                    Vec3::new(left + 0.94, top, z - 0.05),
                );
            }
        }
        // A window over it, with the last of the day behind.
        for (from, to) in [(-1.1, -0.04), (0.04, 1.1)] {
            let corner = Vec3::new(from, 3.15, room.max.z - 0.02);
            self.panel(
                "fanlight",
                corner,
                1.1 * Vec3::Y,
                (to - from) * Vec3::X,
                3.5 * COOL,
            );
        }
        for x in [-1.14, -0.04, 1.1] {
            let z = room.max.z;
            door.cuboid(Vec3::new(x, 3.0, z - 0.07), Vec3::new(x + 0.08, 4.3, z));
        }
        self.part("entrance door", self.palette.wood, door);
    }

    fn add_vase_on_stand(&mut self, index: u32, foot: Vec3) {
        let mut stand = Mesh::default();
        stand.cuboid(
            foot + Vec3::new(-0.2, 0.0, -0.2),
            foot + Vec3::new(0.2, 0.9, 0.2),
        );
        stand.cuboid(
            foot + Vec3::new(-0.24, 0.9, -0.24),
            foot + Vec3::new(0.24, 0.95, 0.24),
        );
        self.part(format!("hall stand {index}"), self.palette.limestone, stand);
        let material = if index.is_multiple_of(2) {
            self.palette.celadon
        } else {
            self.palette.bronze
        };
        self.add_vase(
            &format!("hall vase {index}"),
            foot + 0.951 * Vec3::Y,
            index,
            material,
        );
    }

    pub(super) fn add_corridor(&mut self) {
        let room = Room::new([-1.6, 1.6], [-8.0, -0.3], CORRIDOR_HEIGHT);
        self.add_slabs("corridor", room, self.palette.planks);
        let mut beams = Mesh::default();
        for index in 0..7 {
            let z = -0.9 - 1.1 * index as f32;
            beams.cuboid(
                Vec3::new(-1.6, CORRIDOR_HEIGHT - 0.2, z - 0.09),
                Vec3::new(1.6, CORRIDOR_HEIGHT, z + 0.09),
            );
        }
        self.part("corridor beams", self.palette.wood, beams);
        for (side, sign) in [("west", -1.0), ("east", 1.0)] {
            self.add_corridor_side(side, sign);
        }
        for (index, z) in [-1.45, -4.5, -7.35].into_iter().enumerate() {
            let place = Vec3::new(0.0, 2.62, z);
            self.add_pendant(
                &format!("corridor pendant {index}"),
                place,
                CORRIDOR_HEIGHT,
                3.2 * WARM,
            );
        }
    }

    /// One long wall: a door, two arched niches with a vase each, two benches.
    fn add_corridor_side(&mut self, side: &str, sign: f32) {
        const NICHES: [f32; 2] = [-2.35, -6.65];
        let wall = Wall {
            origin: Vec3::new(1.6 * sign, 0.0, -8.3),
            along: Vec3::Z,
            through: sign * Vec3::X,
            length: 8.0,
            height: 4.0,
            thickness: 0.3,
        };
        let niche = |z: f32| Opening {
            sill: 0.85,
            ..Opening::arch(z + 8.3, 0.9, 2.25)
        };
        let door = Opening::door(GALLERY_DOOR_Z + 8.3, 1.5, 2.5);
        let openings = [niche(NICHES[1]), door, niche(NICHES[0])];
        let material = self.palette.plaster;
        self.add_wall(
            &format!("corridor {side} wall"),
            material,
            &wall,
            &openings,
            [true, true],
        );
        let mut backs = Mesh::default();
        for (index, z) in NICHES.into_iter().enumerate() {
            let x = sign * 1.84;
            backs.block(
                Vec3::new(x, 0.85, z - 0.45),
                sign * 0.055 * Vec3::X,
                1.4 * Vec3::Y,
                0.9 * Vec3::Z,
            );
            let foot = Vec3::new(sign * 1.68, 0.851, z);
            let number = index as u32 + u32::from(sign > 0.0);
            let material = if number == 1 {
                self.palette.celadon
            } else {
                self.palette.marble
            };
            self.add_small_vase(
                &format!("{side} niche vase {index}"),
                foot,
                number,
                material,
            );
            let lamp = Vec3::new(sign * 1.30, CORRIDOR_HEIGHT - 0.25, z);
            let target = Vec3::new(sign * 1.72, 1.1, z);
            let name = format!("{side} niche spot {index}");
            self.add_spot(
                &name,
                lamp,
                target,
                10.0 * WARM,
                [11.0, 22.0],
                lamp + 0.25 * Vec3::Y,
            );
        }
        self.part(
            format!("corridor {side} niche backs"),
            self.palette.green_wall,
            backs,
        );
        for (index, z) in [-3.4, -5.6].into_iter().enumerate() {
            let at = Vec3::new(sign * 1.32, 0.0, z + if index == 0 { 0.95 } else { -0.95 });
            self.add_bench(&format!("corridor bench {side} {index}"), at, Vec3::Z, 1.2);
        }
    }

    fn add_small_vase(&mut self, name: &str, foot: Vec3, shape: u32, material: u32) {
        self.add_vase(name, foot, shape, material);
        let Some(part) = self.draft.parts.last_mut() else {
            return;
        };
        for vertex in &mut part.vertices {
            vertex.position = foot + 0.62 * (vertex.position - foot);
        }
    }
}
