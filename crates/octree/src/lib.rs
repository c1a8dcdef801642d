//! Local illumination environments (LIEs): for each cell of an octree, the lights that
//! reach its surfaces, and for each of them the triangles known to come in between.
//!
//! * [`LieTree`] is the constructor's tree: it learns from observations (LIE §4.1).
//! * [`observe`] makes one observation by tracing shadow rays, against a [`Visibility`]
//!   that the caller brings. Many threads may observe one tree at once; recording the
//!   results, in a fixed order, is up to one of them.
//! * [`CellState`] is what one cell looks like from outside: the unit of deltas and
//!   snapshots. [`Replica`] is a shader's copy of the tree, fed with them.
//! * [`Octree`] is the tree itself: persistent, so that a clone is a snapshot and costs
//!   nothing.
//!
//! No input or output, no threads, no clock. Lights and triangles are mere numbers here.
//!
//! ```
//! use glam::Vec3;
//! use lie_geom::{Aabb, Ray};
//! use lie_octree::{LieSettings, LieTree, ShadowRay, Visibility, observe};
//!
//! /// A world in which triangle 7 is in the way below y = 0.
//! struct Floor;
//! impl Visibility for Floor {
//!     fn blocker(&self, ray: &Ray) -> Option<u32> {
//!         (ray.origin.y < 0.0).then_some(7)
//!     }
//!     fn blocks(&self, _triangle: u32, ray: &Ray) -> bool {
//!         ray.origin.y < 0.0
//!     }
//! }
//!
//! let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
//! let mut tree = LieTree::new(bounds, LieSettings { split_threshold: 1, ..LieSettings::default() });
//! for y in [0.5, -0.5] {
//!     let point = Vec3::new(0.0, y, 0.0);
//!     let rays = [ShadowRay { light: 3, ray: Ray::segment(point, 9.0 * Vec3::Y), weight: 1.0 }];
//!     let observation = observe(&tree, point, &rays, 0.0, &Floor);
//!     tree.record(&observation);
//! }
//! let lie = tree.lie_at(Vec3::ZERO);
//! assert_eq!(lie.lights()[0].light, 3);
//! assert_eq!(lie.lights()[0].occluders[0].triangle, 7);
//! ```

mod key;
mod lie;
mod lie_tree;
mod observe;
mod replica;
mod tree;

pub use key::CellKey;
pub use lie::{HiddenLight, Lie, LightEvidence, Occluder, Standing};
pub use lie_tree::{LieSettings, LieStats, LieTree};
pub use observe::{Observation, Outcome, ShadowRay, Visibility, observe};
pub use replica::{CellBody, CellState, LieState, LitLight, Replica};
pub use tree::{Cell, Cube, Octree};
