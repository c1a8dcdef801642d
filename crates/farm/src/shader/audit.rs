use std::time::Duration;

use lie_protocol::ShaderToConstructor;
use lie_render::{FrameSettings, Tile};
use lie_scene::Camera;
use tokio::{sync::mpsc, time::sleep};

use super::{Shared, stage::Stage};

/// How often the constructor is told.
const EVERY: Duration = Duration::from_secs(1);

/// Holds a stage's newest LIEs against the scene in a share of a tile's pixels, chosen by `seed`. Gives how many rays it traced, and how many of those the LIEs had wrong.
pub(super) fn check(
    stage: &Stage,
    camera: &Camera,
    settings: &FrameSettings,
    tile: Tile,
    share: f32,
    seed: u64,
) -> (u64, u64) {
    let (world, lies) = (&stage.world, stage.lies.load_full());
    let found = lie_render::audit(world, &*lies, camera, settings, tile, share, seed);
    let counts = (found.rays, found.mismatches.len() as u64);
    stage.audits.add(found);
    counts
}

/// Tells the constructor what audits find, as long as the connection lasts.
pub(super) async fn report(shared: &Shared, outbox: &mpsc::Sender<ShaderToConstructor>) {
    loop {
        sleep(EVERY).await;
        let stage = shared.stage.borrow().clone();
        let report = stage.and_then(|stage| stage.audits.take());
        if let Some(report) = report
            && outbox
                .send(ShaderToConstructor::Audit(report))
                .await
                .is_err()
        {
            return;
        }
    }
}
