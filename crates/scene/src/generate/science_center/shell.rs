//! Floors, walls and columns.

use glam::{Vec2, Vec3};

use super::{
    BACK, BALCONY, BALCONY_EDGE, CEILING, FRONT, GALLERY, GALLERY_EDGE, SIDE, SLAB, Site, cuboid,
    stairs::GALLERY_WELL, tiling::Field,
};
use crate::generate::{mesh::Mesh, shapes::lathe};

/// Sides of a column: few, since its shadow is asked for with all of them.
const COLUMN_SIDES: u32 = 8;

/// A rectangle on the floor: from and to along x, from and to along z.
type Plan = [[f32; 2]; 2];

impl Site {
    pub(super) fn add_shell(&mut self) {
        let floor = Field {
            corner: Vec3::new(-SIDE, 0.0, BACK),
            u: (FRONT - BACK) * Vec3::Z,
            v: 2.0 * SIDE * Vec3::X,
        };
        let dark = |row: u32, column: u32| usize::from((row + 2 * column).is_multiple_of(5));
        self.add_tiles("floor", self.palette.terrazzo, &[floor], dark);
        let [edge, back] = BALCONY_EDGE;
        self.add_storey(
            "balcony",
            BALCONY,
            &[
                [[-SIDE, -edge], [BACK, FRONT]],
                [[edge, SIDE], [BACK, FRONT]],
                [[-edge, edge], [BACK, back]],
            ],
        );
        let [edge, back] = GALLERY_EDGE;
        let [well_x, well_z] = GALLERY_WELL;
        self.add_storey(
            "gallery",
            GALLERY,
            &[
                [[-SIDE, -edge], [BACK, FRONT]],
                [[edge, SIDE], [BACK, FRONT]],
                [[-edge, edge], [well_z[1], back]],
                [[-edge, well_x[0]], [BACK, well_z[1]]],
                [[well_x[1], edge], [BACK, well_z[1]]],
            ],
        );
        self.add_walls();
        self.add_posters();
    }

    /// An upper floor: carpet, a white edge, slats below. Few triangles, since each of them
    /// may be in the way from below.
    fn add_storey(&mut self, name: &str, height: f32, plans: &[Plan]) {
        let [mut carpet, mut edge, mut soffit] = std::array::from_fn(|_| Mesh::default());
        for [x, z] in plans {
            let size = Vec3::new(x[1] - x[0], 0.0, z[1] - z[0]);
            let (along_x, along_z) = (size.x * Vec3::X, size.z * Vec3::Z);
            let corner = Vec3::new(x[0], height, z[0]);
            let low = corner - SLAB * Vec3::Y;
            carpet.quad(corner, along_z, along_x);
            soffit.quad(low, along_x, along_z);
            let up = SLAB * Vec3::Y;
            edge.quad(low, along_z, up);
            edge.quad(low + along_x, up, along_z);
            edge.quad(low, up, along_x);
            edge.quad(low + along_z, along_x, up);
        }
        self.part(format!("{name} floor"), self.palette.carpet, carpet);
        self.part(format!("{name} edge"), self.palette.column, edge);
        self.part(format!("{name} soffit"), self.palette.soffit, soffit);
    }

    /// Panels on all four sides, and oak below them along the sides.
    fn add_walls(&mut self) {
        let (width, depth) = (2.0 * SIDE * Vec3::X, (FRONT - BACK) * Vec3::Z);
        let up = CEILING * Vec3::Y;
        let field = |x: f32, z: f32, u: Vec3, v: Vec3| Field {
            corner: Vec3::new(x, 0.0, z),
            u,
            v,
        };
        let own = self.key.mix(20);
        let scattered = |u: u32, v: u32| {
            let pick = own.mix(u64::from(u)).mix(u64::from(v)).uniform(0);
            usize::from(pick < 0.3)
        };
        let sides = [
            field(-SIDE, BACK, up, depth),
            field(SIDE, BACK, depth, up),
            field(-SIDE, FRONT, up, width),
        ];
        self.add_tiles("walls", self.palette.plaster, &sides, scattered);
        let back = [field(-SIDE, BACK, width, up)];
        self.add_tiles("back wall", self.palette.accent, &back, scattered);
        let mut panels = Mesh::default();
        for sign in [-1.0, 1.0] {
            cuboid(
                &mut panels,
                [sign * (SIDE - 0.04), 0.0, BACK],
                [sign * (SIDE + 0.1), 1.15, FRONT],
            );
        }
        self.part("wainscot", self.palette.oak, panels);
        self.add_entrance();
    }

