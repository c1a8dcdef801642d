use std::sync::{Mutex, MutexGuard, PoisonError};

use lie_protocol::AuditReport;
use lie_render::Mismatch;

use crate::convert;

/// Wrong answers that may wait for construction; what is more will be found again.
const WAITING: usize = 4096;

/// What shaders' audits have come to.
pub(super) struct Audits {
    state: Mutex<State>,
    is_mending: bool,
}

#[derive(Default)]
struct State {
    total: Total,
    waiting: Vec<Mismatch>,
}

/// Over all shaders, since the start.
#[derive(Clone, Copy, Default)]
pub(super) struct Total {
    /// Shadow rays that were traced to see.
    pub(super) rays: u64,
    /// How many the LIEs had wrong.
    pub(super) wrong: u64,
}

impl Audits {
    /// None yet. `is_mending` says whether anybody will take what is to be mended.
    pub(super) fn new(is_mending: bool) -> Self {
        Self {
            state: Mutex::default(),
            is_mending,
        }
    }

    /// Takes in a report. Says whether there is something to mend.
    pub(super) fn add(&self, report: &AuditReport) -> bool {
        let mut state = self.lock();
        state.total.rays = state.total.rays.saturating_add(report.rays);
        state.total.wrong = state.total.wrong.saturating_add(report.wrong);
        if !self.is_mending {
            return false;
        }
        let room = WAITING - state.waiting.len().min(WAITING);
        let listed = report.mismatches.iter().take(room).map(convert::mismatch);
        state.waiting.extend(listed);
        !report.mismatches.is_empty()
    }

    /// What is to be mended; it then counts as done.
    pub(super) fn take(&self) -> Vec<Mismatch> {
        std::mem::take(&mut self.lock().waiting)
    }

    pub(super) fn total(&self) -> Total {
        self.lock().total
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
