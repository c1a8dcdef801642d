use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use lie_protocol::{AuditReport, ShaderToConstructor, limit};
use lie_render::Audit;
use tokio::{sync::mpsc, time::sleep};

use super::{Shared, render_pool::Job};
use crate::convert;

/// How often the constructor is told.
const EVERY: Duration = Duration::from_secs(1);

/// What audits have found since the constructor was last told.
#[derive(Default)]
pub(super) struct Ledger(Mutex<AuditReport>);

impl Ledger {
    fn add(&self, audit: Audit) {
        let mut report = self.lock();
        report.rays += audit.rays;
        report.wrong += audit.mismatches.len() as u64;
        let room = limit::MISMATCHES - report.mismatches.len();
        let listed = audit.mismatches.iter().take(room);
        report.mismatches.extend(listed.map(convert::wire_mismatch));
    }

    /// What is new; `None` if nothing is.
    fn take(&self) -> Option<AuditReport> {
        let report = std::mem::take(&mut *self.lock());
        (report.rays > 0).then_some(report)
    }

    fn lock(&self) -> MutexGuard<'_, AuditReport> {
        // Nothing in here can panic half-way.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Holds the newest LIEs against the scene in some pixels of a tile that has been rendered with
/// them.
pub(super) fn check(job: &Job, share: f32) {
    let frame = &*job.frame;
    let lies = frame.stage.lies.load_full();
    let found = lie_render::audit(
        &frame.stage.world,
        &*lies,
        &frame.camera,
        &frame.settings,
        job.tile,
        share,
        frame.number,
    );
    frame.stage.audits.add(found);
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
