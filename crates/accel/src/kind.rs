use std::sync::Arc;

use lie_scene::Geometry;

use crate::{Accel, Bvh, Cutout, TwoLevelGrid};

/// The structures there are. They give the same hits, bit by bit, but for rays that lie in
/// the plane of a triangle or of a box's face; some *other* blocker where several block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AccelKind {
    /// [`Bvh`].
    #[default]
    Bvh,
    /// [`TwoLevelGrid`], the paper's.
    Grid,
}

impl AccelKind {
    /// Builds one over a scene's triangles, in parallel. `cutout` says where triangles have
    /// holes; `None` means nowhere.
    #[must_use]
    pub fn build(self, geometry: &Geometry, cutout: Option<Arc<dyn Cutout>>) -> Box<dyn Accel> {
        match self {
            Self::Bvh => Box::new(Bvh::build(geometry, cutout)),
            Self::Grid => Box::new(TwoLevelGrid::build(geometry, cutout)),
        }
    }

    /// Its name on the command line and in statistics.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
            Self::Grid => "grid",
        }
    }
}
