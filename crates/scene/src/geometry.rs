use std::ops::Range;

use glam::{Vec2, Vec3};
use lie_geom::{Aabb, Triangle};

/// One vertex of a mesh, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position in metres.
    pub position: Vec3,
    /// Unit shading normal; zero where the surface is shaded flat.
    pub normal: Vec3,
    /// Texture coordinates; (0, 0) is the first texel of the image.
    pub uv: Vec2,
}

/// A named run of triangles that share a material: a glTF primitive or an OBJ group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshPart {
    /// Name from the file, for people.
    pub name: String,
    /// Which triangles.
    pub triangles: Range<u32>,
    /// Index of their material in the scene.
    pub material: u32,
}

/// All triangles of a scene.
///
/// Invariants, established by [`Self::new`]: every index is in range, every number is
/// finite, a normal is zero or of unit length, `parts` cover the triangles in order without gap or
/// overlap, and there are at most [`Self::MAX_TRIANGLES`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Geometry {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
    parts: Vec<MeshPart>,
    material_of: Vec<u32>,
    /// Each triangle with its plane: worked out once, for every ray.
    shapes: Vec<Triangle>,
}

/// Why data could not become a [`Geometry`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A vertex index points past the vertices.
    #[error("triangle {triangle} of '{part}' refers to vertex {index}, but there are {count}")]
    Index {
        /// Name of the mesh part.
        part: String,
        /// Triangle, counted over the scene.
        triangle: usize,
        /// The offending index.
        index: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A position, normal or texture coordinate is not a number or infinite.
    #[error("vertex {0} is not finite")]
    NotFinite(usize),
    /// A normal's length is neither 0 nor 1.
    #[error("the normal of vertex {0} is neither zero nor of unit length")]
    Normal(usize),
    /// The parts do not cover the triangles one after the other.
    #[error("mesh part '{0}' does not continue where the one before it ended")]
    Parts(String),
    /// More than [`Geometry::MAX_TRIANGLES`].
    #[error("{0} triangles are more than the {max} that are supported", max = Geometry::MAX_TRIANGLES)]
    TooMany(usize),
}

impl Geometry {
    /// Most triangles in a scene; one bit of a triangle's index is left for flags.
    pub const MAX_TRIANGLES: usize = 1 << 30;

    /// Checks everything once, so that no reader has to.
    ///
    /// # Errors
    /// [`GeometryError`] says which invariant fails, and where.
    pub fn new(
        vertices: Vec<Vertex>,
        triangles: Vec<[u32; 3]>,
        parts: Vec<MeshPart>,
    ) -> Result<Self, GeometryError> {
        if triangles.len() > Self::MAX_TRIANGLES || vertices.len() > u32::MAX as usize {
            return Err(GeometryError::TooMany(triangles.len()));
        }
        for (index, vertex) in vertices.iter().enumerate() {
            if !(vertex.position.is_finite() && vertex.normal.is_finite() && vertex.uv.is_finite())
            {
                return Err(GeometryError::NotFinite(index));
            }
            if vertex.normal != Vec3::ZERO && (vertex.normal.length_squared() - 1.0).abs() > 1.0e-3
            {
                return Err(GeometryError::Normal(index));
            }
        }
        let mut material_of = Vec::with_capacity(triangles.len());
        for part in &parts {
            let start = part.triangles.start as usize;
            if start != material_of.len()
                || part.triangles.end < part.triangles.start
                || part.triangles.end as usize > triangles.len()
            {
                return Err(GeometryError::Parts(part.name.clone()));
            }
            for (triangle, corners) in (start..).zip(&triangles[start..part.triangles.end as usize])
            {
                if let Some(&index) = corners.iter().find(|&&i| i as usize >= vertices.len()) {
                    return Err(GeometryError::Index {
                        part: part.name.clone(),
                        triangle,
                        index,
                        count: vertices.len(),
                    });
                }
                material_of.push(part.material);
            }
        }
        if material_of.len() != triangles.len() {
            return Err(GeometryError::Parts("(the last)".into()));
        }
        let position = |index: u32| vertices[index as usize].position;
        let shapes = triangles
            .iter()
            .map(|&[a, b, c]| Triangle::new(position(a), position(b), position(c)))
            .collect();
        Ok(Self {
            vertices,
            triangles,
            parts,
            material_of,
            shapes,
        })
    }

    /// The vertices.
    #[must_use]
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// Vertex indices of each triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The named runs of triangles.
    #[must_use]
    pub fn parts(&self) -> &[MeshPart] {
        &self.parts
    }

    /// Number of triangles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is no triangle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Material index of a triangle.
    #[must_use]
    #[inline]
    pub fn material_of(&self, triangle: u32) -> u32 {
        self.material_of[triangle as usize]
    }

    /// The three vertices of a triangle.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vertex; 3] {
        self.triangles[triangle as usize].map(|index| self.vertices[index as usize])
    }

    /// A triangle's shape.
    #[must_use]
    #[inline]
    pub fn triangle(&self, triangle: u32) -> &Triangle {
        &self.shapes[triangle as usize]
    }

    /// All triangles' shapes.
    #[must_use]
    pub fn shapes(&self) -> &[Triangle] {
        &self.shapes
    }

    /// Bounds of all triangles (vertices that no triangle uses do not count).
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::around(
            self.triangles
                .iter()
                .flatten()
                .map(|&index| self.vertices[index as usize].position),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertex(position: Vec3) -> Vertex {
        Vertex {
            position,
            normal: Vec3::ZERO,
            uv: Vec2::ZERO,
        }
    }

    fn part(triangles: Range<u32>) -> MeshPart {
        MeshPart {
            name: "part".into(),
            triangles,
            material: 0,
        }
    }

    #[test]
    fn broken_invariants_are_named() {
        let corners = || vec![vertex(Vec3::ZERO), vertex(Vec3::X), vertex(Vec3::Y)];
        let check =
            |vertices, triangles: Vec<[u32; 3]>, parts| Geometry::new(vertices, triangles, parts);
        assert!(check(corners(), vec![[0, 1, 2]], vec![part(0..1)]).is_ok());
        assert!(check(vec![], vec![], vec![]).is_ok());
        assert!(matches!(
            check(corners(), vec![[0, 1, 3]], vec![part(0..1)]),
            Err(GeometryError::Index {
                index: 3,
                count: 3,
                triangle: 0,
                ..
            })
        ));
        let mut nan = corners();
        nan[1].position.y = f32::NAN;
        assert_eq!(
            check(nan, vec![[0, 1, 2]], vec![part(0..1)]),
            Err(GeometryError::NotFinite(1))
        );
        let mut long = corners();
        long[2].normal = Vec3::splat(2.0);
        assert_eq!(
            check(long, vec![[0, 1, 2]], vec![part(0..1)]),
            Err(GeometryError::Normal(2))
        );
        for parts in [vec![], vec![part(0..2)], vec![part(1..1)]] {
            assert!(matches!(
                check(corners(), vec![[0, 1, 2]], parts),
                Err(GeometryError::Parts(_))
            ));
        }
    }
}
