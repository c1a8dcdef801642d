use std::sync::Arc;

use glam::{UVec3, Vec3};
use lie_geom::Aabb;

use crate::CellKey;

/// The cube that an octree divides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    /// Smallest corner.
    pub min: Vec3,
    /// Edge length in metres.
    pub side: f32,
}

impl Cube {
    /// A cube around a box, somewhat larger on every side, and by uneven amounts: floors
    /// and walls at round coordinates then do not fall on the planes between cells, where
    /// rounding would spread one surface over two cells.
    #[must_use]
    pub fn around(bounds: Aabb) -> Self {
        let largest = bounds.size().max_element().max(1.0e-3);
        let side = largest * 1.0437;
        let slack = Vec3::splat(side) - bounds.size();
        Self {
            min: bounds.center() - 0.5 * bounds.size() - slack * Vec3::new(0.4713, 0.5179, 0.4889),
            side,
        }
    }

    /// A point in units of the deepest cells, clamped into the cube.
    #[inline]
    fn quantize(&self, point: Vec3) -> UVec3 {
        const CELLS: f32 = (1u32 << CellKey::MAX_DEPTH) as f32;
        // `as` saturates: what is outside, or not a number, ends up in a border cell.
        ((point - self.min) * (CELLS / self.side))
            .as_uvec3()
            .min(UVec3::splat((1 << CellKey::MAX_DEPTH) - 1))
    }

    /// The cell around a point at a depth, whether it is divided so far or not; of points
    /// outside, one at the border.
    ///
    /// # Panics
    /// Past [`CellKey::MAX_DEPTH`].
    #[must_use]
    pub fn key_at(&self, point: Vec3, depth: u32) -> CellKey {
        let place = self.quantize(point);
        (0..depth).fold(CellKey::ROOT, |key, level| {
            key.child(octant(place, CellKey::MAX_DEPTH - 1 - level))
        })
    }

    /// The box of a cell.
    #[must_use]
    pub fn cell_bounds(&self, key: CellKey) -> Aabb {
        let mut side = self.side;
        let mut min = self.min;
        for octant in key.path() {
            side *= 0.5;
            min += side
                * Vec3::new(
                    (octant & 1) as f32,
                    (octant >> 1 & 1) as f32,
                    (octant >> 2) as f32,
                );
        }
        Aabb {
            min,
            max: min + Vec3::splat(side),
        }
    }
}

/// A persistent octree with a value in every leaf.
///
/// A clone shares all nodes and costs nothing; a change copies only the path to the cell
/// that changes. So a reader with a clone has a picture that never moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree<T> {
    cube: Cube,
    root: Arc<Node<T>>,
}

/// What is at a place of the tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Node<T> {
    Leaf(T),
    Inner([Arc<Node<T>>; 8]),
}

/// What a key leads to.
#[derive(Debug, PartialEq)]
pub enum Cell<'a, T> {
    /// A cell without children.
    Leaf(&'a T),
    /// A cell with eight children.
    Inner,
}

impl<T: Clone> Octree<T> {
    /// One leaf over the whole cube.
    pub fn new(cube: Cube, value: T) -> Self {
        Self {
            cube,
            root: Arc::new(Node::Leaf(value)),
        }
    }

    /// A tree of nodes; none may be deeper than [`CellKey::MAX_DEPTH`].
    pub(crate) fn from_root(cube: Cube, root: Arc<Node<T>>) -> Self {
        Self { cube, root }
    }

    /// The node over the whole cube.
    pub(crate) fn root(&self) -> &Node<T> {
        &self.root
    }

    /// The cube that it divides.
    pub fn cube(&self) -> Cube {
        self.cube
    }

    /// The leaf around a point; a point outside belongs to the nearest border cell.
    #[inline]
    pub fn leaf_at(&self, point: Vec3) -> &T {
        let position = self.cube.quantize(point);
        let mut node = &*self.root;
        let mut level = CellKey::MAX_DEPTH;
        loop {
            match node {
                Node::Leaf(value) => return value,
                Node::Inner(children) => {
                    level -= 1;
                    node = &children[octant(position, level)];
                }
            }
        }
    }

