use std::time::Instant;

use lie_farm::PublishedLies;
use lie_render::{Audit, Tile, tiles};
use rayon::prelude::*;

use super::{AuditFigures, Bench};
use crate::{Stage, race::milliseconds};

/// Share of the pixels that are checked: what shaders check by default.
const SHARE: f32 = 0.01;

/// Holds LIEs against the scene in some pixels of a stage's picture, other ones at each `mark`.
pub(super) fn audit(
    bench: &Bench<'_>,
    stage: &Stage,
    lies: &PublishedLies,
    mark: u64,
) -> AuditFigures {
    let settings = stage.settings();
    let check = |tile: Tile| {
        lie_render::audit(
            stage.world(),
            lies,
            stage.camera(),
            settings,
            tile,
            SHARE,
            mark,
        )
    };
    let clock = Instant::now();
    let audits: Vec<Audit> = bench.pool.install(|| {
        let tiles = tiles(settings.size).into_par_iter().with_max_len(1);
        tiles.map(check).collect()
    });
    let time_ms = milliseconds(clock.elapsed());
    AuditFigures {
        rays: audits.iter().map(|audit| audit.rays).sum(),
        wrong: audits
            .iter()
            .map(|audit| audit.mismatches.len() as u64)
            .sum(),
        time_ms,
    }
}
