//! What rays hit: a bounding volume hierarchy with eight children to a node, and blocks of
//! eight triangles, traversed by single rays or by packets of sixteen; or the paper's
//! two-level grid ([`AccelKind`]).
//!
//! [`Accel`] is all that the rest of the house sees. Every kernel computes the same
//! operations in the same order as the scalar [`lie_geom::Triangle::intersect`], whatever
//! vector unit the machine has, so results are the same bits everywhere: no fused
//! multiply-adds, and of two hits at the same distance the smaller triangle index wins.
//! Vector code is chosen at run time (`fearless_simd`, `multiversion`); no compiler flags are needed.
//! With the feature `choose-unit` benchmarks may choose as well (`VectorUnit`).
//!
//! This crate is the only one that knows obvhs.
//!
//! ```
//! use std::sync::Arc;
//! use glam::{Vec2, Vec3};
//! use lie_accel::{Accel, Bvh};
//! use lie_geom::Ray;
//! use lie_scene::{Geometry, MeshPart, Vertex};
//!
//! let vertex = |position| Vertex { position, normal: Vec3::ZERO, uv: Vec2::ZERO };
//! let part = MeshPart { name: "sail".into(), triangles: 0..1, material: 0 };
//! let vertices = vec![vertex(Vec3::ZERO), vertex(Vec3::X), vertex(Vec3::Y)];
//! let geometry = Geometry::new(vertices, vec![[0, 1, 2]], vec![part])?;
//! let bvh = Bvh::build(&geometry, None);
//! let hit = bvh.closest(&Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z)).unwrap();
//! assert_eq!((hit.t, hit.triangle), (1.0, 0));
//! # Ok::<(), lie_scene::GeometryError>(())
//! ```

mod block;
mod build;
mod bvh;
mod cutout;
mod grid;
mod kind;
mod mesh_edges;
mod node;
#[cfg(test)]
mod odd_input;
mod packet;
mod shaft;
mod single;
mod stack;
#[cfg(any(test, feature = "choose-unit"))]
mod vector_unit;

pub use bvh::{Bvh, BvhStats};
pub use cutout::Cutout;
pub use grid::{GridStats, TwoLevelGrid};
pub use kind::AccelKind;
pub use mesh_edges::MeshEdges;
pub use packet::{BlockPart, FanOccluders, OccluderBlocks, PACKET, RayPacket};
pub use shaft::{BoxShaft, Shaft};
#[cfg(any(test, feature = "choose-unit"))]
pub use vector_unit::VectorUnit;

use lie_geom::{Hit, Ray};

/// A structure that finds which triangles a ray hits.
///
/// Intervals of rays begin at 0 or after it: what is behind an origin may be passed over. So may a hit within
/// a few units in the last place of where a ray ends, and what is further than 1e29 times a direction.
pub trait Accel: Send + Sync {
    /// The closest hit inside the ray's interval.
    fn closest(&self, ray: &Ray) -> Option<Hit>;

    /// Some triangle inside the ray's interval, not necessarily the closest.
    fn blocker(&self, ray: &Ray) -> Option<u32>;

    /// Whether anything is inside the ray's interval.
    fn is_blocked(&self, ray: &Ray) -> bool {
        self.blocker(ray).is_some()
    }

    /// Adds to `found` the triangles that segments of a shaft may hit, and perhaps a few more,
    /// each once, up to `limit` in `found`. Says whether these are all: if not, there are too many, or the
    /// structure cannot tell.
    fn inside(&self, shaft: &Shaft, limit: usize, found: &mut Vec<u32>) -> bool {
        let _ = (shaft, limit, found);
        false
    }

    /// The same of a shaft between boxes.
    fn inside_boxes(&self, shaft: &BoxShaft, limit: usize, found: &mut Vec<u32>) -> bool {
        let _ = (shaft, limit, found);
        false
    }

    /// The closest hit of each ray of a packet.
    fn closest_packet(&self, packet: &RayPacket) -> [Option<Hit>; PACKET];

    /// Which rays of a packet are blocked: bit `i` for ray `i`.
    fn blocked_packet(&self, packet: &RayPacket) -> u32;

    /// For each ray of a packet some triangle inside its interval, not necessarily the
    /// closest, nor the one that [`Self::blocker`] names.
    fn blocker_packet(&self, packet: &RayPacket) -> [Option<u32>; PACKET];

    /// Memory of the structure in bytes, with the copies of triangles in it.
    fn bytes(&self) -> usize;
}
