//! From triangles to a wide tree: obvhs builds a binary one, and this collapses it.

use glam::{Vec3, Vec3A};
use lie_geom::{Aabb, Triangle};
use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, builder::build_bvh2_from_tris},
};

use crate::{
    block::{BLOCK, TriangleBlock},
    node::{Child, Node, WIDTH},
};

/// The parts of a tree.
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<TriangleBlock>,
    pub(crate) bounds: Aabb,
}

/// Builds a tree over the triangles that have an area. `has_holes` marks cut-outs.
pub(crate) fn build(
    triangles: impl Iterator<Item = Triangle>,
    has_holes: &dyn Fn(u32) -> bool,
) -> Tree {
    // Degenerate triangles are never hit; leaving them out keeps obvhs from odd boxes.
    let solid: Vec<(u32, Triangle)> = (0u32..)
        .zip(triangles)
        .filter(|(_, triangle)| triangle.normal.is_normalized())
        .collect();
    if solid.is_empty() {
        return Tree {
            nodes: vec![Node::new(&[])],
            blocks: vec![],
            bounds: Aabb::EMPTY,
        };
    }
    let shapes: Vec<obvhs::triangle::Triangle> = solid
        .iter()
        .map(|(_, triangle)| obvhs::triangle::Triangle {
            v0: Vec3A::from(triangle.a),
            v1: Vec3A::from(triangle.b),
            v2: Vec3A::from(triangle.c),
        })
        .collect();
    let params = BvhBuildParams {
        max_prims_per_leaf: BLOCK as u32,
        pre_split: true,
        collapse_traversal_cost: 5.0,
        ..BvhBuildParams::medium_build()
    };
    let binary = build_bvh2_from_tris(&shapes, params, &mut std::time::Duration::default());
    let mut collapse = Collapse {
        binary: &binary,
        solid: &solid,
        has_holes,
        nodes: vec![],
        blocks: vec![],
    };
    let root = if binary.nodes[0].is_leaf() {
        let leaf = collapse.leaf(0);
        collapse.nodes.push(Node::new(&[leaf]));
        leaf
    } else {
        collapse.inner(0)
    };
    Tree {
        nodes: collapse.nodes,
        blocks: collapse.blocks,
        bounds: root.0,
    }
}

/// Turns binary nodes into wide ones, depth first, so that a subtree lies together.
struct Collapse<'a> {
    binary: &'a Bvh2,
    solid: &'a [(u32, Triangle)],
    has_holes: &'a dyn Fn(u32) -> bool,
    nodes: Vec<Node>,
    blocks: Vec<TriangleBlock>,
}

impl Collapse<'_> {
    /// Emits the wide node that stands for an inner binary node, and everything below.
    fn inner(&mut self, root: usize) -> (Aabb, Child) {
        let index = self.nodes.len();
        self.nodes.push(Node::new(&[]));
        let (mut bounds, mut children) = (Aabb::EMPTY, vec![]);
        for child in self.open(root) {
            let child = if self.binary.nodes[child].is_leaf() {
                self.leaf(child)
            } else {
                self.inner(child)
            };
            bounds = bounds.union(child.0);
            children.push(child);
        }
        self.nodes[index] = Node::new(&children);
        (bounds, Child::node(index))
    }

    /// Up to eight binary descendants: the inner one of largest area is opened until there
    /// is no more room (Wald et al. 2008, *Getting Rid of Packets*).
    fn open(&self, root: usize) -> Vec<usize> {
        let first = self.binary.nodes[root].first_index as usize;
        let mut open = vec![first, first + 1];
        while open.len() < WIDTH {
            let largest = (0..open.len())
                .filter(|&i| !self.binary.nodes[open[i]].is_leaf())
                .max_by(|&i, &k| area(self.binary, open[i]).total_cmp(&area(self.binary, open[k])));
            let Some(largest) = largest else { break };
            let first = self.binary.nodes[open[largest]].first_index as usize;
            open[largest] = first;
            open.insert(largest + 1, first + 1);
        }
        open
    }

    /// Emits a leaf's triangles, each once: several pieces of one may lie in it.
    fn leaf(&mut self, leaf: usize) -> (Aabb, Child) {
        let node = &self.binary.nodes[leaf];
        let first = node.first_index as usize;
        let pieces = first..first + node.prim_count as usize;
        let mut indices = self.binary.primitive_indices[pieces].to_vec();
        indices.sort_unstable();
        indices.dedup();
        let triangle = |index: u32| {
            let (id, triangle) = self.solid[index as usize];
            (id, triangle, (self.has_holes)(id))
        };
        let triangles: Vec<(u32, Triangle, bool)> = indices.into_iter().map(triangle).collect();
        self.blocks.push(TriangleBlock::new(&triangles));
        let bounds = bounds_of(self.binary, leaf, &triangles);
        (bounds, Child::leaf(self.blocks.len() - 1))
    }
}

/// The box of a leaf. It may hold pieces of triangles, cut where obvhs split them: it is larger on every
/// side by what the places of cuts may be wrong, so that no ray runs between two pieces. And by a
/// step at the least: a ray that runs within a face would else be neither in the box nor out
/// of it, since no distance there times no bound is no bound.
fn bounds_of(binary: &Bvh2, leaf: usize, triangles: &[(u32, Triangle, bool)]) -> Aabb {
    /// Of a place on an edge, `a + t (b - a)` with five roundings in `t`, by the largest coordinate;
    /// twice the sum of them.
    const CUT: f32 = 12.0 * f32::EPSILON;
    /// Times the largest inverse of a direction, far beyond any scene.
    const STEP: f32 = 1.0e-18;
    let corners = triangles.iter().flat_map(|(_, it, _)| [it.a, it.b, it.c]);
    let largest = corners.fold(0.0, |largest: f32, at| largest.max(at.abs().max_element()));
    let margin = CUT * largest + STEP;
    let bounds = binary.nodes[leaf].aabb();
    let (min, max): (Vec3, Vec3) = (bounds.min.into(), bounds.max.into());
    Aabb {
        min: min.map(|face| (face - margin).min(face.next_down())),
        max: max.map(|face| (face + margin).max(face.next_up())),
    }
}

fn area(binary: &Bvh2, node: usize) -> f32 {
    binary.nodes[node].aabb().half_area()
}
