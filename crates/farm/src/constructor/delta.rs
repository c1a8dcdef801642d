use std::collections::BTreeSet;

use lie_octree::CellState;
use lie_protocol::{LieDelta, WireBody, WireCell, limit};

use super::lie_feed::Update;
use crate::convert::wire_cell;

/// A part is closed when its cells may take this many bytes: short enough for signs of life
/// to come through in between.
const PART: usize = 1024 * 1024;
/// A cell that may take more than this cannot be sent.
const MAX_CELL: usize = limit::LIE_DELTA as usize - PART - 64;

/// The parts of one update, made one by one as the socket takes them.
pub(super) struct Parts<'a> {
    update: &'a Update,
}

impl<'a> Parts<'a> {
    pub(super) fn of(update: &'a Update) -> Self {
        Self { update }
    }

    /// The part of this number, which begins with this of the update's cells; and where the next
    /// one begins, if there is one. An update always has at least one.
    pub(super) fn part(&self, first: usize, number: u32) -> (LieDelta, Option<usize>) {
        let keys = &self.update.keys;
        let mut cells = Vec::new();
        let (mut bytes, mut next) = (0, first);
        while bytes < PART && next < keys.len() {
            if let Some(state) = self.update.tree.state(keys[next]) {
                let (cell, cell_bytes) = fitted(&state);
                cells.push(cell);
                bytes += cell_bytes;
            }
            next += 1;
        }
        let last = next >= keys.len();
        let part = LieDelta {
            from_version: self.update.from_version,
            to_version: self.update.to_version,
            part: number,
            last,
            cells,
        };
        (part, (!last).then_some(next))
    }
}

/// A cell for the wire and the most bytes it may take. Of one that no message could hold,
/// every light goes as crowded: the shader traces it, which is slow and right.
fn fitted(state: &CellState) -> (WireCell, usize) {
    let cell = wire_cell(state);
    let bytes = most_bytes(&cell);
    if bytes <= MAX_CELL {
        return (cell, bytes);
    }
    tracing::debug!(
        "cell {:#x} is too large to be sent: its lights go as crowded",
        cell.key
    );
    let crowded = match &cell.body {
        WireBody::Interior => vec![],
        WireBody::Leaf {
            lights, crowded, ..
        } => {
            let lights = lights.iter().map(|entry| entry.light);
            let every: BTreeSet<u32> = lights.chain(crowded.iter().copied()).collect();
            every.into_iter().take(limit::LIGHTS).collect()
        }
    };
    let region = match &cell.body {
        WireBody::Interior => None,
        WireBody::Leaf { region, .. } => *region,
    };
    let body = WireBody::Leaf {
        region,
        lights: vec![],
        hidden: vec![],
        crowded,
    };
    let cell = WireCell { body, ..cell };
    let bytes = most_bytes(&cell);
    (cell, bytes)
}

/// A length or a `u32` takes at most 5 bytes here, a `u64` at most 9.
fn most_bytes(cell: &WireCell) -> usize {
    let lights = match &cell.body {
        WireBody::Interior => 0,
        WireBody::Leaf {
            lights,
            hidden,
            crowded,
            ..
        } => {
            let lights = lights.iter().map(|light| 10 + 5 * light.occluders.len());
            lights.sum::<usize>() + 5 * (hidden.len() + crowded.len())
        }
    };
    64 + lights
}
