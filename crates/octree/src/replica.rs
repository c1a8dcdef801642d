use std::sync::Arc;

use glam::Vec3;
use lie_geom::Aabb;

use crate::{
    CellKey,
    tree::{Cell, Cube, Octree},
};

/// One cell as shaders see it: the unit of deltas and snapshots.
#[derive(Clone, Debug, PartialEq)]
pub struct CellState {
    /// Which cell.
    pub key: CellKey,
    /// The tree's version when this last changed; of two states of a leaf the one with
    /// the larger version holds.
    pub version: u64,
    /// Its content.
    pub body: CellBody,
}

/// What a cell holds. A cell that has been split never becomes a leaf again.
#[derive(Clone, Debug, PartialEq)]
pub enum CellBody {
    /// Eight children.
    Inner,
    /// An LIE.
    Leaf(LieState),
}

/// An LIE without the evidence for it (LIE §4): what is trusted of each light. A light
/// that is in no list is doubtful, unless nothing is ever doubted
/// ([`crate::LieSettings::trust`] is 0): then it is hidden.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LieState {
    /// All that the rest is about: of shadow rays from elsewhere in the cell nothing is known.
    /// `None` is everywhere in it.
    pub region: Option<Aabb>,
    /// The lights that reach the cell, in order of their number. One without occluders is
    /// unoccluded.
    pub lights: Vec<LitLight>,
    /// The lights that are fully occluded, carry nothing or are masked, in order of their
    /// number.
    pub hidden: Vec<u32>,
    /// The lights that reach the cell past so much that their shadow rays go through the
    /// scene, in order of their number.
    pub crowded: Vec<u32>,
}

/// A light that reaches a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LitLight {
    /// Number of the light in the scene.
    pub light: u32,
    /// The triangles that may come in between.
    pub occluders: Vec<u32>,
}

/// A shader's copy of the tree, with each leaf in the form `T` that rendering wants.
///
/// States may be applied in any order and more than once.
#[derive(Clone, Debug)]
pub struct Replica<T> {
    tree: Octree<Leaf<T>>,
    empty: Leaf<T>,
    version: u64,
}

#[derive(Debug)]
struct Leaf<T> {
    version: u64,
    value: Arc<T>,
}

impl<T> Clone for Leaf<T> {
    fn clone(&self) -> Self {
        Self {
            version: self.version,
            value: self.value.clone(),
        }
    }
}

impl<T> Replica<T> {
    /// A tree that knows nothing. `empty` is the form of [`LieState::default`].
    #[must_use]
    pub fn new(cube: Cube, empty: T) -> Self {
        let empty = Leaf {
            version: 0,
            value: Arc::new(empty),
        };
        Self {
            tree: Octree::new(cube, empty.clone()),
            empty,
            version: 0,
        }
    }

    /// The constructor's version that this copy equals.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The leaf around a point.
    #[must_use]
    #[inline]
    pub fn leaf_at(&self, point: Vec3) -> &T {
        &self.tree.leaf_at(point).value
    }

    /// The leaf around each of many points; neighbours should follow each other.
    pub fn for_each_leaf_at<'a>(
        &'a self,
        points: impl Iterator<Item = Vec3>,
        mut found: impl FnMut(Vec3, &'a T),
    ) {
        self.tree
            .for_each_leaf_at(points, |point, leaf| found(point, &*leaf.value));
    }

    /// The value of leaves of which nothing is known.
    #[must_use]
    pub fn empty(&self) -> &T {
        &self.empty.value
    }

    /// The cube that it divides.
    #[must_use]
    pub fn cube(&self) -> Cube {
        self.tree.cube()
    }

    /// The smallest cell around a point.
    #[must_use]
    pub fn key_at(&self, point: Vec3) -> CellKey {
        self.tree.key_at(point)
    }

    /// Takes in one cell. `compile` turns a leaf into the form wanted here; it is called
    /// only if the state is news.
    pub fn apply(&mut self, state: &CellState, compile: impl FnOnce(&LieState) -> T)
    where
        T: PartialEq,
    {
        self.apply_or_share(state, |lie| Some(compile(lie)));
    }

    /// The same, where `compile` gives `None` for what is as good as knowing nothing. All
    /// such leaves share one value, and so do equal parts of one cell.
    pub fn apply_or_share(
        &mut self,
        state: &CellState,
        compile: impl FnOnce(&LieState) -> Option<T>,
    ) where
        T: PartialEq,
    {
        match &state.body {
            CellBody::Inner => {
                if state.key.depth() < CellKey::MAX_DEPTH
                    && !matches!(self.tree.get(state.key), Some(Cell::Inner))
                {
                    self.tree.split(state.key, &self.empty);
                }
            }
            CellBody::Leaf(lie) => {
                if self.tree.get(state.key).is_none()
                    && let Some(parent) = CellKey::from_raw(state.key.raw() >> 3)
                {
                    self.tree.split(parent, &self.empty);
                }
                // No leaf: the cell has been split since, and this is old news.
                let is_news = matches!(self.tree.get(state.key),
                    Some(Cell::Leaf(leaf)) if leaf.version <= state.version);
                if !is_news {
                    return;
                }
                let value = match compile(lie) {
                    Some(value) => self.shared(state.key, value),
                    None => self.empty.value.clone(),
                };
                if let Some(leaf) = self.tree.leaf_mut(state.key) {
                    *leaf = Leaf {
                        version: state.version,
                        value,
                    };
                }
            }
        }
    }

    /// A value for a leaf: that of another part of the same cell, if one has the same.
    fn shared(&self, key: CellKey, value: T) -> Arc<T>
    where
        T: PartialEq,
    {
        let parent = CellKey::from_raw(key.raw() >> 3);
        let others = parent
            .iter()
            .flat_map(|parent| (0..8).map(|octant| parent.child(octant)));
        let mut others = others.filter_map(|key| match self.tree.get(key) {
            Some(Cell::Leaf(leaf)) => Some(&leaf.value),
            _ => None,
        });
        match others.find(|other| ***other == value) {
            Some(other) => other.clone(),
            None => Arc::new(value),
        }
    }

    /// Says that every cell of the constructor's version `version` has been applied.
    pub fn reached(&mut self, version: u64) {
        self.version = version;
    }

    /// Whether a leaf's value is the one that all leaves share of which nothing is known.
    #[must_use]
    pub fn is_empty_leaf(&self, value: &T) -> bool {
        std::ptr::eq(value, &*self.empty.value)
    }

    /// Calls `visit` for every leaf.
    pub fn for_each_leaf(&self, mut visit: impl FnMut(CellKey, &T)) {
        self.tree.for_each(|key, cell| {
            if let Cell::Leaf(leaf) = cell {
                visit(key, &leaf.value);
            }
        });
    }
}
