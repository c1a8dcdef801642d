use std::{
    collections::BTreeMap,
    io,
    sync::Arc,
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use lie_octree::LieTree;
use lie_protocol::LieStatus;
use lie_render::Mismatch;

use super::{Freeze, Shared, saver::Saver};
use crate::{BatchReport, Builder};

/// How often the tree is measured; that takes time in proportion to its cells.
const MEASURE_EVERY: Duration = Duration::from_millis(250);

/// Passes over the frozen view after which it counts as converged, whatever the error.
const MAX_PASSES: u64 = 256;

/// What construction has come to.
#[derive(Clone, Debug, Default)]
pub(super) struct Progress {
    /// For every client, but for the camera's serial number.
    pub(super) status: LieStatus,
    /// Each client's camera that was taken into account.
    pub(super) serials: BTreeMap<u32, u64>,
}

/// The thread that learns.
pub(super) struct Construction(JoinHandle<()>);

impl Construction {
    /// Starts the thread; it ends when the views are closed, and what it learnt is saved.
    pub(super) fn start(
        mut builder: Builder,
        shared: Arc<Shared>,
        saver: Option<Saver>,
    ) -> io::Result<Self> {
        let learn = move || {
            construct(&mut builder, &shared, saver.as_ref());
            if let Some(saver) = saver {
                if builder.taken() > 0 {
                    saver.offer(builder.snapshot());
                }
                saver.finish();
            }
        };
        thread::Builder::new()
            .name("construction".to_owned())
            .spawn(learn)
            .map(Self)
    }

    /// Waits for the end; says whether it was an orderly one.
    pub(super) fn join(self) -> bool {
        self.0.join().is_ok()
    }
}

/// Learns what the clients look at, until they all look at what is known.
fn construct(builder: &mut Builder, shared: &Shared, saver: Option<&Saver>) {
    let mut known = None;
    let mut measured = None;
    while let Some(now) = shared.views.wait(known) {
        let taken = builder.taken();
        let mended = mend(builder, &shared.audits.take());
        let mut report = builder.look(&now.views);
        if !report.converged || mended > 0 {
            let before = report.changed;
            report = builder.batch(&now.views);
            report.changed.extend(before);
            report.changed.sort_unstable();
            report.changed.dedup();
        }
        if !report.changed.is_empty() {
            shared.feed.publish(builder.tree().clone(), &report.changed);
        }
        known = report.converged.then_some(now.generation);
        let measure =
            report.converged || measured.is_none_or(|at: Instant| at.elapsed() >= MEASURE_EVERY);
        shared.progress.send_modify(|progress| {
            if measure {
                measure_into(&mut progress.status, builder.tree());
            }
            report_into(&mut progress.status, &report);
            progress.serials = now.serials;
        });
        if measure {
            measured = Some(Instant::now());
        }
        if let Some(saver) = saver.filter(|_| measure && builder.taken() > taken) {
            saver.offer(builder.snapshot());
        }
    }
}

/// Learns from what audits found. Gives how many answers were wrong.
fn mend(builder: &mut Builder, wrong: &[Mismatch]) -> u64 {
    let mended = builder.mend(wrong);
    if !wrong.is_empty() {
        tracing::debug!(
            "audits found {} wrong answers; {mended} mended",
            wrong.len()
        );
    }
    mended
}

/// Learns all at once.
pub(super) fn freeze(builder: &mut Builder, freeze: &Freeze) -> Progress {
    let mut status = LieStatus {
        frozen: true,
        ..LieStatus::default()
    };
    let views = std::slice::from_ref(&freeze.view);
    let report = match freeze.samples {
        Some(samples) => builder.sample(views, samples, |_| {}),
        None => {
            let pixels = u64::from(freeze.view.size.x) * u64::from(freeze.view.size.y);
            builder.converge(views, MAX_PASSES * pixels, |_| {})
        }
    };
    report_into(&mut status, &report);
    measure_into(&mut status, builder.tree());
    Progress {
        status,
        serials: BTreeMap::new(),
    }
}

fn report_into(status: &mut LieStatus, report: &BatchReport) {
    status.version = report.version;
    status.samples = report.samples;
    status.estimated_error = report.estimated_error.unwrap_or(f32::INFINITY);
    status.converged = report.converged;
}

fn measure_into(status: &mut LieStatus, tree: &LieTree) {
    let stats = tree.stats();
    status.cells = stats.cells;
    status.entries = stats.entries;
    status.occluders = stats.occluders;
    status.bytes = stats.bytes;
}
