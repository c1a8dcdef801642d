//! Floors, walls, ceilings, columns, and the glass that is the one light.

use glam::{Vec2, Vec3};

use super::{
    BACK, BALCONY, BALCONY_EDGE, CEILING, FRONT, GALLERY, GALLERY_EDGE, SIDE, SLAB, Site, cuboid,
    stairs::GALLERY_WELL,
};
use crate::{
    Material,
    generate::{mesh::Mesh, shapes::lathe},
};

/// The roof's opening: half its width, and where it begins and ends along z.
const ROOF_HALF: f32 = 6.6;
const ROOF_Z: [f32; 2] = [-9.0, 11.6];
/// Height of the glass roof above the ceiling around it.
const LANTERN: f32 = 0.9;
/// The glass front: half its width, and its lower and upper edge.
const FRONT_HALF: f32 = 6.0;
const FRONT_Y: [f32; 2] = [0.7, 11.4];
/// The windows beside it: from and to along x, from the side wall, and heights above the floor.
const SIDE_WINDOW: [f32; 2] = [0.8, 3.0];
const WINDOW_Y: [f32; 2] = [0.7, 3.3];
/// What the sky gives, in W·sr⁻¹·m⁻².
const DAYLIGHT: Vec3 = Vec3::new(3.9, 3.85, 3.75);
/// How far the glass stands before its frame.
const PROUD: f32 = 0.012;
/// How thick the walls are.
const WALL: f32 = 0.3;

/// A rectangle on the floor: from and to along x, from and to along z.
type Plan = [[f32; 2]; 2];

impl Site {
    pub(super) fn add_shell(&mut self) {
        let mut floor = Mesh::default();
        let (width, depth) = (2.0 * (SIDE + WALL), FRONT - BACK + 2.0 * WALL);
        let corner = Vec3::new(-SIDE - WALL, 0.0, BACK - WALL);
        floor.quad(corner, depth * Vec3::Z, width * Vec3::X);
        self.part("floor", self.palette.terrazzo, floor);
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
        self.add_ceiling();
        self.add_posters();
    }

