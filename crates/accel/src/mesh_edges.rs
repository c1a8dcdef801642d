use std::hash::{DefaultHasher, Hasher};

use glam::Vec3;
use lie_geom::Triangle;
use rayon::prelude::*;

/// Which triangle lies beyond each edge of each triangle.
///
/// Edges belong together where their ends are equal, whatever vertices and materials a mesh
/// has there. Where more than two triangles meet, each has one of the others.
#[derive(Clone, Debug, Default)]
pub struct MeshEdges {
    /// For each triangle, beyond the edge opposite to each vertex.
    beyond: Vec<[u32; 3]>,
}

/// There is no triangle beyond.
const NONE: u32 = u32::MAX;

/// One side of an edge.
#[derive(Clone, Copy)]
struct HalfEdge {
    /// The same for equal ends.
    hash: u64,
    triangle: u32,
    /// The vertex that it is opposite to.
    vertex: u8,
}

impl MeshEdges {
    /// Finds the neighbours of some triangles, in parallel.
    #[must_use]
    pub fn new(triangles: &[Triangle]) -> Self {
        let hash = |point: Vec3| {
            let mut state = DefaultHasher::new();
            // Zero has two signs.
            let bits = (point + Vec3::ZERO).to_array().map(f32::to_bits);
            bits.into_iter().for_each(|bits| state.write_u32(bits));
            state.finish()
        };
        let mut sides: Vec<HalfEdge> = (0u32..)
            .zip(triangles)
            .par_bridge()
            .flat_map_iter(|(triangle, shape)| {
                let hashes = corners(shape).map(hash);
                (0..3u8).map(move |vertex| HalfEdge {
                    hash: hashes[usize::from(vertex + 1) % 3]
                        .wrapping_add(hashes[usize::from(vertex + 2) % 3]),
                    triangle,
                    vertex,
                })
            })
            .collect();
        sides.par_sort_unstable_by_key(|side| (side.hash, side.triangle, side.vertex));
        let mut beyond = vec![[NONE; 3]; triangles.len()];
        for same in sides.chunk_by(|a, b| a.hash == b.hash) {
            for (place, side) in same.iter().enumerate() {
                let ends = |side: &HalfEdge| ends(&triangles[side.triangle as usize], side.vertex);
                let own = ends(side);
                // The next one around, so that all are found where there are three.
                let others = same[place + 1..].iter().chain(&same[..place]);
                let is_other = |other: &&HalfEdge| {
                    let [a, b] = ends(other);
                    other.triangle != side.triangle && (own == [a, b] || own == [b, a])
                };
                if let Some(other) = others.take(8).find(is_other) {
                    beyond[side.triangle as usize][usize::from(side.vertex)] = other.triangle;
                }
            }
        }
        Self { beyond }
    }

    /// The triangle beyond the edge opposite to a vertex (0, 1 or 2) of a triangle.
    #[must_use]
    #[inline]
    pub fn beyond(&self, triangle: u32, vertex: usize) -> Option<u32> {
        let other = self.beyond.get(triangle as usize)?[vertex];
        (other != NONE).then_some(other)
    }
}

/// The ends of the edge opposite to a vertex.
fn ends(shape: &Triangle, vertex: u8) -> [Vec3; 2] {
    let corners = corners(shape);
    [
        corners[usize::from(vertex + 1) % 3],
        corners[usize::from(vertex + 2) % 3],
    ]
}

fn corners(shape: &Triangle) -> [Vec3; 3] {
    [shape.a, shape.b, shape.c]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_share_an_edge_and_only_they() {
        let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.5)];
        let far = Vec3::splat(9.0);
        let shapes = [
            Triangle::new(a, b, c),
            Triangle::new(d, c, b),
            Triangle::new(far, far + a, far + b),
            // Zero with its other sign.
            Triangle::new(a, Vec3::new(-0.0, 1.0, -0.0), -far),
        ];
        let edges = MeshEdges::new(&shapes);
        assert_eq!(edges.beyond(0, 0), Some(1));
        assert_eq!(edges.beyond(1, 0), Some(0));
        assert_eq!(edges.beyond(0, 1), Some(3));
        assert_eq!(edges.beyond(3, 2), Some(0));
        assert_eq!(edges.beyond(0, 2), None);
        for vertex in 0..3 {
            assert_eq!(edges.beyond(2, vertex), None);
            assert_eq!(edges.beyond(7, vertex), None);
        }
    }

    #[test]
    fn where_three_meet_each_has_another() {
        let fan = [Vec3::X, Vec3::Y, -Vec3::X].map(|tip| Triangle::new(Vec3::ZERO, Vec3::Z, tip));
        let edges = MeshEdges::new(&fan);
        for triangle in 0..3 {
            assert!(
                edges
                    .beyond(triangle, 2)
                    .is_some_and(|other| other != triangle)
            );
        }
    }
}
