use std::sync::{Mutex, MutexGuard, PoisonError};

use lie_protocol::{AuditReport, limit};
use lie_render::Audit;

use crate::convert;

/// What audits have found since the constructor was last told.
#[derive(Default)]
pub(super) struct Ledger(Mutex<AuditReport>);

impl Ledger {
    /// Takes in an audit.
    pub(super) fn add(&self, audit: Audit) {
        let mut report = self.lock();
        report.rays += audit.rays;
        report.wrong += audit.mismatches.len() as u64;
        let room = limit::MISMATCHES - report.mismatches.len();
        let listed = audit.mismatches.iter().take(room);
        report.mismatches.extend(listed.map(convert::wire_mismatch));
    }

    /// What is new; `None` if nothing is.
    pub(super) fn take(&self) -> Option<AuditReport> {
        let report = std::mem::take(&mut *self.lock());
        (report.rays > 0).then_some(report)
    }

    fn lock(&self) -> MutexGuard<'_, AuditReport> {
        // Nothing in here can panic half-way.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
