//! Walls with openings, floors, ceilings, skirting.

use std::f32::consts::PI;

use glam::Vec3;

use super::Site;
use crate::generate::mesh::Mesh;

/// A hole in a wall, from the floor up.
#[derive(Clone, Copy)]
pub(super) struct Opening {
    /// Middle, in metres along the wall.
    pub(super) center: f32,
    pub(super) width: f32,
    /// Height of the top.
    pub(super) height: f32,
    /// Height of the lower edge: 0 is a door.
    pub(super) sill: f32,
    /// Whether a half circle closes it above.
    pub(super) is_arched: bool,
}

impl Opening {
    pub(super) fn door(center: f32, width: f32, height: f32) -> Self {
        Self {
            center,
            width,
            height,
            sill: 0.0,
            is_arched: false,
        }
    }

    pub(super) fn arch(center: f32, width: f32, height: f32) -> Self {
        Self {
            is_arched: true,
            ..Self::door(center, width, height)
        }
    }
}

/// A wall along one direction, with its thickness to one side.
pub(super) struct Wall {
    /// Lower corner at its beginning.
    pub(super) origin: Vec3,
    /// Unit vector along it.
    pub(super) along: Vec3,
    /// Unit vector through it.
    pub(super) through: Vec3,
    pub(super) length: f32,
    pub(super) height: f32,
    pub(super) thickness: f32,
}

const SKIRTING: (f32, f32) = (0.16, 0.022);
const ARCH_STEPS: u32 = 24;

impl Wall {
    fn at(&self, along: f32, up: f32, through: f32) -> Vec3 {
        self.origin + along * self.along + up * Vec3::Y + through * self.through
    }

    fn block(&self, mesh: &mut Mesh, along: [f32; 2], up: [f32; 2], through: [f32; 2]) {
        if along[1] - along[0] > 1.0e-4 && up[1] - up[0] > 1.0e-4 {
            mesh.block(
                self.at(along[0], up[0], through[0]),
                (along[1] - along[0]) * self.along,
                (up[1] - up[0]) * Vec3::Y,
                (through[1] - through[0]) * self.through,
            );
        }
    }

    /// The wall with openings in order along it, none overlapping.
    pub(super) fn mesh(&self, openings: &[Opening]) -> Mesh {
        let mut mesh = Mesh::default();
        let through = [0.0, self.thickness];
        let mut begin = 0.0;
        for opening in openings {
            let (left, right) = (
                opening.center - 0.5 * opening.width,
                opening.center + 0.5 * opening.width,
            );
            self.block(&mut mesh, [begin, left], [0.0, self.height], through);
            self.block(&mut mesh, [left, right], [0.0, opening.sill], through);
            self.block(
                &mut mesh,
                [left, right],
                [opening.height, self.height],
                through,
            );
            if opening.is_arched {
                self.add_arch(&mut mesh, opening);
            }
            begin = right;
        }
        self.block(&mut mesh, [begin, self.length], [0.0, self.height], through);
        mesh
    }

    /// What fills the corners between a half circle and the square around it.
    fn add_arch(&self, mesh: &mut Mesh, opening: &Opening) {
        let radius = 0.5 * opening.width;
        let spring = opening.height - radius;
        let corner = |step: u32, through: f32| {
            let (sin, cos) = (PI * step as f32 / ARCH_STEPS as f32).sin_cos();
            self.at(
                opening.center + radius * cos,
                spring + radius * sin,
                through,
            )
        };
        let above = |point: Vec3| Vec3::new(point.x, self.origin.y + opening.height, point.z);
        for step in 0..ARCH_STEPS {
            let (a, b) = (corner(step, 0.0), corner(step + 1, 0.0));
            let (far_a, far_b) = (
                corner(step, self.thickness),
                corner(step + 1, self.thickness),
            );
            mesh.quadrangle([a, above(a), above(b), b]);
            mesh.quadrangle([far_b, above(far_b), above(far_a), far_a]);
            mesh.quadrangle([a, b, far_b, far_a]);
        }
    }

    /// A strip along the foot of the wall, left out at doors; `near` is the side of the origin.
    pub(super) fn add_skirting(&self, mesh: &mut Mesh, openings: &[Opening], near: bool) {
        let (height, depth) = SKIRTING;
        let through = if near {
            [-depth, 0.0]
        } else {
            [self.thickness, self.thickness + depth]
        };
        let mut begin = 0.0;
        for opening in openings.iter().filter(|opening| opening.sill < height) {
            self.block(
                mesh,
                [begin, opening.center - 0.5 * opening.width - 0.12],
                [0.0, height],
                through,
            );
            begin = opening.center + 0.5 * opening.width + 0.12;
        }
        self.block(mesh, [begin, self.length], [0.0, height], through);
    }

