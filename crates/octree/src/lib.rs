//! Local illumination environments (LIEs): for each cell of an octree, the lights that
//! reach its surfaces, and for each of them the triangles known to come in between.
//!
//! * [`LieTree`] is the constructor's tree: it learns from observations (LIE §4.1).
//! * [`Observer`] makes observations by tracing shadow rays, against a [`Visibility`]
//!   that the caller brings. Many threads may observe one tree at once; recording the
//!   results, in a fixed order, is up to one of them.
//! * [`CellState`] is what one cell looks like from outside: the unit of deltas and
//!   snapshots. [`Replica`] is a shader's copy of the tree, fed with them.
//! * [`PackedLie`] is what a cell is at rest, [`Lie`] what is read and changed.
//! * [`Octree`] is the tree itself: persistent, so that a clone is a snapshot and costs
//!   nothing. [`LieTree::to_bytes`] is one that outlasts the process.
//!
//! No input or output, no threads, no clock. Lights and triangles are mere numbers here.
//!
//! ```
//! use glam::Vec3;
//! use lie_geom::Aabb;
//! use lie_octree::{LieSettings, LieTree, Observation, Outcome};
//!
//! let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
//! let mut tree = LieTree::new(bounds, 10, LieSettings::default());
//! // From one point light 3 was seen, from another triangle 7 was in the way.
//! let observations = [(0.5, None), (-0.5, Some(7))].map(|(y, blocker)| Observation {
//!     outcomes: vec![Outcome { blocker, importance: 1.0, ..Outcome::of(3) }],
//!     ..Observation::at(Vec3::new(0.0, y, 0.0))
//! });
//! tree.record(&observations);
//! let lie = tree.lie_at(Vec3::ZERO);
//! assert_eq!(lie.evidence(3).unwrap().occluders[0].triangle(), 7);
//! ```

mod doubt;
mod evidence;
mod key;
mod lie;
mod lie_tree;
mod masking;
mod observe;
mod observer;
mod odds;
mod packed_lie;
mod proof;
mod replica;
mod snapshot;
mod tree;
mod triangle_set;

pub use doubt::Doubt;
pub use evidence::{LightEvidence, Mask, Occluder};
pub use key::CellKey;
pub use lie::{Lie, Standing};
pub use lie_tree::{LieSettings, LieStats, LieTree};
pub use observe::{Between, GROUP, Observation, Outcome, ShadowRay, Visibility};
pub use observer::Observer;
pub use odds::Odds;
pub use packed_lie::PackedLie;
pub use proof::{Proof, Region};
pub use replica::{CellBody, CellState, LieState, LitLight, Replica};
pub use snapshot::{TREE_FORMAT, TreeError, TreeFit};
pub use tree::{Cell, Cube, Octree};
pub use triangle_set::TriangleSet;
