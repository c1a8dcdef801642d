use std::collections::HashMap;

use glam::{DVec3, Vec3};
use lie_geom::Triangle;

use super::edge::Vector;

/// Cosine between normals from which on triangles may lie in one plane.
const SAME_NORMAL: f32 = 1.0 - 1.0e-6;

/// How far a corner may be off a plane or a line, in terms of the distances along it.
const FLAT: f64 = 1.0e-6;

/// A flat part of a light: triangles of one plane that hang together, without the edges
/// between them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outline {
    /// Unit length, towards the front.
    pub(super) normal: Vector,
    /// Closed rows of corners, counter-clockwise where the surface is inside, clockwise around
    /// holes; no corner lies on the line between its neighbours.
    pub(super) loops: Vec<Vec<Vector>>,
}

impl Outline {
    /// That of a single triangle; `None` without area.
    pub(super) fn of_triangle(triangle: &Triangle) -> Option<Self> {
        let corners = [triangle.a, triangle.b, triangle.c].map(Vec3::as_dvec3);
        let [a, b, c] = corners;
        Some(Self {
            normal: (b - a).cross(c - a).try_normalize()?.to_array(),
            loops: vec![corners.map(DVec3::into).to_vec()],
        })
    }

    /// A plane's place.
    pub(super) fn corner(&self) -> Vector {
        self.loops[0][0]
    }

    /// Edges of all loops.
    pub(super) fn edges(&self) -> usize {
        self.loops.iter().map(Vec::len).sum()
    }
}

/// The outlines of some triangles; those without area have none. Triangles are in one outline
/// where they share an edge, corner for corner, with fronts on the same side.
pub(super) fn outlines(triangles: &[Triangle]) -> Vec<Outline> {
    let mesh = Mesh::new(triangles);
    let mut taken = vec![false; mesh.corners.len()];
    (0..mesh.corners.len())
        .filter_map(|seed| {
            let part = mesh.flat_part(seed, &mut taken);
            mesh.outline(&part)
        })
        .collect()
}

/// Triangles with an area, and who has an edge in common.
struct Mesh<'a> {
    triangles: Vec<&'a Triangle>,
    /// Numbers of each triangle's corners: equal corners have equal numbers.
    corners: Vec<[u32; 3]>,
    places: Vec<DVec3>,
    /// Triangles by their directed edges.
    by_edge: HashMap<(u32, u32), Vec<usize>>,
}

impl<'a> Mesh<'a> {
    fn new(all: &'a [Triangle]) -> Self {
        let triangles: Vec<_> = all
            .iter()
            .filter(|shape| shape.normal != Vec3::ZERO)
            .collect();
        let mut numbers = HashMap::new();
        let mut places = vec![];
        let mut number = |corner: Vec3| {
            // Negative zero is zero.
            let key = (corner + Vec3::ZERO).to_array().map(f32::to_bits);
            *numbers.entry(key).or_insert_with(|| {
                places.push(corner.as_dvec3());
                places.len() as u32 - 1
            })
        };
        let corners: Vec<[u32; 3]> = triangles
            .iter()
            .map(|shape| [shape.a, shape.b, shape.c].map(&mut number))
            .collect();
        let mut by_edge: HashMap<_, Vec<usize>> = HashMap::new();
        for (index, corners) in corners.iter().enumerate() {
            for edge in edges_of(*corners) {
                by_edge.entry(edge).or_default().push(index);
            }
        }
        Self {
            triangles,
            corners,
            places,
            by_edge,
        }
    }

    /// All triangles in a seed's plane that can be reached from it over common edges and are not
    /// taken yet.
    fn flat_part(&self, seed: usize, taken: &mut [bool]) -> Vec<usize> {
        if std::mem::replace(&mut taken[seed], true) {
            return vec![];
        }
        let mut part = vec![seed];
        let mut next = 0;
        while let Some(&triangle) = part.get(next) {
            next += 1;
            for (from, to) in edges_of(self.corners[triangle]) {
                for &other in self.by_edge.get(&(to, from)).into_iter().flatten() {
                    if !taken[other] && self.is_flat(seed, other) {
                        taken[other] = true;
                        part.push(other);
                    }
                }
            }
        }
        part
    }

    fn is_flat(&self, seed: usize, other: usize) -> bool {
        let (seed, other) = (self.triangles[seed], self.triangles[other]);
        let normal = seed.normal.as_dvec3();
        let is_on_plane = |corner: Vec3| {
            let (corner, along) = (corner.as_dvec3(), (corner - seed.a).as_dvec3());
            let room = corner.abs().max_element() + 10.0 * along.length();
            normal.dot(along).abs() <= FLAT * room
        };
        seed.normal.dot(other.normal) >= SAME_NORMAL
            && [other.a, other.b, other.c].into_iter().all(is_on_plane)
    }

