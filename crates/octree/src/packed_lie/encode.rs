use super::{bytes::Writer, flag, verdict};
use crate::{Lie, LightEvidence, Mask, Occluder, Proof, Region};

/// A cell.
pub(super) fn lie(out: &mut Writer, lie: &Lie) {
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
                out.number(list.as_bytes().len() as u64);
                out.bytes(list.as_bytes());
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
