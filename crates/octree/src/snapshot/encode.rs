use std::sync::Arc;

use super::tag;
use crate::{
    LieSettings, LieTree,
    packed_lie::{PackedLie, Writer},
    tree::Node,
};

/// A tree as bytes.
pub(super) fn encode(tree: &LieTree) -> Vec<u8> {
    let mut out = Writer::default();
    settings(&mut out, &tree.settings);
    let cube = tree.cube();
    out.vector(cube.min);
    out.float(cube.side);
    out.number(tree.lights);
    out.number(tree.version);
    out.number(tree.samples);
    out.number(tree.changed.len() as u64);
    for key in &tree.changed {
        out.number(key.raw());
    }
    node(&mut out, tree.tree.root());
    out.0
}

fn settings(out: &mut Writer, settings: &LieSettings) {
    out.number(settings.max_depth);
    out.number(settings.split_threshold);
    out.number(settings.split_samples);
    out.number(settings.trust);
    out.byte(settings.inherit.into());
    out.number(settings.crowd);
    out.float(settings.masking);
}

fn node(out: &mut Writer, from: &Node<PackedLie>) {
    match from {
        Node::Leaf(lie) => {
            out.byte(tag::LEAF);
            out.bytes(lie.as_bytes());
        }
        Node::Inner(children) => {
            out.byte(tag::INNER);
            for (octant, child) in children.iter().enumerate() {
                // Splitting makes one leaf, which its eight places share until one changes.
                let earlier = children[..octant].iter();
                let mut earlier = (tag::SAME..).zip(earlier);
                match earlier.find(|(_, other)| Arc::ptr_eq(other, child)) {
                    Some((same, _)) => out.byte(same),
                    None => node(out, child),
                }
            }
        }
    }
}
