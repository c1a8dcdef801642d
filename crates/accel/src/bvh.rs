use std::sync::Arc;

use lie_geom::{Aabb, Hit, Ray};
use lie_scene::Geometry;

use crate::{
    Accel, Cutout, PACKET, RayPacket,
    block::TriangleBlock,
    build::{Tree, build},
    node::Node,
    packet,
    shaft::{self, BoxShaft, Shaft},
    single,
};

/// A bounding volume hierarchy over a scene's triangles.
///
/// Invariant: node 0 is the root; every triangle that is not degenerate lies in a block, a large one
/// in several, for each a piece of it.
pub struct Bvh {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<TriangleBlock>,
    pub(crate) cutout: Option<Arc<dyn Cutout>>,
    bounds: Aabb,
}

/// Sizes, for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BvhStats {
    /// Wide nodes.
    pub nodes: usize,
    /// Blocks of up to eight triangles.
    pub blocks: usize,
    /// Triangles in them, one for each block that it lies in.
    pub triangles: usize,
    /// Memory of nodes and blocks.
    pub bytes: usize,
}

impl Bvh {
    /// Builds the tree, in parallel. `cutout` says where triangles have holes; `None` means nowhere.
    #[must_use]
    pub fn build(geometry: &Geometry, cutout: Option<Arc<dyn Cutout>>) -> Self {
        let has_holes = |id| cutout.as_ref().is_some_and(|cutout| cutout.has_holes(id));
        let triangles = geometry.shapes().iter().copied();
        let Tree {
            nodes,
            blocks,
            bounds,
        } = build(triangles, &has_holes);
        Self {
            nodes,
            blocks,
            cutout,
            bounds,
        }
    }

    /// The box around all triangles.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Sizes of the tree.
    #[must_use]
    pub fn stats(&self) -> BvhStats {
        BvhStats {
            nodes: self.nodes.len(),
            blocks: self.blocks.len(),
            triangles: self.blocks.iter().map(TriangleBlock::len).sum(),
            bytes: self.bytes(),
        }
    }
}

impl Accel for Bvh {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        single::closest(self, ray)
    }

    fn blocker(&self, ray: &Ray) -> Option<u32> {
        single::blocker(self, ray)
    }

    fn inside(&self, shaft: &Shaft, limit: usize, found: &mut Vec<u32>) -> bool {
        shaft::inside(self, shaft, limit, found)
    }

    fn inside_boxes(&self, shaft: &BoxShaft, limit: usize, found: &mut Vec<u32>) -> bool {
        shaft::inside_boxes(self, shaft, limit, found)
    }

    fn closest_packet(&self, packet: &RayPacket) -> [Option<Hit>; PACKET] {
        packet::closest(self, packet)
    }

    fn blocked_packet(&self, packet: &RayPacket) -> u32 {
        packet::blocked(self, packet)
    }

    fn blocker_packet(&self, packet: &RayPacket) -> [Option<u32>; PACKET] {
        packet::blockers(self, packet)
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }
}

#[cfg(test)]
pub(crate) mod tests;
