//! The two picture galleries, mirror images but for colours and pictures.

use glam::{Vec2, Vec3};

use super::{
    COOL, NEUTRAL, Site, WARM,
    fittings::Hanging,
    hall::GALLERY_DOOR_Z,
    walls::{Room, Wall},
};
use crate::generate::mesh::Mesh;

const HEIGHT: f32 = 4.0;

impl Site {
    pub(super) fn add_galleries(&mut self) {
        self.add_gallery(
            "west gallery",
            -1.0,
            self.palette.green_wall,
            self.palette.planks,
        );
        self.add_gallery(
            "east gallery",
            1.0,
            self.palette.red_wall,
            self.palette.glossy_planks,
        );
    }

    fn add_gallery(&mut self, name: &str, sign: f32, wall_material: u32, floor: u32) {
        let x = [1.9 * sign, 9.0 * sign];
        let room = Room::new([x[0].min(x[1]), x[0].max(x[1])], [-8.0, -1.0], HEIGHT);
        self.add_slabs(name, room, floor);
        self.add_gallery_walls(name, sign, wall_material);
        self.add_lining(name, sign, wall_material);

        // The skylight: a lit panel in a frame of beams.
        let center = Vec3::new(5.45 * sign, HEIGHT - 0.03, -4.5);
        let half = Vec3::new(1.3, 0.0, 0.8);
        let radiance = if sign < 0.0 {
            5.0 * COOL
        } else {
            4.2 * NEUTRAL
        };
        self.panel(
            &format!("{name} skylight"),
            center - half,
            2.0 * half.x * Vec3::X,
            2.0 * half.z * Vec3::Z,
            radiance,
        );
        self.add_skylight_frame(name, center, half);
        self.add_coves(name, room);
        self.add_pictures(sign);
        self.add_bench(
            &format!("{name} bench"),
            Vec3::new(5.6 * sign, 0.0, -4.5),
            Vec3::Z,
            1.8,
        );
        self.add_barrier(name, sign);
    }

    fn add_gallery_walls(&mut self, name: &str, sign: f32, material: u32) {
        let side = Wall {
            origin: Vec3::new(9.0 * sign, 0.0, -8.3),
            along: Vec3::Z,
            through: sign * Vec3::X,
            length: 7.6,
            height: HEIGHT,
            thickness: 0.3,
        };
        self.add_wall(
            &format!("{name} outer wall"),
            material,
            &side,
            &[],
            [true, false],
        );
        let south = Wall {
            origin: Vec3::new(1.9 * sign, 0.0, -1.0),
            along: sign * Vec3::X,
            through: Vec3::Z,
            length: 7.1,
            height: HEIGHT,
            thickness: 0.3,
        };
        self.add_wall(
            &format!("{name} south wall"),
            material,
            &south,
            &[],
            [true, false],
        );
    }

    /// Colour on the walls that belong to other rooms: thin panels before them.
    fn add_lining(&mut self, name: &str, sign: f32, material: u32) {
        const DEPTH: f32 = 0.012;
        let mut mesh = Mesh::default();
        let inner = 1.9 * sign;
        for (z, height) in [
            ([-8.0, GALLERY_DOOR_Z - 0.87], 0.0),
            ([GALLERY_DOOR_Z + 0.87, -1.0], 0.0),
            ([GALLERY_DOOR_Z - 0.87, GALLERY_DOOR_Z + 0.87], 2.62),
        ] {
            mesh.block(
                Vec3::new(inner, height, z[0]),
                sign * DEPTH * Vec3::X,
                (HEIGHT - height) * Vec3::Y,
                (z[1] - z[0]) * Vec3::Z,
            );
        }
        let door = 5.2;
        for (x, height) in [
            ([1.9, door - 0.87], 0.0),
            ([door + 0.87, 9.0], 0.0),
            ([door - 0.87, door + 0.87], 2.62),
        ] {
            mesh.block(
                Vec3::new(sign * x[0], height, -8.0),
                sign * (x[1] - x[0]) * Vec3::X,
                (HEIGHT - height) * Vec3::Y,
                DEPTH * Vec3::Z,
            );
        }
        self.part(format!("{name} lining"), material, mesh);
    }