    /// What is left of the edges of some triangles of one plane.
    fn outline(&self, part: &[usize]) -> Option<Outline> {
        let mut left: HashMap<(u32, u32), u32> = HashMap::new();
        for edge in part.iter().flat_map(|&index| edges_of(self.corners[index])) {
            // Each edge cancels one the other way: what is doubled counts twice.
            match left.get_mut(&(edge.1, edge.0)).filter(|count| **count > 0) {
                Some(count) => *count -= 1,
                None => *left.entry(edge).or_default() += 1,
            }
        }
        let mut ahead: HashMap<u32, Vec<u32>> = HashMap::new();
        let mut starts = vec![];
        // In the triangles' order, and not in the map's, which is another one each time.
        for (from, to) in part.iter().flat_map(|&index| edges_of(self.corners[index])) {
            for _ in 0..left.remove(&(from, to)).unwrap_or(0) {
                ahead.entry(from).or_default().push(to);
                starts.push(from);
            }
        }
        let area: DVec3 = part.iter().map(|&index| self.area_vector(index)).sum();
        let loops: Vec<_> = starts
            .into_iter()
            .map(|start| self.straight(follow(start, &mut ahead)))
            .filter(|corners| corners.len() > 2)
            .collect();
        let normal = area.try_normalize()?.to_array();
        (!loops.is_empty()).then_some(Outline { normal, loops })
    }

    fn area_vector(&self, index: usize) -> DVec3 {
        let [a, b, c] = self.corners[index].map(|corner| self.places[corner as usize]);
        (b - a).cross(c - a)
    }

    /// A loop without the corners that lie between their neighbours.
    fn straight(&self, corners: Vec<u32>) -> Vec<Vector> {
        let mut kept: Vec<DVec3> = vec![];
        for corner in corners {
            let corner = self.places[corner as usize];
            while kept.len() > 1 && is_between(kept[kept.len() - 2], kept[kept.len() - 1], corner) {
                kept.pop();
            }
            kept.push(corner);
        }
        // The two corners where the loop was cut open.
        while kept.len() > 2 && is_between(kept[kept.len() - 2], kept[kept.len() - 1], kept[0]) {
            kept.pop();
        }
        if kept.len() > 2 && is_between(kept[kept.len() - 1], kept[0], kept[1]) {
            kept.remove(0);
        }
        kept.into_iter().map(DVec3::into).collect()
    }
}

fn edges_of([a, b, c]: [u32; 3]) -> [(u32, u32); 3] {
    [(a, b), (b, c), (c, a)]
}

/// Takes edges from `start` until none goes on: it is closed then, since as many edges lead to a
/// corner as away from it.
fn follow(start: u32, ahead: &mut HashMap<u32, Vec<u32>>) -> Vec<u32> {
    let mut corners = vec![];
    let mut here = start;
    while let Some(next) = ahead.get_mut(&here).and_then(Vec::pop) {
        corners.push(here);
        here = next;
    }
    corners
}

fn is_between(a: DVec3, b: DVec3, c: DVec3) -> bool {
    let (whole, first) = (c - a, b - a);
    let off_line = whole.cross(first).length() <= FLAT * whole.length_squared();
    off_line && first.dot(whole) > 0.0 && (c - b).dot(whole) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cell of a grid in the plane y = 0, as two triangles that face up.
    fn cell(x: f32, z: f32, size: f32) -> [Triangle; 2] {
        let at = |i: f32, j: f32| Vec3::new(x + i * size, 0.0, z + j * size);
        let [a, b, c, d] = [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 1.0), at(1.0, 0.0)];
        [Triangle::new(a, b, c), Triangle::new(a, c, d)]
    }

    fn edges(triangles: &[Triangle]) -> Vec<Vec<usize>> {
        let found = outlines(triangles);
        let of = |outline: &Outline| outline.loops.iter().map(Vec::len).collect();
        found.iter().map(of).collect()
    }

    #[test]
    fn a_grid_is_its_rim() {
        for n in [1, 2, 7] {
            let cells = (0..n * n).flat_map(|i| cell((i % n) as f32, (i / n) as f32, 1.0));
            let triangles: Vec<Triangle> = cells.collect();
            assert_eq!(edges(&triangles), [[4]]);
            assert!(outlines(&triangles)[0].normal[1] > 0.999);
        }
    }

    #[test]
    fn a_frame_has_a_hole_and_an_l_a_corner_more() {
        let ring = |skip: &[usize]| {
            let cells = (0..9usize).filter(|index| !skip.contains(index));
            let cells = cells.flat_map(|i| cell((i % 3) as f32, (i / 3) as f32, 1.0));
            cells.collect::<Vec<Triangle>>()
        };
        assert_eq!(edges(&ring(&[4])), [[4, 4]]);
        assert_eq!(edges(&ring(&[0])), [[6]]);
        // Two cells that touch in a corner, and two that do not at all.
        assert_eq!(edges(&ring(&[0, 1, 2, 3, 5, 6, 7])), [[4], [4]]);
    }

    #[test]
    fn a_box_has_six_sides() {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let sides = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles: Vec<Triangle> = sides
            .iter()
            .flat_map(|side| {
                let [a, b, c, d] = side.map(corner);
                [Triangle::new(a, b, c), Triangle::new(a, c, d)]
            })
            .collect();
        assert_eq!(edges(&triangles), vec![vec![4]; 6]);
    }

    #[test]
    fn degenerate_doubled_and_turned_triangles_stay_what_they_are() {
        let [a, b] = cell(0.0, 0.0, 1.0);
        let none = Triangle::new(Vec3::X, Vec3::X, Vec3::Y);
        assert_eq!(edges(&[none]), Vec::<Vec<usize>>::new());
        assert_eq!(edges(&[a, none, b]), [[4]]);
        // Twice the same: each counts.
        let twice: usize = edges(&[a, b, a, b]).concat().iter().sum();
        assert_eq!(twice, 8);
        // Back to back: two sides.
        let turned = Triangle::new(a.a, a.c, a.b);
        assert_eq!(edges(&[a, turned]), [[3], [3]]);
    }
}
