use std::time::Duration;

use lie_protocol::{ShaderReport, ShaderToConstructor};
use tokio::{
    sync::mpsc,
    time::{MissedTickBehavior, interval},
};

use super::Shared;

/// How often the constructor is told.
const EVERY: Duration = Duration::from_secs(1);

/// Tells the constructor what is done here, as long as the connection lasts.
pub(super) async fn keep(shared: &Shared, outbox: &mpsc::Sender<ShaderToConstructor>) {
    let mut ticks = interval(EVERY);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        // What does not fit now is out of date by the time that it does.
        let _ = outbox.try_send(ShaderToConstructor::Report(shared.report()));
    }
}

impl Shared {
    /// What is done here so far.
    fn report(&self) -> ShaderReport {
        let meter = &self.meter;
        ShaderReport {
            tiles: meter.tiles.get(),
            camera_rays: meter.camera_rays.get(),
            shadow_rays: meter.shadow_rays.get(),
            list_rays: meter.list_rays.get(),
            render_ns: meter.render_ns.get(),
            lie_version: self.lie_version(),
            clients: meter.clients.get() as u32,
            outstanding: (meter.queued.get() + meter.busy.get()) as u32,
            sent_bytes: meter.to_clients.get(),
        }
    }

    /// The LIEs that tiles are shaded with now; 0 for none.
    pub(super) fn lie_version(&self) -> u64 {
        let stage = self.stage.borrow();
        stage
            .as_ref()
            .map_or(0, |stage| stage.lies.load().version())
    }
}
