//! What there is to see: a globe, the five regular solids on plinths, and a spiral of cubes.

use glam::{Quat, Vec2, Vec3};

use super::{Site, cuboid};
use crate::generate::{
    mesh::Mesh,
    shapes::{lathe, sphere},
};

/// The golden ratio.
const PHI: f32 = 1.618_034;

impl Site {
    pub(super) fn add_exhibits(&mut self) {
        self.add_globe(Vec3::new(3.0, 0.0, 4.6));
        self.add_spiral(Vec3::new(-3.6, 0.0, 4.2));
        let solids = [
            tetrahedron(),
            cube(),
            octahedron(),
            dodecahedron(),
            icosahedron(),
        ];
        for (index, (corners, z)) in solids.iter().zip([-7.4, -4.4, -1.4, 1.6, 4.6]).enumerate() {
            self.add_solid(index, corners, Vec3::new(-7.0, 0.0, z));
        }
    }

    /// A globe on a square foot.
    fn add_globe(&mut self, foot: Vec3) {
        let center = foot + 1.55 * Vec3::Y;
        let tilt = Quat::from_rotation_z(-0.41);
        let mut mesh = Mesh::default();
        let mut ball = sphere(0.95, self.fine(14));
        for vertex in &mut ball.vertices {
            // The lathe's v is a height; the map's runs from pole to pole.
            vertex.uv.y = 0.5 - 0.5 * vertex.uv.y / 0.95;
        }
        mesh.add(&ball, tilt, center);
        self.part("globe", self.palette.globe, mesh);
        let mut stand = Mesh::default();
        let neck = lathe(&[[0.3, 0.1], [0.14, 0.66]].map(Vec2::from), 8);
        stand.add(&neck, Quat::IDENTITY, foot);
        cuboid(
            &mut stand,
            [foot.x - 0.6, 0.0, foot.z - 0.6],
            [foot.x + 0.6, 0.12, foot.z + 0.6],
        );
        self.part("globe foot", self.palette.concrete, stand);
    }

    /// Four cubes on their corners over one another, each turned against the last.
    fn add_spiral(&mut self, foot: Vec3) {
        let mut base = Mesh::default();
        cuboid(
            &mut base,
            [foot.x - 0.7, 0.0, foot.z - 0.7],
            [foot.x + 0.7, 0.3, foot.z + 0.7],
        );
        self.part("spiral foot", self.palette.concrete, base);
        // A cube that stands on a corner.
        let upright = Quat::from_rotation_arc(Vec3::ONE.normalize_or(Vec3::Y), Vec3::Y);
        let mut height = 0.3;
        for (index, half) in [0.46, 0.38, 0.31, 0.25].into_iter().enumerate() {
            let mut cube = Mesh::default();
            cube.cuboid(Vec3::splat(-half), Vec3::splat(half));
            // Each one's lowest corner is a little way into the last one's highest.
            let reach = half * 3f32.sqrt();
            let center = foot + (height + reach - 0.06) * Vec3::Y;
            height += 2.0 * reach - 0.12;
            let spin = Quat::from_rotation_y(0.35 * index as f32);
            let mut turned = Mesh::default();
            turned.add(&cube, spin * upright, center);
            let paint = self.palette.paints[[0, 1, 4, 2][index]];
            self.part(format!("spiral {index}"), paint, turned);
        }
    }

    /// A plinth with a regular solid on it.
    fn add_solid(&mut self, index: usize, faces: &[Vec<Vec3>], foot: Vec3) {
        const RADIUS: f32 = 0.42;
        let mut plinth = Mesh::default();
        let top = 0.95;
        cuboid(
            &mut plinth,
            [foot.x - 0.34, 0.0, foot.z - 0.34],
            [foot.x + 0.34, top, foot.z + 0.34],
        );
        self.part(format!("plinth {index}"), self.palette.column, plinth);
        // It rests on its first face.
        let down = face_normal(&faces[0]);
        let settle = Quat::from_rotation_arc(down, Vec3::NEG_Y);
        let spin = Quat::from_rotation_y(0.4 + 0.9 * index as f32) * settle;
        let size = RADIUS / faces[0][0].length();
        let lift = size * down.dot(faces[0][0]);
        let center = foot + (top + lift) * Vec3::Y;
        let mut mesh = Mesh::default();
        for face in faces {
            let at = |corner: usize| center + spin * (size * face[corner]);
            for corner in 1..face.len() - 1 {
                mesh.triangle([at(0), at(corner), at(corner + 1)]);
            }
        }
        self.part(format!("solid {index}"), self.palette.paints[index], mesh);
    }
}