    /// A moulding round each rectangular door, on both sides of the wall.
    pub(super) fn add_casing(&self, mesh: &mut Mesh, openings: &[Opening]) {
        const WIDTH: f32 = 0.12;
        for door in openings
            .iter()
            .filter(|opening| opening.sill == 0.0 && !opening.is_arched)
        {
            let (left, right) = (
                door.center - 0.5 * door.width,
                door.center + 0.5 * door.width,
            );
            for through in [[-0.035, 0.0], [self.thickness, self.thickness + 0.035]] {
                self.block(
                    mesh,
                    [left - WIDTH, left],
                    [0.0, door.height + WIDTH],
                    through,
                );
                self.block(
                    mesh,
                    [right, right + WIDTH],
                    [0.0, door.height + WIDTH],
                    through,
                );
                self.block(
                    mesh,
                    [left, right],
                    [door.height, door.height + WIDTH],
                    through,
                );
            }
        }
    }

    /// A cornice along the top of a room of the given height.
    pub(super) fn add_cornice(
        &self,
        mesh: &mut Mesh,
        room_height: f32,
        near: bool,
        span: [f32; 2],
    ) {
        for (drop, depth) in [(0.10, 0.09), (0.17, 0.05)] {
            let through = if near {
                [-depth, 0.0]
            } else {
                [self.thickness, self.thickness + depth]
            };
            self.block(mesh, span, [room_height - drop, room_height], through);
        }
    }
}

/// A room's inner size: floor corners and height.
#[derive(Clone, Copy)]
pub(super) struct Room {
    pub(super) min: Vec3,
    pub(super) max: Vec3,
}

impl Room {
    pub(super) fn new(x: [f32; 2], z: [f32; 2], height: f32) -> Self {
        Self {
            min: Vec3::new(x[0], 0.0, z[0]),
            max: Vec3::new(x[1], height, z[1]),
        }
    }

    pub(super) fn size(&self) -> Vec3 {
        self.max - self.min
    }
}

impl Site {
    /// A floor and a ceiling that reach under the walls.
    pub(super) fn add_slabs(&mut self, name: &str, room: Room, floor: u32) {
        const REACH: f32 = 0.15;
        let (min, max) = (room.min - Vec3::splat(REACH), room.max + Vec3::splat(REACH));
        let mut mesh = Mesh::default();
        let size = max - min;
        mesh.quad(
            Vec3::new(min.x, 0.0, min.z),
            size.z * Vec3::Z,
            size.x * Vec3::X,
        );
        self.part(format!("{name} floor"), floor, mesh);
        let mut mesh = Mesh::default();
        mesh.cuboid(
            Vec3::new(min.x, room.max.y, min.z),
            Vec3::new(max.x, room.max.y + 0.2, max.z),
        );
        let ceiling = self.palette.ceiling;
        self.part(format!("{name} ceiling"), ceiling, mesh);
    }

    /// Beams both ways below the ceiling, which leave square coffers.
    pub(super) fn add_coffers(&mut self, name: &str, room: Room, counts: [u32; 2], depth: f32) {
        const WIDTH: f32 = 0.22;
        let (top, bottom) = (room.max.y, room.max.y - depth);
        let mut mesh = Mesh::default();
        for i in 0..=counts[0] {
            let x = room.min.x + room.size().x * i as f32 / counts[0] as f32;
            let (left, right) = (
                (x - 0.5 * WIDTH).max(room.min.x),
                (x + 0.5 * WIDTH).min(room.max.x),
            );
            mesh.cuboid(
                Vec3::new(left, bottom, room.min.z),
                Vec3::new(right, top, room.max.z),
            );
        }
        for i in 0..=counts[1] {
            let z = room.min.z + room.size().z * i as f32 / counts[1] as f32;
            let (near, far) = (
                (z - 0.5 * WIDTH).max(room.min.z),
                (z + 0.5 * WIDTH).min(room.max.z),
            );
            // A little less deep: two faces in one plane would fight.
            mesh.cuboid(
                Vec3::new(room.min.x, bottom + 0.02, near),
                Vec3::new(room.max.x, top, far),
            );
        }
        let ceiling = self.palette.ceiling;
        self.part(format!("{name} coffers"), ceiling, mesh);
    }

    /// A wall in one material, with skirting on the sides that ask for it, and door casings.
    pub(super) fn add_wall(
        &mut self,
        name: &str,
        material: u32,
        wall: &Wall,
        openings: &[Opening],
        sides: [bool; 2],
    ) {
        self.part(name, material, wall.mesh(openings));
        let mut trim = Mesh::default();
        for (near, wanted) in [true, false].into_iter().zip(sides) {
            if wanted {
                wall.add_skirting(&mut trim, openings, near);
            }
        }
        wall.add_casing(&mut trim, openings);
        if !trim.triangles.is_empty() {
            let material = self.palette.trim;
            self.part(format!("{name} trim"), material, trim);
        }
    }
}
