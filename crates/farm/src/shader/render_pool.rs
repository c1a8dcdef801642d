use std::{
    any::Any,
    collections::VecDeque,
    io,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use lie_protocol::{
    Compression, PixelFormat, ShaderToClient, Text, TileDone, TileFailed, TileReport, TileRequest,
    WireCost, WireIntegrator,
};
use lie_render::{FrameSettings, LieLookup, RenderStats, Tile, render_tile};
use lie_scene::Camera;
use tokio::sync::{Notify, mpsc};

use super::{audit, meter::Meter, stage::Stage};
use crate::{once::Once, pixels};

/// A client's frame, shared by its tiles.
pub(super) struct FrameWork {
    pub(super) number: u64,
    /// When it was asked for.
    pub(super) begun: Instant,
    pub(super) stage: Arc<Stage>,
    pub(super) camera: Camera,
    pub(super) settings: FrameSettings,
    pub(super) integrator: WireIntegrator,
    pub(super) format: PixelFormat,
    pub(super) compression: Compression,
    /// Nobody wants this frame any more.
    pub(super) cancelled: AtomicBool,
    /// What its lines in the log belong to.
    pub(super) span: tracing::Span,
    /// Tiles that are queued or in work.
    pub(super) outstanding: AtomicU32,
    /// To the client.
    pub(super) outbox: mpsc::Sender<ShaderToClient>,
    /// Rings when the box is full: the session must end, or a tile would be missed for ever.
    pub(super) overflow: Arc<Notify>,
}

/// One tile to render.
pub(super) struct Job {
    pub(super) frame: Arc<FrameWork>,
    pub(super) request: TileRequest,
    pub(super) tile: Tile,
    pub(super) arrived: Instant,
}

/// Threads that render tiles in the order in which they were asked for.
///
/// The queue is bounded because each session bounds its frame's outstanding tiles.
pub(super) struct RenderPool(Arc<Queue>);

#[derive(Default)]
struct Queue {
    state: Mutex<State>,
    news: Condvar,
    meter: Arc<Meter>,
    /// What tiles could not be rendered for last.
    complaint: Mutex<Once>,
}

#[derive(Default)]
struct State {
    jobs: VecDeque<Job>,
    closed: bool,
}

impl RenderPool {
    /// Starts the threads. After a tile they check this share of its pixels.
    pub(super) fn start(threads: usize, audit: f32, meter: Arc<Meter>) -> io::Result<Self> {
        let queue = Arc::new(Queue {
            meter,
            ..Queue::default()
        });
        for index in 0..threads {
            let queue = queue.clone();
            thread::Builder::new()
                .name(format!("render-{index}"))
                .spawn(move || work(&queue, audit))?;
        }
        Ok(Self(queue))
    }

    /// Adds a tile to the queue.
    pub(super) fn submit(&self, job: Job) {
        job.frame.outstanding.fetch_add(1, Ordering::Relaxed);
        let mut state = self.0.lock();
        state.jobs.push_back(job);
        self.0.meter.queued.set(state.jobs.len());
        drop(state);
        self.0.news.notify_one();
    }

    /// Drops the tiles of cancelled frames now, rather than when their turn comes.
    pub(super) fn forget_cancelled(&self) {
        let cancelled = |job: &Job| job.frame.cancelled.load(Ordering::Relaxed);
        let mut state = self.0.lock();
        state.jobs.retain(|job| !cancelled(job));
        self.0.meter.queued.set(state.jobs.len());
    }

    /// Ends the threads when they have finished the tile at hand.
    pub(super) fn close(&self) {
        let mut state = self.0.lock();
        state.closed = true;
        state.jobs.clear();
        self.0.news.notify_all();
    }
}

impl Queue {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Logs why something could not be done with a tile, once for as long as the reason is the same: a tile
    /// that cannot be rendered is asked for again and again.
    fn complain(&self, job: &Job, not_done: &str, reason: &str) {
        let complaint = self.complaint.lock();
        let mut complaint = complaint.unwrap_or_else(PoisonError::into_inner);
        let (tile, line) = (
            job.tile,
            format!("a tile could not be {not_done}: {reason}"),
        );
        let complain = || {
            if complaint.is_news(&line) {
                tracing::error!("{line} ({tile:?})");
            } else {
                tracing::debug!("{line} ({tile:?})");
            }
        };
        job.frame.span.in_scope(complain);
    }

    /// Waits for a job; `None` when there will be none.
    fn next(&self) -> Option<Job> {
        let idle = |state: &mut State| state.jobs.is_empty() && !state.closed;
        let waited = self.news.wait_while(self.lock(), idle);
        let mut state = waited.unwrap_or_else(PoisonError::into_inner);
        let job = state.jobs.pop_front();
        self.meter.queued.set(state.jobs.len());
        job
    }
}

fn work(queue: &Queue, audit: f32) {
    let mut free = Instant::now();
    while let Some(job) = queue.next() {
        let idle = free.max(job.frame.begun).elapsed();
        if job.frame.cancelled.load(Ordering::Relaxed) {
            continue;
        }
        let busy = queue.meter.busy.hold();
        // A tile that cannot be rendered must not take its thread along.
        match catch_unwind(AssertUnwindSafe(|| render(&job, idle))) {
            Ok(Some(done)) => {
                queue.meter.tile(&done.report.cost);
                // To enter a span may take a lock.
                if tracing::enabled!(tracing::Level::TRACE) {
                    let tile = job.request.tile;
                    let tell = || tracing::trace!(tile, "a tile is done");
                    job.frame.span.in_scope(tell);
                }
                deliver(&job.frame, ShaderToClient::TileDone(done));
            }
            Ok(None) => {}
            Err(panic) => {
                let reason = reason(&*panic);
                queue.complain(&job, "rendered", reason);
                let failed = TileFailed {
                    frame: job.frame.number,
                    tile: job.request.tile,
                    reason: Text::new(reason),
                };
                deliver(&job.frame, ShaderToClient::TileFailed(failed));
            }
        }
        job.frame.outstanding.fetch_sub(1, Ordering::Relaxed);
        drop(busy);
        // What is checked for a frame that nobody waits for is what the next one waits for.
        let is_wanted = !job.frame.cancelled.load(Ordering::Relaxed);
        if audit > 0.0 && is_wanted && job.frame.integrator == WireIntegrator::Lie {
            let Job { frame, tile, .. } = &job;
            let checked = catch_unwind(AssertUnwindSafe(|| {
                let FrameWork {
                    stage,
                    camera,
                    settings,
                    ..
                } = &**frame;
                let found = audit::check(stage, camera, settings, *tile, audit, frame.number);
                queue.meter.audited(found);
            }));
            if let Err(panic) = checked {
                queue.complain(&job, "checked", reason(&*panic));
            }
        }
        free = Instant::now();
    }
}

/// What a thread said when it panicked.
fn reason(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("it panicked without a word")
}

/// Renders and packs a tile, before which its thread had nothing to do for so long.
fn render(job: &Job, idle: Duration) -> Option<TileDone> {
    let frame = &*job.frame;
    let started = Instant::now();
    let lies = match frame.integrator {
        WireIntegrator::Standard => None,
        WireIntegrator::Lie => Some(frame.stage.lies.load_full()),
    };
    let result = render_tile(
        &frame.stage.world,
        lies.as_deref().map(|lies| lies as &dyn LieLookup),
        &frame.camera,
        &frame.settings,
        job.tile,
        &frame.cancelled,
    )?;
    let rendered = Instant::now();
    let radiance = result.radiance.radiance();
    let pixels = pixels::pack(radiance, frame.format, frame.compression);
    let report = TileReport {
        frame: frame.number,
        tile: job.request.tile,
        lie_version: lies.map_or(0, |lies| lies.version()),
        cost: WireCost {
            queued_ns: nanoseconds(started - job.arrived),
            idle_ns: nanoseconds(idle),
            render_ns: nanoseconds(rendered - started),
            pack_ns: nanoseconds(rendered.elapsed()),
            ..cost(&result.stats)
        },
    };
    Some(TileDone { report, pixels })
}

fn nanoseconds(duration: Duration) -> u64 {
    duration.as_nanos() as u64
}

fn cost(stats: &RenderStats) -> WireCost {
    WireCost {
        queued_ns: 0,
        idle_ns: 0,
        render_ns: 0,
        visibility_ns: stats.visibility_ns,
        unoccluded_ns: stats.unoccluded_ns,
        partial_ns: stats.partial_ns,
        full_ns: stats.full_ns,
        pack_ns: 0,
        primary_rays: stats.primary_rays,
        shadow_rays: stats.shadow_rays,
        list_rays: stats.list_rays,
        occluder_tests: stats.occluder_tests,
        evaluations: stats.evaluations,
        trusted: stats.trusted,
    }
}

/// Never waits: the box has room for what a client that keeps up can have asked for.
fn deliver(frame: &FrameWork, message: ShaderToClient) {
    if frame.cancelled.load(Ordering::Relaxed) {
        return;
    }
    if let Err(mpsc::error::TrySendError::Full(_)) = frame.outbox.try_send(message) {
        frame.overflow.notify_one();
    }
}