    /// Two oak doors in a steel frame in the back wall.
    fn add_entrance(&mut self) {
        let (mut frame, mut doors) = (Mesh::default(), Mesh::default());
        for sign in [-1.0, 1.0] {
            cuboid(
                &mut frame,
                [sign * 1.5, 0.0, BACK - 0.05],
                [sign * 1.62, 2.7, BACK + 0.08],
            );
            cuboid(
                &mut doors,
                [sign * 0.01, 0.01, BACK - 0.05],
                [sign * 1.5, 2.58, BACK + 0.04],
            );
            cuboid(
                &mut frame,
                [sign * 0.12, 0.9, BACK],
                [sign * 0.16, 1.5, BACK + 0.10],
            );
        }
        cuboid(
            &mut frame,
            [-1.5, 2.58, BACK - 0.05],
            [1.5, 2.7, BACK + 0.08],
        );
        self.part("entrance frame", self.palette.steel, frame);
        self.part("entrance doors", self.palette.oak, doors);
    }

    /// Columns with eight sides from floor to ceiling.
    pub(super) fn add_columns(&mut self) {
        let mut mesh = Mesh::default();
        let shaft = lathe(
            &[[0.26, 0.0], [0.26, CEILING]].map(Vec2::from),
            COLUMN_SIDES,
        );
        for (x, z) in column_feet() {
            mesh.add(&shaft, glam::Quat::IDENTITY, Vec3::new(x, 0.0, z));
        }
        self.part("columns", self.palette.column, mesh);
    }

    fn add_posters(&mut self) {
        const SIZE: [f32; 2] = [1.6, 2.2];
        let places = [
            (-1.0, -6.2, 0.0),
            (-1.0, 0.6, 0.0),
            (-1.0, 7.2, 0.0),
            (1.0, -6.2, BALCONY),
            (1.0, 0.6, BALCONY),
            (1.0, 7.2, BALCONY),
        ];
        let materials = self.palette.posters.clone();
        let mut frames = Mesh::default();
        for ((sign, z, floor), (number, material)) in
            places.into_iter().zip(materials.into_iter().enumerate())
        {
            let (x, half, low) = (sign * (SIDE - 0.05), 0.5 * SIZE[0], floor + 1.3);
            let along = -sign * Vec3::Z;
            // The image's first row is on top, hence the way down and the other way round.
            let corner = Vec3::new(x, low + SIZE[1], z) + half * along;
            let mut poster = Mesh::default();
            let (back, down) = (-SIZE[0] * along, -SIZE[1] * Vec3::Y);
            poster.textured_quad(corner, back, down, Vec2::new(-1.0, 1.0));
            self.part(format!("poster {number}"), material, poster);
            cuboid(
                &mut frames,
                [sign * (SIDE - 0.04), low - 0.06, z - half - 0.06],
                [sign * (SIDE + 0.1), low + SIZE[1] + 0.06, z + half + 0.06],
            );
        }
        self.part("poster frames", self.palette.steel, frames);
    }
}

/// Where columns stand.
pub(super) fn column_feet() -> impl Iterator<Item = (f32, f32)> {
    let sides = [-8.6, -2.9, 2.8, 8.5]
        .into_iter()
        .flat_map(|z| [(-8.2, z), (8.2, z)]);
    sides.chain([(-4.2, -12.0), (4.2, -12.0)])
}