    /// The leaf around each of many points. One that shares a cell with the point before it
    /// costs next to nothing.
    pub fn for_each_leaf_at<'a>(
        &'a self,
        points: impl Iterator<Item = Vec3>,
        mut found: impl FnMut(Vec3, &'a T),
    ) {
        // The nodes on the way to the last point, and that point.
        let mut way = [&*self.root; CellKey::MAX_DEPTH as usize + 1];
        let mut last = UVec3::ZERO;
        let mut depth = 0;
        for point in points {
            let position = self.cube.quantize(point);
            let apart = position ^ last;
            let apart = apart.x | apart.y | apart.z;
            // Down to the level where the two part, the way is the same.
            let shared = apart.leading_zeros() - (u32::BITS - CellKey::MAX_DEPTH);
            depth = depth.min(shared);
            last = position;
            loop {
                match way[depth as usize] {
                    Node::Leaf(value) => {
                        found(point, value);
                        break;
                    }
                    Node::Inner(children) => {
                        let level = CellKey::MAX_DEPTH - 1 - depth;
                        depth += 1;
                        way[depth as usize] = &children[octant(position, level)];
                    }
                }
            }
        }
    }

    /// The key of the leaf around a point.
    pub fn key_at(&self, point: Vec3) -> CellKey {
        let position = self.cube.quantize(point);
        let mut node = &*self.root;
        let mut key = CellKey::ROOT;
        while let Node::Inner(children) = node {
            let octant = octant(position, CellKey::MAX_DEPTH - 1 - key.depth());
            node = &children[octant];
            key = key.child(octant);
        }
        key
    }

    /// What is at a key; `None` if the tree is not that deep there.
    pub fn get(&self, key: CellKey) -> Option<Cell<'_, T>> {
        let mut node = &*self.root;
        for octant in key.path() {
            match node {
                Node::Leaf(_) => return None,
                Node::Inner(children) => node = &children[octant],
            }
        }
        Some(match node {
            Node::Leaf(value) => Cell::Leaf(value),
            Node::Inner(_) => Cell::Inner,
        })
    }

    /// The leaf at a key, to change; `None` if there is none.
    pub fn leaf_mut(&mut self, key: CellKey) -> Option<&mut T> {
        let mut node = Arc::make_mut(&mut self.root);
        for octant in key.path() {
            match node {
                Node::Leaf(_) => return None,
                Node::Inner(children) => node = Arc::make_mut(&mut children[octant]),
            }
        }
        match node {
            Node::Leaf(value) => Some(value),
            Node::Inner(_) => None,
        }
    }

    /// Makes sure that a cell has children, splitting leaves on the way down to it. Each
    /// new leaf gets `value`.
    ///
    /// # Panics
    /// At [`CellKey::MAX_DEPTH`], where nothing can be split.
    pub fn split(&mut self, key: CellKey, value: &T) {
        assert!(
            key.depth() < CellKey::MAX_DEPTH,
            "the deepest cells cannot be split"
        );
        let mut node = Arc::make_mut(&mut self.root);
        for octant in key.path() {
            node = Arc::make_mut(&mut opened(node, value)[octant]);
        }
        opened(node, value);
    }

    /// Calls `visit` for every cell, parents before their children.
    pub fn for_each(&self, mut visit: impl FnMut(CellKey, Cell<'_, T>)) {
        let mut pending = vec![(CellKey::ROOT, &*self.root)];
        while let Some((key, node)) = pending.pop() {
            match node {
                Node::Leaf(value) => visit(key, Cell::Leaf(value)),
                Node::Inner(children) => {
                    visit(key, Cell::Inner);
                    pending.extend(
                        (0..8)
                            .rev()
                            .map(|octant| (key.child(octant), &*children[octant])),
                    );
                }
            }
        }
    }
}

/// A node's children, made first if it is a leaf.
fn opened<'a, T: Clone>(node: &'a mut Node<T>, value: &T) -> &'a mut [Arc<Node<T>>; 8] {
    if let Node::Leaf(_) = node {
        let leaf = Arc::new(Node::Leaf(value.clone()));
        *node = Node::Inner(std::array::from_fn(|_| leaf.clone()));
    }
    match node {
        Node::Inner(children) => children,
        Node::Leaf(_) => unreachable!("it was opened above"),
    }
}

