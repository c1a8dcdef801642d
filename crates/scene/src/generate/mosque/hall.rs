//! Floor, walls and roof.

use glam::Vec3;

use super::{
    AISLE, ARCADE_TOP, CEILING, FRONT_WALL, MIHRAB_WALL, NAVE_HALF, SIDE_WALL, Site, arcade_x,
};
use crate::generate::mesh::Mesh;

/// Height of the stone dado along the walls.
const DADO: f32 = 1.15;
/// How far floor and roof reach under and over the walls.
const REACH: f32 = 0.2;

impl Site {
    pub(super) fn add_shell(&mut self) {
        let (back, front) = (MIHRAB_WALL - REACH - 2.0, FRONT_WALL + REACH);
        let depth = (front - back) * Vec3::Z;
        let outside = SIDE_WALL + REACH;
        for (name, material, from, to) in [
            ("west floor", self.palette.floor, -outside, -NAVE_HALF),
            ("nave floor", self.palette.nave_floor, -NAVE_HALF, NAVE_HALF),
            ("east floor", self.palette.floor, NAVE_HALF, outside),
        ] {
            let mut mesh = Mesh::default();
            mesh.quad(Vec3::new(from, 0.0, back), depth, (to - from) * Vec3::X);
            // The pattern is laid from the middle of the nave.
            for vertex in &mut mesh.vertices {
                vertex.uv = glam::Vec2::new(vertex.position.z, vertex.position.x);
            }
            self.part(name, material, mesh);
        }
        self.add_side_walls();
    }

    fn add_side_walls(&mut self) {
        let length = FRONT_WALL - MIHRAB_WALL;
        let (mut walls, mut dado, mut trim) = (Mesh::default(), Mesh::default(), Mesh::default());
        for sign in [-1.0, 1.0] {
            let x = sign * SIDE_WALL;
            let strip = |mesh: &mut Mesh, depth: f32, up: [f32; 2]| {
                let (near, far) = (x - sign * depth, x + sign * REACH);
                mesh.cuboid(
                    Vec3::new(near.min(far), up[0], MIHRAB_WALL),
                    Vec3::new(near.max(far), up[1], MIHRAB_WALL + length),
                );
            };
            strip(&mut walls, 0.0, [0.0, CEILING + REACH]);
            strip(&mut dado, 0.02, [0.0, DADO]);
            strip(&mut trim, 0.05, [DADO, DADO + 0.12]);
        }
        self.part("side walls", self.palette.plaster, walls);
        self.part("side dado", self.palette.panel, dado);
        self.part("side trim", self.palette.marble, trim);
    }

    /// Boards, beams across every aisle with brackets under their ends, and a cornice along
    /// each arcade that carries them.
    pub(super) fn add_roof(&mut self) {
        let length = FRONT_WALL - MIHRAB_WALL;
        let mut boards = Mesh::default();
        boards.cuboid(
            Vec3::new(-SIDE_WALL - REACH, CEILING, MIHRAB_WALL - REACH),
            Vec3::new(SIDE_WALL + REACH, CEILING + 0.1, FRONT_WALL + REACH),
        );
        for vertex in &mut boards.vertices {
            vertex.uv = glam::Vec2::new(vertex.position.x, vertex.position.z);
        }
        self.part("roof boards", self.palette.boards, boards);
        let mut cornice = Mesh::default();
        for x in arcade_x() {
            for (half, up) in [
                (0.36, [ARCADE_TOP - 0.02, ARCADE_TOP + 0.08]),
                (0.42, [ARCADE_TOP + 0.08, ARCADE_TOP + 0.16]),
                (0.31, [ARCADE_TOP + 0.16, CEILING]),
            ] {
                cornice.cuboid(
                    Vec3::new(x - half, up[0], MIHRAB_WALL - 0.05),
                    Vec3::new(x + half, up[1], MIHRAB_WALL + length + 0.05),
                );
            }
        }
        self.part("roof cornices", self.palette.limestone, cornice);
        let rows: Vec<f32> = arcade_x().collect();
        for (aisle, pair) in rows.windows(2).enumerate() {
            self.add_beams(aisle, [pair[0] + 0.3, pair[1] - 0.3]);
        }
    }

    fn add_beams(&mut self, aisle: usize, span: [f32; 2]) {
        const COUNT: u32 = 40;
        let mut beams = Mesh::default();
        let length = FRONT_WALL - MIHRAB_WALL;
        for index in 0..COUNT {
            let z = MIHRAB_WALL + length * (index as f32 + 0.5) / COUNT as f32;
            let mut piece = |x: [f32; 2], up: [f32; 2], half: f32| {
                beams.cuboid(
                    Vec3::new(x[0], up[0], z - half),
                    Vec3::new(x[1], up[1], z + half),
                );
            };
            let top = CEILING + 0.02;
            piece(span, [CEILING - 0.28, top], 0.11);
            // Brackets in two steps under both ends.
            for (reach, low) in [(0.55, 0.37), (0.34, 0.45)] {
                piece([span[0], span[0] + reach], [CEILING - low, top], 0.085);
                piece([span[1] - reach, span[1]], [CEILING - low, top], 0.085);
            }
        }
        self.part(format!("beams {aisle}"), self.palette.beam, beams);
    }

    /// Width of the widest aisle's wall between two arcades.
    pub(super) fn aisle_half(middle: f32) -> f32 {
        if middle.abs() < 0.1 {
            NAVE_HALF - 0.3
        } else {
            0.5 * AISLE - 0.3
        }
    }
}
