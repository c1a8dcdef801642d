//! The geometry everything else stands on: rays, boxes, triangles, sampling warps and
//! counter-based random numbers.
//!
//! Conventions, for the whole project: right-handed, metres, radians, single precision.
//! Directions of rays need not be normalised; a hit's `t` counts in units of the
//! direction's length, so that a shadow ray from `a` to `b` has direction `b − a` and
//! `t_max` just under 1.
//!
//! ```
//! use glam::Vec3;
//! use lie_geom::{Ray, Triangle};
//!
//! let triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
//! let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
//! let hit = triangle.intersect(&ray).expect("the ray points at the triangle");
//! assert_eq!(hit.t, 1.0);
//! ```

mod aabb;
mod random;
mod ray;
pub mod sampling;
mod triangle;

pub use aabb::Aabb;
pub use random::RandomKey;
pub use ray::{Hit, OFFSET_ULPS, Ray, SHADOW_T_MAX, offset_origin};
pub use triangle::{
    EdgeWeights, LaneHit, Number, Triangle, TriangleHit, dot, edge_planes, edge_weights,
    intersect_lane, plane_distance, plane_offset, weights_of,
};