    fn add_skylight_frame(&mut self, name: &str, center: Vec3, half: Vec3) {
        let mut mesh = Mesh::default();
        let (drop, width) = (0.14, 0.12);
        let outer = half + Vec3::new(width, 0.0, width);
        for sign in [-1.0, 1.0] {
            let z = center.z + sign * (half.z + 0.5 * width);
            mesh.cuboid(
                Vec3::new(center.x - outer.x, HEIGHT - drop, z - 0.5 * width),
                Vec3::new(center.x + outer.x, HEIGHT, z + 0.5 * width),
            );
            let x = center.x + sign * (half.x + 0.5 * width);
            mesh.cuboid(
                Vec3::new(x - 0.5 * width, HEIGHT - drop, center.z - half.z),
                Vec3::new(x + 0.5 * width, HEIGHT, center.z + half.z),
            );
        }
        // Glazing bars, clear of the panel, which throw soft stripes.
        for index in 1..4 {
            let x = center.x - half.x + half.x * index as f32 / 2.0;
            mesh.cuboid(
                Vec3::new(x - 0.02, HEIGHT - drop, center.z - half.z),
                Vec3::new(x + 0.02, HEIGHT - 0.08, center.z + half.z),
            );
        }
        self.part(format!("{name} skylight frame"), self.palette.trim, mesh);
    }

    /// A ledge along the two long walls with a strip of light on it that washes the ceiling.
    fn add_coves(&mut self, name: &str, room: Room) {
        let mut ledges = Mesh::default();
        let (top, depth) = (HEIGHT - 0.62, 0.22);
        for (index, x) in [room.min.x, room.max.x - depth].into_iter().enumerate() {
            let corner = Vec3::new(x, top, room.min.z);
            ledges.cuboid(
                corner - 0.06 * Vec3::Y,
                corner + Vec3::new(depth, 0.0, room.size().z),
            );
            // The lip that hides the strip from below.
            let lip = if index == 0 { x + depth - 0.03 } else { x };
            ledges.cuboid(
                Vec3::new(lip, top, room.min.z),
                Vec3::new(lip + 0.03, top + 0.018, room.max.z),
            );
            let strip = Vec3::new(x + 0.08, top + 0.015, room.min.z + 0.4);
            let along = (room.size().z - 0.8) * Vec3::Z;
            self.panel(
                &format!("{name} cove {index}"),
                strip,
                along,
                0.06 * Vec3::X,
                34.0 * WARM,
            );
        }
        self.part(format!("{name} cornice"), self.palette.trim, ledges);
    }

    fn add_pictures(&mut self, sign: f32) {
        let first = if sign < 0.0 { 0 } else { 7 };
        let outer = 9.0 * sign;
        let inner = 1.9 * sign + 0.012 * sign;
        let inwards = -sign * Vec3::X;
        let hang = |center: Vec3, normal: Vec3, width: f32, height: f32| Hanging {
            center,
            normal,
            size: Vec2::new(width, height),
        };
        let (tall, wide, small) = ([1.1, 1.5], [1.9, 1.3], [0.8, 1.0]);
        let sizes = if sign < 0.0 {
            [tall, wide, tall]
        } else {
            [wide, tall, wide]
        };
        let mut pictures = Vec::new();
        for (z, [width, height]) in [-6.7, -4.5, -2.3].into_iter().zip(sizes) {
            pictures.push(hang(Vec3::new(outer, 1.65, z), inwards, width, height));
        }
        for x in [3.9, 7.0] {
            pictures.push(hang(
                Vec3::new(sign * x, 1.65, -1.0),
                Vec3::NEG_Z,
                wide[0],
                wide[1],
            ));
        }
        for z in [-6.6, -2.4] {
            pictures.push(hang(Vec3::new(inner, 1.6, z), -inwards, small[0], small[1]));
        }
        for (index, picture) in pictures.iter().enumerate() {
            let intensity = 8.0 + 2.2 * picture.size.x;
            self.add_picture(first + index as u32, picture, HEIGHT, intensity);
        }
    }

    /// Posts with a rail before the outer wall's pictures.
    fn add_barrier(&mut self, name: &str, sign: f32) {
        use crate::generate::shapes::rod;
        let x = 8.1 * sign;
        let mut mesh = Mesh::default();
        let posts = [-7.4, -5.6, -3.4, -1.6];
        for z in posts {
            let foot = Vec3::new(x, 0.0, z);
            mesh.add(
                &rod(foot, foot + 0.03 * Vec3::Y, 0.12, 20),
                glam::Quat::IDENTITY,
                Vec3::ZERO,
            );
            mesh.add(
                &rod(foot, foot + 0.75 * Vec3::Y, 0.02, 12),
                glam::Quat::IDENTITY,
                Vec3::ZERO,
            );
        }
        for pair in posts.windows(2).filter(|pair| pair[1] - pair[0] < 2.0) {
            let at = |z: f32| Vec3::new(x, 0.71, z);
            mesh.add(
                &rod(at(pair[0]), at(pair[1]), 0.014, 10),
                glam::Quat::IDENTITY,
                Vec3::ZERO,
            );
        }
        self.part(format!("{name} barrier"), self.palette.brass, mesh);
    }
}
