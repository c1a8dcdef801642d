//! Panels, boards and mouldings: what is flat and made of wood.

use glam::{Vec2, Vec3};

use crate::generate::mesh::Mesh;

/// An upright front that boards are fixed to: a corner, and unit vectors to the right, up
/// and, as `right × up`, out of it.
#[derive(Clone, Copy)]
pub(super) struct Front {
    pub(super) corner: Vec3,
    pub(super) right: Vec3,
    pub(super) up: Vec3,
}

/// Rails, stiles and raised fields on a front.
#[derive(Clone, Copy)]
pub(super) struct Panelling {
    /// From where to where along the front, in metres.
    pub(super) span: [f32; 2],
    /// From what height to what height.
    pub(super) rise: [f32; 2],
    pub(super) columns: u32,
    /// Width of rails and stiles.
    pub(super) rail: f32,
}

impl Front {
    /// A front with the usual up.
    pub(super) fn upright(corner: Vec3, right: Vec3) -> Self {
        Self {
            corner,
            right,
            up: Vec3::Y,
        }
    }

    pub(super) fn at(&self, x: f32, y: f32, z: f32) -> Vec3 {
        self.corner + x * self.right + y * self.up + z * self.right.cross(self.up)
    }

    /// A board, with its grain along the longer side of each face.
    pub(super) fn board(&self, mesh: &mut Mesh, x: [f32; 2], y: [f32; 2], z: [f32; 2]) {
        let at = |i: usize, j: usize, k: usize| self.at(x[i], y[j], z[k]);
        for [corner, u, v] in [
            [at(0, 0, 1), at(1, 0, 1), at(0, 1, 1)],
            [at(1, 0, 0), at(0, 0, 0), at(1, 1, 0)],
            [at(1, 0, 1), at(1, 0, 0), at(1, 1, 1)],
            [at(0, 0, 0), at(0, 0, 1), at(0, 1, 0)],
            [at(0, 1, 1), at(1, 1, 1), at(0, 1, 0)],
            [at(0, 0, 0), at(1, 0, 0), at(0, 0, 1)],
        ] {
            grained_quad(mesh, corner, u - corner, v - corner);
        }
    }

    /// A field that rises towards its middle.
    fn field(&self, mesh: &mut Mesh, x: [f32; 2], y: [f32; 2]) {
        const BEVEL: f32 = 0.035;
        const LOW: f32 = 0.004;
        const RISE: f32 = 0.014;
        let ring = |inset: f32, z: f32| {
            [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j): (usize, usize)| {
                let sign = |end: usize| 1.0 - 2.0 * end as f32;
                self.at(x[i] + sign(i) * inset, y[j] + sign(j) * inset, z)
            })
        };
        let (outer, inner) = (ring(0.0, LOW), ring(BEVEL, RISE));
        for side in 0..4 {
            let next = (side + 1) % 4;
            mesh.quadrangle([outer[side], outer[next], inner[next], inner[side]]);
        }
        grained_quad(mesh, inner[0], inner[1] - inner[0], inner[3] - inner[0]);
    }

    /// Panelling; its back closes whatever is behind.
    pub(super) fn panel(&self, mesh: &mut Mesh, panelling: &Panelling) {
        const PROUD: f32 = 0.022;
        let Panelling {
            span: [left, right],
            rise: [bottom, top],
            columns,
            rail,
        } = *panelling;
        let pitch = (right - left - rail) / columns as f32;
        self.board(mesh, [left, right], [bottom, bottom + rail], [0.0, PROUD]);
        self.board(mesh, [left, right], [top - rail, top], [0.0, PROUD]);
        let between = [bottom + rail, top - rail];
        for column in 0..=columns {
            let x = left + pitch * column as f32;
            self.board(mesh, [x, x + rail], between, [0.0, PROUD]);
            if column < columns {
                self.field(mesh, [x + rail, x + pitch], between);
            }
        }
    }
}

/// A parallelogram whose texture runs along its longer edge, from a place of its own.
fn grained_quad(mesh: &mut Mesh, corner: Vec3, edge_u: Vec3, edge_v: Vec3) {
    let first = mesh.vertices.len();
    if edge_u.length_squared() >= edge_v.length_squared() {
        mesh.quad(corner, edge_u, edge_v);
    } else {
        mesh.quad(corner + edge_u, edge_v, -edge_u);
    }
    let shift = Vec2::new(
        corner.dot(Vec3::new(0.37, 0.71, 0.53)),
        corner.dot(Vec3::new(0.83, 0.29, 0.61)),
    );
    for vertex in &mut mesh.vertices[first..] {
        vertex.uv += shift;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_is_closed_and_faces_outwards() {
        let front = Front::upright(Vec3::ONE, Vec3::Z);
        let mut mesh = Mesh::default();
        front.board(&mut mesh, [0.0, 2.0], [0.0, 3.0], [0.0, 0.5]);
        let corner = |index: u32| mesh.vertices[index as usize].position - Vec3::ONE;
        let volume: f32 = mesh
            .triangles
            .iter()
            .map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0)
            .sum();
        assert!((volume - 3.0).abs() < 1.0e-4, "{volume}");
    }
}
