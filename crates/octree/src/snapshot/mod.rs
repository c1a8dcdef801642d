//! A tree with all that is known of it as bytes, so that construction can go on from there.
//!
//! Numbers are of variable length (LEB128) or, where they are floats, little-endian. First
//! the settings, the cube and the counts, then the nodes, parents before their children, leaves as
//! they are in memory ([`crate::PackedLie`]). What
//! is shared in memory, parts of one cell that nobody has sampled, is written once.

mod decode;
mod encode;

use lie_geom::Aabb;

use crate::{LieSettings, LieTree, packed_lie::BytesError};

/// Layout of the bytes and meaning of what they hold; counts up with every change to either,
/// so also when evidence or proofs come to mean something else.
pub const TREE_FORMAT: u32 = 2;

/// What a tree must fit to be taken over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeFit {
    /// Bounds of the scene.
    pub bounds: Aabb,
    /// Lights of the scene.
    pub lights: u32,
    /// Triangles of the scene.
    pub triangles: u32,
    /// How it shall grow.
    pub settings: LieSettings,
}

/// Why bytes are not a tree that can be taken over.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TreeError {
    /// It grew by other rules.
    #[error("it was constructed with {name} {saved}, not {wanted}")]
    Setting {
        /// Which rule.
        name: &'static str,
        /// What it was.
        saved: String,
        /// What it should be.
        wanted: String,
    },
    /// It is of another scene.
    #[error("it was constructed for other bounds or lights")]
    Scene,
    /// The bytes end too soon.
    #[error("its tree ends too soon")]
    End,
    /// Something in it cannot be.
    #[error("its tree is malformed: {0}")]
    Malformed(&'static str),
}

impl From<BytesError> for TreeError {
    fn from(error: BytesError) -> Self {
        match error {
            BytesError::End => Self::End,
            BytesError::Malformed(what) => Self::Malformed(what),
        }
    }
}

impl LieTree {
    /// Everything that is known, as bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        encode::encode(self)
    }

    /// The tree that [`Self::to_bytes`] was called on. Memory is taken in proportion to the
    /// bytes that are there, whatever they say.
    ///
    /// # Errors
    /// [`TreeError`] if they are not such a tree, or it does not fit.
    pub fn from_bytes(bytes: &[u8], fit: &TreeFit) -> Result<Self, TreeError> {
        decode::decode(bytes, fit)
    }
}

/// What leads a node.
mod tag {
    /// A leaf's content follows.
    pub(super) const LEAF: u8 = 0;
    /// Eight children follow.
    pub(super) const INNER: u8 = 1;
    /// The same leaf as the sibling `tag - SAME`.
    pub(super) const SAME: u8 = 2;
}

#[cfg(test)]
mod tests;
