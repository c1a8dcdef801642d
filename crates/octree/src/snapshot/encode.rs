use std::sync::Arc;

use super::{bytes::Writer, flag, tag, verdict};
use crate::{Lie, LieSettings, LieTree, LightEvidence, Mask, Occluder, Proof, Region, tree::Node};

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

fn node(out: &mut Writer, from: &Node<Lie>) {
    match from {
        Node::Leaf(lie) => {
            out.byte(tag::LEAF);
            leaf(out, lie);
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

fn leaf(out: &mut Writer, lie: &Lie) {
    out.number(lie.samples);
    out.number(lie.dark);
    out.number(lie.version);
    match lie.shown.least {
        None => out.byte(0),
        Some(least) => {
            out.byte(1);
            out.float(least);
        }
    }
    region(out, &lie.region);
    out.number(lie.lights.len() as u64);
    let mut next = 0;
    for entry in &lie.lights {
        out.number(entry.light - next);
        next = entry.light + 1;
        evidence(out, entry);
    }
}

fn region(out: &mut Writer, region: &Region) {
    if *region == Region::default() {
        out.byte(0);
        return;
    }
    out.byte(1);
    out.vector(region.bounds.min);
    out.vector(region.bounds.max);
    out.number(region.len() as u64);
    let mut next = 0;
    for (light, proof) in region.lights() {
        let skipped = u64::from(light - next) << verdict::BITS;
        next = light + 1;
        match proof {
            Proof::Unoccluded => out.number(skipped | verdict::UNOCCLUDED),
            Proof::Hidden => out.number(skipped | verdict::HIDDEN),
            Proof::Open => out.number(skipped | verdict::OPEN),
            Proof::Behind(list) => {
                out.number(skipped | verdict::BEHIND);
                out.number(list.len() as u64);
                let mut before = 0;
                for triangle in list.iter() {
                    out.difference(before, triangle, false);
                    before = triangle;
                }
            }
        }
    }
}

fn evidence(out: &mut Writer, entry: &LightEvidence) {
    let dark = entry.most.to_bits() | entry.withheld.to_bits() == 0;
    let flags = [
        (entry.inherited, flag::INHERITED),
        (entry.crowded, flag::CROWDED),
        (entry.mask == Some(Mask::LeftOut), flag::LEFT_OUT),
        (entry.mask == Some(Mask::Whole), flag::WHOLE),
        (!dark, flag::LUMINANCES),
        (!entry.occluders.is_empty(), flag::OCCLUDERS),
    ];
    let set = flags.iter().filter(|(is_set, _)| *is_set);
    out.byte(set.fold(0, |flags, (_, flag)| flags | flag));
    out.number(entry.clear);
    out.number(entry.blocked);
    out.number(entry.agreed);
    out.byte(entry.importance);
    if !dark {
        out.float(entry.most);
        out.float(entry.withheld);
    }
    if !entry.occluders.is_empty() {
        occluders(out, &entry.occluders);
    }
}

fn occluders(out: &mut Writer, list: &[Occluder]) {
    out.number(list.len() as u64);
    let mut before = 0;
    for occluder in list {
        out.difference(before, occluder.triangle(), occluder.is_confirmed());
        before = occluder.triangle();
    }
}