    /// An upper floor: carpet, a white edge, slats below.
    fn add_storey(&mut self, name: &str, height: f32, plans: &[Plan]) {
        let (mut carpet, mut edge, mut soffit) =
            (Mesh::default(), Mesh::default(), Mesh::default());
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

    fn add_walls(&mut self) {
        let top = CEILING + LANTERN + 0.3;
        let mut sides = Mesh::default();
        for sign in [-1.0, 1.0] {
            cuboid(
                &mut sides,
                [sign * SIDE, 0.0, BACK - WALL],
                [sign * (SIDE + WALL), top, FRONT + WALL],
            );
            // The front, beside the glass.
            cuboid(
                &mut sides,
                [sign * FRONT_HALF, 0.0, FRONT],
                [sign * SIDE, top, FRONT + WALL],
            );
        }
        for y in [[0.0, FRONT_Y[0]], [FRONT_Y[1], top]] {
            cuboid(
                &mut sides,
                [-FRONT_HALF, y[0], FRONT],
                [FRONT_HALF, y[1], FRONT + WALL],
            );
        }
        self.part("walls", self.palette.plaster, sides);
        let mut back = Mesh::default();
        cuboid(&mut back, [-SIDE, 0.0, BACK - WALL], [SIDE, top, BACK]);
        self.part("back wall", self.palette.accent, back);
        let mut frame = Mesh::default();
        cuboid(
            &mut frame,
            [-FRONT_HALF, FRONT_Y[0], FRONT],
            [FRONT_HALF, FRONT_Y[1], FRONT + 0.1],
        );
        self.part("front frame", self.palette.steel, frame);
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
        let mut panels = Mesh::default();
        for sign in [-1.0, 1.0] {
            let depth = SIDE - 0.04;
            cuboid(
                &mut panels,
                [sign * depth, 0.0, BACK],
                [sign * (SIDE + 0.1), 1.15, FRONT],
            );
        }
        self.part("wainscot", self.palette.oak, panels);
        self.part("entrance frame", self.palette.steel, frame);
        self.part("entrance doors", self.palette.oak, doors);
    }

    /// The ceiling over the galleries, and the sides of the lantern over the atrium.
    fn add_ceiling(&mut self) {
        let mut mesh = Mesh::default();
        let top = CEILING + LANTERN + 0.2;
        for sign in [-1.0, 1.0] {
            cuboid(
                &mut mesh,
                [sign * ROOF_HALF, CEILING, BACK],
                [sign * SIDE, top, FRONT],
            );
        }
        for z in [[BACK, ROOF_Z[0]], [ROOF_Z[1], FRONT]] {
            cuboid(
                &mut mesh,
                [-ROOF_HALF, CEILING, z[0]],
                [ROOF_HALF, top, z[1]],
            );
        }
        self.part("ceiling", self.palette.ceiling, mesh);
        let mut frame = Mesh::default();
        cuboid(
            &mut frame,
            [-ROOF_HALF, CEILING + LANTERN, ROOF_Z[0]],
            [ROOF_HALF, top, ROOF_Z[1]],
        );
        self.part("roof frame", self.palette.steel, frame);
    }

    /// Panes before the frames of roof and front. They are one mesh, hence one light.
    pub(super) fn add_daylight(&mut self) {
        let material = self.draft.add_material(Material {
            emission: DAYLIGHT,
            ..Material::diffuse("daylight", Vec3::splat(0.8))
        });
        let mut glass = Mesh::default();
        let roof = Vec3::new(-ROOF_HALF, CEILING + LANTERN - PROUD, ROOF_Z[0]);
        let (width, depth) = (2.0 * ROOF_HALF, ROOF_Z[1] - ROOF_Z[0]);
        add_panes(&mut glass, roof, [width * Vec3::X, depth * Vec3::Z], [5, 8]);
        let front = Vec3::new(-FRONT_HALF, FRONT_Y[0], FRONT - PROUD);
        let (width, height) = (2.0 * FRONT_HALF, FRONT_Y[1] - FRONT_Y[0]);
        add_panes(
            &mut glass,
            front,
            [height * Vec3::Y, width * Vec3::X],
            [4, 5],
        );
        // Smaller ones at the ends of the side galleries.
        for sign in [-1.0, 1.0] {
            for floor in [0.0, BALCONY, GALLERY] {
                let x = if sign < 0.0 {
                    SIDE_WINDOW[0] - SIDE
                } else {
                    SIDE - SIDE_WINDOW[1]
                };
                let corner = Vec3::new(x, floor + WINDOW_Y[0], FRONT - PROUD);
                let (width, height) = (SIDE_WINDOW[1] - SIDE_WINDOW[0], WINDOW_Y[1] - WINDOW_Y[0]);
                add_panes(
                    &mut glass,
                    corner,
                    [height * Vec3::Y, width * Vec3::X],
                    [1, 2],
                );
            }
        }
        self.part("daylight", material, glass);
    }

    /// Round columns from floor to ceiling, with a collar at each storey.
    pub(super) fn add_columns(&mut self) {
        let mut mesh = Mesh::default();
        let segments = self.fine(9);
        for (x, z) in column_feet() {
            let foot = Vec3::new(x, 0.0, z);
            let place = |mesh: &mut Mesh, profile: &[[f32; 2]], lift: f32| {
                let profile: Vec<Vec2> = profile.iter().copied().map(Vec2::from).collect();
                mesh.add(
                    &lathe(&profile, segments),
                    glam::Quat::IDENTITY,
                    foot + lift * Vec3::Y,
                );
            };
            place(&mut mesh, &[[0.24, 0.0], [0.24, CEILING]], 0.0);
            for lift in [0.0, BALCONY, GALLERY] {
                place(&mut mesh, &[[0.34, 0.0], [0.238, 0.24]], lift);
            }
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

/// Rectangles in rows and columns over a parallelogram, with bars' widths between them.
fn add_panes(mesh: &mut Mesh, corner: Vec3, edges: [Vec3; 2], counts: [u32; 2]) {
    const BAR: f32 = 0.07;
    let step = [edges[0] / counts[0] as f32, edges[1] / counts[1] as f32];
    let inset = step.map(|edge| BAR * edge.normalize_or_zero());
    for u in 0..counts[0] {
        for v in 0..counts[1] {
            let at = corner + u as f32 * step[0] + v as f32 * step[1] + inset[0] + inset[1];
            mesh.quad(at, step[0] - 2.0 * inset[0], step[1] - 2.0 * inset[1]);
        }
    }
}