fn face_normal(face: &[Vec3]) -> Vec3 {
    (face[1] - face[0])
        .cross(face[2] - face[0])
        .normalize_or(Vec3::NEG_Y)
}

/// The faces of a convex solid about the origin: `sides` corners each, counter-clockwise as
/// seen from outside, found as the corners farthest along each of the normals.
fn convex(corners: &[Vec3], normals: &[Vec3], sides: usize) -> Vec<Vec<Vec3>> {
    let face = |normal: &Vec3| {
        let mut own = corners.to_vec();
        own.sort_by(|a, b| b.dot(*normal).total_cmp(&a.dot(*normal)));
        own.truncate(sides);
        let right = (own[0] - own[1]).normalize_or(Vec3::X);
        let up = normal.cross(right);
        let middle = own.iter().sum::<Vec3>() / sides as f32;
        let turn = |corner: &Vec3| {
            let way = *corner - middle;
            way.dot(up).atan2(way.dot(right))
        };
        own.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
        own
    };
    normals.iter().map(face).collect()
}

/// All points that differ from one by signs.
fn signs(of: Vec3) -> Vec<Vec3> {
    let mut points = vec![];
    for bits in 0..8 {
        let flip = |bit: u32| if bits >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let point = of * Vec3::new(flip(0), flip(1), flip(2));
        if !points.contains(&point) {
            points.push(point);
        }
    }
    points
}

/// A point's coordinates in turn, each with all signs.
fn cycles(of: Vec3) -> Vec<Vec3> {
    [of, Vec3::new(of.y, of.z, of.x), Vec3::new(of.z, of.x, of.y)]
        .into_iter()
        .flat_map(signs)
        .collect()
}

fn tetrahedron() -> Vec<Vec<Vec3>> {
    let corners: Vec<Vec3> = signs(Vec3::ONE)
        .into_iter()
        .filter(|corner| corner.x * corner.y * corner.z > 0.0)
        .collect();
    let normals: Vec<Vec3> = corners.iter().map(|corner| -*corner).collect();
    convex(&corners, &normals, 3)
}

fn cube() -> Vec<Vec<Vec3>> {
    convex(&signs(Vec3::ONE), &cycles(Vec3::X), 4)
}

fn octahedron() -> Vec<Vec<Vec3>> {
    convex(&cycles(Vec3::X), &signs(Vec3::ONE), 3)
}

fn dodecahedron() -> Vec<Vec<Vec3>> {
    let mut corners = signs(Vec3::ONE);
    corners.extend(cycles(Vec3::new(0.0, 1.0 / PHI, PHI)));
    convex(&corners, &cycles(Vec3::new(0.0, PHI, 1.0)), 5)
}

fn icosahedron() -> Vec<Vec<Vec3>> {
    let mut normals = signs(Vec3::ONE);
    normals.extend(cycles(Vec3::new(0.0, 1.0 / PHI, PHI)));
    convex(&cycles(Vec3::new(0.0, PHI, 1.0)), &normals, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_solid_has_its_faces_all_alike_and_facing_outwards() {
        for (faces, count) in [
            (tetrahedron(), 4),
            (cube(), 6),
            (octahedron(), 8),
            (dodecahedron(), 12),
            (icosahedron(), 20),
        ] {
            assert_eq!(faces.len(), count);
            let edge = faces[0][0].distance(faces[0][1]);
            for face in &faces {
                assert!(face_normal(face).dot(face[0]) > 0.0);
                for (index, corner) in face.iter().enumerate() {
                    let next = face[(index + 1) % face.len()];
                    assert!((corner.distance(next) - edge).abs() < 1.0e-4 * edge);
                }
            }
        }
    }
}
