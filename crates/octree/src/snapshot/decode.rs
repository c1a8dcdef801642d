use std::{collections::BTreeSet, fmt::Display, sync::Arc};

use super::{TreeError, TreeFit, tag};
use crate::{
    CellKey, Lie, LieSettings, LieTree, PackedLie,
    packed_lie::{Limits, Reader, lie},
    tree::{Node, Octree},
};

/// A tree from bytes.
pub(super) fn decode(bytes: &[u8], fit: &TreeFit) -> Result<LieTree, TreeError> {
    let mut bytes = Reader(bytes);
    // An empty tree that fits, for what it makes of bounds and settings.
    let mut tree = LieTree::new(fit.bounds, fit.lights, fit.settings);
    expect_settings(&mut bytes, &tree.settings)?;
    let (min, side) = (bytes.vector()?, bytes.float()?);
    let (cube, lights) = (tree.cube(), bytes.number()?);
    if (min, side) != (cube.min, cube.side) || lights != u64::from(fit.lights) {
        return Err(TreeError::Scene);
    }
    tree.version = bytes.number()?;
    tree.samples = bytes.number()?;
    if tree.version == u64::MAX {
        return Err(TreeError::Malformed("there is no next version"));
    }
    let changed = keys(&mut bytes)?;
    let mut nodes = Nodes {
        bytes,
        fit,
        max_depth: tree.settings.max_depth,
        // What has changed since the last commit is of the version that the next one begins.
        last_version: tree.version + u64::from(!changed.is_empty()),
    };
    let root = nodes.node(0, &[])?;
    if !nodes.bytes.0.is_empty() {
        return Err(TreeError::Malformed("bytes follow its end"));
    }
    tree.tree = Octree::from_root(cube, root);
    if changed.iter().any(|&key| tree.tree.get(key).is_none()) {
        return Err(TreeError::Malformed("there is no such cell"));
    }
    tree.changed = changed;
    match tree.validate() {
        Ok(()) => Ok(tree),
        Err(_) => Err(TreeError::Malformed("a cell contradicts itself")),
    }
}

fn expect_settings(bytes: &mut Reader<'_>, wanted: &LieSettings) -> Result<(), TreeError> {
    expect(
        "a maximum depth of",
        bytes.number()?,
        wanted.max_depth.into(),
    )?;
    expect(
        "a split threshold of",
        bytes.number()?,
        wanted.split_threshold.into(),
    )?;
    expect(
        "split samples of",
        bytes.number()?,
        wanted.split_samples.into(),
    )?;
    expect("a trust of", bytes.number()?, wanted.trust.into())?;
    expect("inheritance", bytes.byte()? != 0, wanted.inherit)?;
    expect("a crowd of", bytes.number()?, wanted.crowd.into())?;
    expect("masking", bytes.float()?, wanted.masking)
}

fn expect<T: PartialEq + Display>(
    name: &'static str,
    saved: T,
    wanted: T,
) -> Result<(), TreeError> {
    if saved == wanted {
        return Ok(());
    }
    let (saved, wanted) = (saved.to_string(), wanted.to_string());
    Err(TreeError::Setting {
        name,
        saved,
        wanted,
    })
}

/// Keys of cells.
fn keys(bytes: &mut Reader<'_>) -> Result<BTreeSet<CellKey>, TreeError> {
    let mut keys = BTreeSet::new();
    for _ in 0..bytes.count(1)? {
        let key = CellKey::from_raw(bytes.number()?);
        keys.insert(key.ok_or(TreeError::Malformed("a key names no cell"))?);
    }
    Ok(keys)
}

/// Reads nodes.
struct Nodes<'a> {
    bytes: Reader<'a>,
    fit: &'a TreeFit,
    max_depth: u32,
    last_version: u64,
}

impl Nodes<'_> {
    /// A node; `siblings` are those before it.
    fn node(
        &mut self,
        depth: u32,
        siblings: &[Arc<Node<PackedLie>>],
    ) -> Result<Arc<Node<PackedLie>>, TreeError> {
        match self.bytes.byte()? {
            tag::LEAF => Ok(Arc::new(Node::Leaf(PackedLie::of(&self.leaf()?)))),
            tag::INNER if depth < self.max_depth => {
                let mut children = Vec::with_capacity(8);
                for _ in 0..8 {
                    let child = self.node(depth + 1, &children)?;
                    children.push(child);
                }
                let children = children.try_into();
                let children = children.map_err(|_| TreeError::Malformed("not eight children"))?;
                Ok(Arc::new(Node::Inner(children)))
            }
            tag::INNER => Err(TreeError::Malformed("a cell is too deep")),
            same => {
                let sibling = siblings.get(usize::from(same - tag::SAME));
                // Nodes with children in several places would be a tree of any size.
                let is_part = |node: &&Arc<Node<PackedLie>>| matches!(&***node, Node::Leaf(lie) if lie.counts().samples == 0);
                let sibling = sibling.filter(is_part).cloned();
                sibling.ok_or(TreeError::Malformed("a cell repeats what is not there"))
            }
        }
    }

    fn leaf(&mut self) -> Result<Lie, TreeError> {
        let limits = Limits {
            lights: self.fit.lights,
            triangles: self.fit.triangles,
        };
        let lie = lie(&mut self.bytes, Some(limits))?;
        if lie.version > self.last_version {
            return Err(TreeError::Malformed("a cell is of a later version"));
        }
        Ok(lie)
    }
}