#[inline]
fn octant(position: UVec3, level: u32) -> usize {
    let bit = |coordinate: u32| (coordinate >> level & 1) as usize;
    bit(position.x) | bit(position.y) << 1 | bit(position.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Cube {
        Cube::around(Aabb {
            min: Vec3::splat(-3.0),
            max: Vec3::new(5.0, 2.0, 1.0),
        })
    }

    #[test]
    fn a_point_lies_in_the_box_of_its_cell() {
        let mut tree = Octree::new(cube(), 0);
        for i in 0..200 {
            let point = Vec3::new(
                (i * 37 % 80) as f32 * 0.1 - 3.0,
                (i % 50) as f32 * 0.1 - 3.0,
                (i % 40) as f32 * 0.1 - 3.0,
            );
            let key = tree.key_at(point);
            let bounds = tree.cube().cell_bounds(key);
            let slack = Vec3::splat(1.0e-5);
            assert!(
                Aabb {
                    min: bounds.min - slack,
                    max: bounds.max + slack
                }
                .contains(point)
            );
            *tree.leaf_mut(key).unwrap() += 1;
            assert_eq!(tree.get(key), Some(Cell::Leaf(tree.leaf_at(point))));
            if key.depth() < 6 {
                tree.split(key, &0);
            }
        }
    }

    #[test]
    fn many_points_find_the_leaves_that_each_finds() {
        let mut tree = Octree::new(cube(), 0);
        for number in 1..200 {
            let key = tree.key_at(place(number));
            if key.depth() < CellKey::MAX_DEPTH {
                tree.split(key, &number);
            }
        }
        // Neighbours, jumps, and one place twice.
        let points: Vec<Vec3> = (0..900).map(|number| place(number / 2 * 7 % 300)).collect();
        let mut found = vec![];
        tree.for_each_leaf_at(points.iter().copied(), |_, leaf| found.push(leaf));
        let one_by_one: Vec<&i32> = points.iter().map(|&point| tree.leaf_at(point)).collect();
        assert_eq!(found, one_by_one);
    }

    fn place(number: i32) -> Vec3 {
        Vec3::new(
            (number * 37 % 80) as f32 * 0.1 - 3.0,
            (number % 50) as f32 * 0.1 - 3.0,
            (number % 40) as f32 * 0.1 - 3.0,
        )
    }

    #[test]
    fn a_clone_does_not_move_when_the_original_changes() {
        let mut tree = Octree::new(cube(), 0);
        tree.split(CellKey::ROOT, &1);
        let snapshot = tree.clone();
        let key = CellKey::ROOT.child(2);
        *tree.leaf_mut(key).unwrap() = 9;
        tree.split(CellKey::ROOT.child(5).child(1), &4);
        assert_eq!(snapshot.get(key), Some(Cell::Leaf(&1)));
        assert_eq!(snapshot.get(CellKey::ROOT.child(5)), Some(Cell::Leaf(&1)));
        assert_eq!(tree.get(key), Some(Cell::Leaf(&9)));
        assert_eq!(tree.get(CellKey::ROOT.child(5).child(1)), Some(Cell::Inner));
        assert_eq!(
            tree.get(CellKey::ROOT.child(5).child(1).child(0)),
            Some(Cell::Leaf(&4))
        );
        assert_eq!(tree.get(key.child(0)), None);
        assert_eq!(tree.leaf_mut(CellKey::ROOT), None);
    }

    #[test]
    fn points_outside_and_undefined_ones_find_a_border_cell() {
        let mut tree = Octree::new(cube(), 0);
        tree.split(CellKey::ROOT, &1);
        for point in [
            Vec3::splat(1.0e9),
            Vec3::splat(-1.0e9),
            Vec3::splat(f32::NAN),
        ] {
            assert_eq!(*tree.leaf_at(point), 1);
        }
        let empty = Cube::around(Aabb::EMPTY);
        assert!(empty.side > 0.0 && empty.min.is_finite());
    }

    #[test]
    fn parents_are_visited_before_their_children() {
        let mut tree = Octree::new(cube(), ());
        tree.split(CellKey::ROOT.child(1).child(6), &());
        let mut seen = vec![];
        tree.for_each(|key, _| seen.push(key));
        assert_eq!(seen.len(), 25);
        for (index, key) in seen.iter().enumerate() {
            let parent = CellKey::from_raw(key.raw() >> 3);
            assert!(parent.is_none_or(|parent| seen[..index].contains(&parent)));
        }
    }
}
