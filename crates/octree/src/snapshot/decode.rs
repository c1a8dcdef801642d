use std::{collections::BTreeSet, fmt::Display, sync::Arc};

use lie_geom::Aabb;

use super::{TreeError, TreeFit, bytes::Reader, flag, tag, verdict};
use crate::{
    CellKey, Lie, LieSettings, LieTree, LightEvidence, Mask, Occluder, Proof, Region,
    masking::Shown,
    tree::{Node, Octree},
};

/// Fewest bytes of a light's evidence, and of what is certain of one.
const EVIDENCE: usize = 6;
const VERDICT: usize = 1;

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
        last_version: tree.version + 1,
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
        siblings: &[Arc<Node<Lie>>],
    ) -> Result<Arc<Node<Lie>>, TreeError> {
        match self.bytes.byte()? {
            tag::LEAF => Ok(Arc::new(Node::Leaf(self.leaf()?))),
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
                let is_part = |node: &&Arc<Node<Lie>>| matches!(&***node, Node::Leaf(lie) if lie.samples == 0);
                let sibling = sibling.filter(is_part).cloned();
                sibling.ok_or(TreeError::Malformed("a cell repeats what is not there"))
            }
        }
    }

    fn leaf(&mut self) -> Result<Lie, TreeError> {
        let bytes = &mut self.bytes;
        let (samples, dark) = (
            bytes.small("too many samples")?,
            bytes.small("too much dark")?,
        );
        let version = bytes.number()?;
        if version > self.last_version {
            return Err(TreeError::Malformed("a cell is of a later version"));
        }
        let least = match bytes.byte()? {
            0 => None,
            _ => Some(luminance(bytes)?),
        };
        let region = self.region()?;
        let count = self.bytes.count(EVIDENCE)?;
        let mut lights = Vec::with_capacity(count);
        let mut next = 0;
        for _ in 0..count {
            let light = self.light(&mut next, 0)?.0;
            lights.push(self.evidence(light)?);
        }
        Ok(Lie {
            samples,
            dark,
            lights,
            region,
            shown: Shown { least },
            version,
        })
    }

    fn region(&mut self) -> Result<Region, TreeError> {
        let bytes = &mut self.bytes;
        if bytes.byte()? == 0 {
            return Ok(Region::default());
        }
        let (min, max) = (bytes.vector()?, bytes.vector()?);
        let bounds = Aabb { min, max };
        if !min.is_finite() || !max.is_finite() || bounds.is_empty() {
            return Err(TreeError::Malformed("a region is not a box"));
        }
        let count = bytes.count(VERDICT)?;
        let mut lights = Vec::with_capacity(count);
        let mut next = 0;
        for _ in 0..count {
            let (light, verdict) = self.light(&mut next, verdict::BITS)?;
            let proof = match verdict {
                verdict::UNOCCLUDED => Proof::Unoccluded,
                verdict::HIDDEN => Proof::Hidden,
                verdict::BEHIND => Proof::Behind(self.triangles(|triangle, _| triangle)?.into()),
                _ => Proof::Open,
            };
            lights.push((light, proof));
        }
        Ok(Region::new(bounds, lights))
    }

    /// A light, counted from the first that may come `next`, and the lowest bits beside it.
    fn light(&mut self, next: &mut u32, bits: u32) -> Result<(u32, u64), TreeError> {
        let number = self.bytes.number()?;
        let light = u64::from(*next).checked_add(number >> bits);
        let light = light.and_then(|light| u32::try_from(light).ok());
        match light.filter(|&light| light < self.fit.lights) {
            Some(light) => {
                *next = light + 1;
                Ok((light, number & ((1 << bits) - 1)))
            }
            None => Err(TreeError::Malformed("there is no such light")),
        }
    }

    fn evidence(&mut self, light: u32) -> Result<LightEvidence, TreeError> {
        let bytes = &mut self.bytes;
        let flags = bytes.byte()?;
        let is_set = |flag| flags & flag != 0;
        let mask = match (is_set(flag::LEFT_OUT), is_set(flag::WHOLE)) {
            (false, false) => None,
            (true, false) => Some(Mask::LeftOut),
            (false, true) => Some(Mask::Whole),
            (true, true) => return Err(TreeError::Malformed("a light has two masks")),
        };
        if flags & !flag::ALL != 0 {
            return Err(TreeError::Malformed("evidence of an unknown kind"));
        }
        let mut evidence = LightEvidence {
            inherited: is_set(flag::INHERITED),
            crowded: is_set(flag::CROWDED),
            mask,
            clear: bytes.small(RAYS)?,
            blocked: bytes.small(RAYS)?,
            agreed: bytes.small(RAYS)?,
            importance: bytes.byte()?,
            ..LightEvidence::new(light)
        };
        if is_set(flag::LUMINANCES) {
            evidence.most = luminance(bytes)?;
            evidence.withheld = luminance(bytes)?;
        }
        if is_set(flag::OCCLUDERS) {
            evidence.occluders = self.triangles(Occluder::new)?.into();
        }
        Ok(evidence)
    }

    /// Triangles, each with a bit.
    fn triangles<T>(&mut self, element: impl Fn(u32, bool) -> T) -> Result<Vec<T>, TreeError> {
        let count = self.bytes.count(1)?;
        let mut list = Vec::with_capacity(count);
        let mut before = 0;
        for _ in 0..count {
            let (triangle, bit) = self.bytes.difference(before, self.fit.triangles)?;
            list.push(element(triangle, bit));
            before = triangle;
        }
        Ok(list)
    }
}

/// Said of a number of rays that does not fit.
const RAYS: &str = "too many rays";

fn luminance(bytes: &mut Reader<'_>) -> Result<f32, TreeError> {
    let luminance = bytes.float()?;
    if luminance >= 0.0 {
        Ok(luminance)
    } else {
        Err(TreeError::Malformed("a luminance is not one"))
    }
}
