//! Tiles that shaders say they cannot render.

use std::collections::BTreeMap;

use lie_protocol::TileFailed;

use super::{ClientError, FrameRun, ShaderId};

/// So many failures of one tile are the tile's fault: they come from as many shaders where there are so many, since
/// the scheduler gives it to those first that have not tried.
const MOST: usize = 3;

/// What shaders said of each tile that they could not render.
#[derive(Debug, Default)]
pub(super) struct Failures(BTreeMap<u32, Vec<String>>);

impl FrameRun<'_> {
    /// Has another shader try a tile, unless enough have.
    pub(super) fn fail(&mut self, id: ShaderId, failed: &TileFailed) -> Result<(), ClientError> {
        let number = failed.tile;
        let Some(&tile) = self.tiles.get(number as usize) else {
            self.expel(id, "there is no such tile");
            return Ok(());
        };
        if !self.scheduler.failed(number, id) {
            return Ok(());
        }
        let address = self.links.get(&id).map(|(link, _)| &*link.address);
        let said = format!("{} says '{}'", address.unwrap_or("a shader"), failed.reason);
        let reasons = self.failures.0.entry(number).or_default();
        reasons.push(said);
        if reasons.len() < MOST {
            return Ok(());
        }
        Err(ClientError::Tile {
            number,
            tile,
            reasons: reasons.join(", "),
        })
    }
}
