use glam::{Vec2, Vec3};

use crate::{
    Vertex,
    draft::{Draft, DraftPart},
};

/// A mesh that grows piece by piece. Texture coordinates are in metres, unless a shape
/// says otherwise.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) vertices: Vec<Vertex>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A flat parallelogram whose front is along `edge_u × edge_v`.
    pub(super) fn quad(&mut self, corner: Vec3, edge_u: Vec3, edge_v: Vec3) {
        let size = Vec2::new(edge_u.length(), edge_v.length());
        self.textured_quad(corner, edge_u, edge_v, size);
    }

    /// A parallelogram whose far corner has the texture coordinates `uv`.
    pub(super) fn textured_quad(&mut self, corner: Vec3, edge_u: Vec3, edge_v: Vec3, uv: Vec2) {
        let first = self.vertices.len() as u32;
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            self.vertices.push(Vertex {
                position: corner + u * edge_u + v * edge_v,
                normal: Vec3::ZERO,
                uv: Vec2::new(u, v) * uv,
            });
        }
        self.triangles.push([first, first + 1, first + 2]);
        self.triangles.push([first, first + 2, first + 3]);
    }

    /// A flat triangle, counter-clockwise.
    pub(super) fn triangle(&mut self, corners: [Vec3; 3]) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(corners.map(|position| Vertex {
            position,
            normal: Vec3::ZERO,
            uv: Vec2::new(position.x + position.z, position.y),
        }));
        self.triangles.push([first, first + 1, first + 2]);
    }

    /// A flat quadrangle, counter-clockwise.
    pub(super) fn quadrangle(&mut self, corners: [Vec3; 4]) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(corners.map(|position| Vertex {
            position,
            normal: Vec3::ZERO,
            uv: Vec2::new(position.x + position.z, position.y),
        }));
        self.triangles.push([first, first + 1, first + 2]);
        self.triangles.push([first, first + 2, first + 3]);
    }

    /// A parallelepiped from one corner along three edges, fronts outside.
    pub(super) fn block(&mut self, corner: Vec3, x: Vec3, y: Vec3, z: Vec3) {
        let (x, y) = if x.cross(y).dot(z) < 0.0 {
            (y, x)
        } else {
            (x, y)
        };
        let far = corner + x + y + z;
        self.quad(corner, z, y);
        self.quad(corner, x, z);
        self.quad(corner, y, x);
        self.quad(far, -y, -z);
        self.quad(far, -z, -x);
        self.quad(far, -x, -y);
    }

    /// An axis-aligned box.
    pub(super) fn cuboid(&mut self, min: Vec3, max: Vec3) {
        let size = max - min;
        self.block(min, size.x * Vec3::X, size.y * Vec3::Y, size.z * Vec3::Z);
    }

    /// Adds another mesh, each vertex moved by `place`; normals are turned by `turn`.
    pub(super) fn add(&mut self, other: &Self, turn: glam::Quat, offset: Vec3) {
        let first = self.vertices.len() as u32;
        self.vertices
            .extend(other.vertices.iter().map(|vertex| Vertex {
                position: turn * vertex.position + offset,
                normal: (turn * vertex.normal).normalize_or_zero(),
                uv: vertex.uv,
            }));
        let moved = other
            .triangles
            .iter()
            .map(|triangle| triangle.map(|index| index + first));
        self.triangles.extend(moved);
    }

    /// Turns the surface inside out.
    pub(super) fn flip(&mut self) {
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
        for vertex in &mut self.vertices {
            vertex.normal = -vertex.normal;
        }
    }

    /// Gives vertices that have no normal their triangle's, which looks the same: a mesh with
    /// some of both would not survive a file.
    pub(super) fn fill_normals(&mut self) {
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|index| self.vertices[index as usize].position);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for index in triangle {
                let own = &mut self.vertices[*index as usize].normal;
                if *own == Vec3::ZERO {
                    *own = normal;
                }
            }
        }
    }

    /// Takes out triangles without area, such as a lathe leaves where its profile meets the axis.
    pub(super) fn drop_slivers(&mut self) {
        const LEAST_AREA_M2: f32 = 1.0e-10;
        let vertices = &self.vertices;
        self.triangles.retain(|triangle| {
            let [a, b, c] = triangle.map(|index| vertices[index as usize].position);
            (b - a).cross(c - a).length() > 2.0 * LEAST_AREA_M2
        });
    }

    /// Puts the mesh into a draft as one part.
    pub(super) fn into_part(self, draft: &mut Draft, name: impl Into<String>, material: u32) {
        draft.add_part(DraftPart {
            name: name.into(),
            vertices: self.vertices,
            triangles: self.triangles,
            material,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_closed_and_faces_outwards() {
        for z in [Vec3::Z, -Vec3::Z] {
            let mut mesh = Mesh::default();
            mesh.block(Vec3::ONE, 2.0 * Vec3::X, 3.0 * Vec3::Y, z);
            let center = Vec3::ONE + Vec3::X + 1.5 * Vec3::Y + 0.5 * z;
            let mut volume = 0.0;
            for triangle in &mesh.triangles {
                let [a, b, c] =
                    triangle.map(|index| mesh.vertices[index as usize].position - center);
                volume += a.dot(b.cross(c)) / 6.0;
            }
            assert!((volume - 6.0).abs() < 1.0e-4);
        }
    }
}
