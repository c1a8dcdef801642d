//! Slabs and panels: flat fields of quads in several tones, which shade nothing.

use glam::{Vec2, Vec3};

use super::Site;
use crate::generate::mesh::Mesh;

/// A parallelogram to be covered, with its front along `u × v`.
#[derive(Clone, Copy)]
pub(super) struct Field {
    pub(super) corner: Vec3,
    pub(super) u: Vec3,
    pub(super) v: Vec3,
}

/// The usual length of a slab's sides, in metres.
const SLAB_M: f32 = 1.1;

impl Site {
    /// Covers fields with whole tiles about as large as a slab, each in one of the tones and
    /// with its material's whole bitmap.
    /// `tone` is told the tile's number along `u` and `v`.
    pub(super) fn add_tiles<const N: usize>(
        &mut self,
        name: &str,
        tones: [u32; N],
        fields: &[Field],
        tone: impl Fn(u32, u32) -> usize,
    ) {
        let mut meshes = std::array::from_fn::<_, N, _>(|_| Mesh::default());
        for field in fields {
            let count = |edge: Vec3| (edge.length() / SLAB_M).round().max(1.0) as u32;
            let (columns, rows) = (count(field.u), count(field.v));
            let step = [field.u / columns as f32, field.v / rows as f32];
            for column in 0..columns {
                for row in 0..rows {
                    let corner = field.corner + column as f32 * step[0] + row as f32 * step[1];
                    let mesh = &mut meshes[tone(column, row) % N];
                    mesh.textured_quad(corner, step[0], step[1], Vec2::ONE);
                }
            }
        }
        for (number, (mesh, material)) in meshes.into_iter().zip(tones).enumerate() {
            if !mesh.triangles.is_empty() {
                self.part(format!("{name} {number}"), material, mesh);
            }
        }
    }
}
