use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
    },
    time::Instant,
};

use glam::UVec2;
use lie_protocol::{
    BeginFrame, ClientToShader as In, Ping, Pong, Refuse, Role, ShaderToClient as Out, TileRequest,
    TileWelcome, limit,
};
use lie_render::Tile;
use tokio::{
    io::AsyncRead,
    sync::{Notify, mpsc},
};

use super::{
    Shared,
    render_pool::{FrameWork, Job},
    stage::Stage,
};
use crate::{
    connection::{LinkError, Receiver},
    convert, handshake, outbox,
    serve::Caller,
};

/// Tiles that a client may have outstanding, for each render thread: twice as many as an honest
/// one that is far away asks for.
const OUTSTANDING_PER_THREAD: u32 = 16;

/// Serves a client until it leaves or the scene changes.
pub(super) async fn run(shared: &Shared, caller: Caller) -> Result<(), LinkError> {
    let Caller {
        hello,
        mut receiver,
        mut sender,
    } = caller;
    if hello.role != Role::Client {
        let refusal = Refuse::new("a shader takes clients alone");
        return Err(handshake::refuse(&mut sender, refusal).await);
    }
    let mut stages = shared.stage.subscribe();
    let Some(stage) = stages.borrow_and_update().clone() else {
        let refusal = Refuse::new("this shader has no scene yet");
        return Err(handshake::refuse(&mut sender, refusal).await);
    };
    let welcome = TileWelcome {
        scene: stage.scene,
        threads: shared.threads,
        replays: false,
    };
    receiver.count_into(&shared.meter.from_clients);
    sender.count_into(&shared.meter.to_clients);
    sender.send(&Out::Welcome(welcome)).await?;
    let _here = shared.meter.clients.hold();

    let most = OUTSTANDING_PER_THREAD * shared.threads;
    let (outbox, messages) = mpsc::channel(2 * most as usize + 16);
    let newest = AtomicU64::new(0);
    let wanted = |message: &Out| match message {
        Out::TileDone(done) => done.report.frame >= newest.load(Ordering::Relaxed),
        Out::TileFailed(failed) => failed.frame >= newest.load(Ordering::Relaxed),
        _ => true,
    };
    let mut session = Session {
        shared,
        stage,
        frame: None,
        newest: &newest,
        most,
        outbox,
        overflow: Arc::default(),
    };
    let overflow = session.overflow.clone();
    tokio::select! {
        ended = session.listen(&mut receiver) => ended,
        ended = outbox::drain(&mut sender, messages, &shared.shutdown, wanted) => ended,
        () = overflow.notified() => Err(rules("it takes its tiles too slowly")),
        _ = stages.changed() => Err(LinkError::Rules("the scene has changed".to_owned())),
    }
}

struct Session<'a> {
    shared: &'a Shared,
    stage: Arc<Stage>,
    frame: Option<Arc<FrameWork>>,
    /// Tiles of frames before this one are void, wherever they are.
    newest: &'a AtomicU64,
    most: u32,
    outbox: mpsc::Sender<Out>,
    overflow: Arc<Notify>,
}

impl Session<'_> {
    async fn listen<R: AsyncRead + Unpin>(
        &mut self,
        receiver: &mut Receiver<R>,
    ) -> Result<(), LinkError> {
        loop {
            match receiver.receive().await? {
                In::BeginFrame(begin) => self.begin(&begin)?,
                In::TileRequest(request) => self.request(request)?,
                In::CancelBefore(cancel) => self.void_before(cancel.frame),
                In::Ping(Ping { nonce }) => {
                    // A full box means that bytes are on their way: sign of life enough.
                    let _ = self.outbox.try_send(Out::Pong(Pong { nonce }));
                }
                In::Pong(_) => {}
                In::Goodbye(goodbye) => return Err(LinkError::Refused(goodbye.reason)),
            }
        }
    }

    fn begin(&mut self, begin: &BeginFrame) -> Result<(), LinkError> {
        if begin.frame < self.newest.load(Ordering::Relaxed) {
            return Err(rules("the frames' numbers go back"));
        }
        // It would have credits of its own beside those of the one that is in work.
        if self.frame.as_ref().is_some_and(|f| f.number == begin.frame) {
            return Err(rules("a frame is begun twice"));
        }
        self.void_before(begin.frame);
        let broken = |error: convert::ConvertError| LinkError::Rules(error.to_string());
        let span = tracing::error_span!("frame", view = begin.view, frame = begin.frame);
        span.in_scope(|| tracing::debug!("a frame is begun"));
        self.frame = Some(Arc::new(FrameWork {
            number: begin.frame,
            span,
            begun: Instant::now(),
            stage: self.stage.clone(),
            camera: convert::camera(&begin.camera).map_err(broken)?,
            settings: convert::frame_settings(begin).map_err(broken)?,
            integrator: begin.integrator,
            format: begin.format,
            compression: begin.compression,
            cancelled: AtomicBool::new(false),
            outstanding: AtomicU32::new(0),
            outbox: self.outbox.clone(),
            overflow: self.overflow.clone(),
        }));
        Ok(())
    }

    fn request(&mut self, request: TileRequest) -> Result<(), LinkError> {
        if request.frame < self.newest.load(Ordering::Relaxed) {
            return Ok(());
        }
        let frame = self.frame.as_ref().filter(|f| f.number == request.frame);
        let frame = frame.ok_or_else(|| rules("a tile of a frame that was not begun"))?;
        let tile = checked_tile(&request, frame.settings.size)
            .ok_or_else(|| rules("a tile that is not inside its frame"))?;
        if frame.outstanding.load(Ordering::Relaxed) >= self.most {
            return Err(rules("more tiles at once than there are credits"));
        }
        self.shared.pool.submit(Job {
            frame: frame.clone(),
            request,
            tile,
            arrived: Instant::now(),
        });
        Ok(())
    }

    fn void_before(&mut self, frame: u64) {
        self.newest.fetch_max(frame, Ordering::Relaxed);
        if let Some(old) = self.frame.take_if(|old| old.number < frame) {
            old.cancelled.store(true, Ordering::Relaxed);
            self.shared.pool.forget_cancelled();
        }
    }
}

impl Drop for Session<'_> {
    fn drop(&mut self) {
        self.void_before(u64::MAX);
    }
}

fn checked_tile(request: &TileRequest, frame: UVec2) -> Option<Tile> {
    let (origin, size) = (UVec2::from(request.origin), UVec2::from(request.size));
    let sides = 1..=limit::TILE_SIDE;
    let tile = Tile { origin, size };
    let possible = sides.contains(&size.x) && sides.contains(&size.y) && tile.is_inside(frame);
    possible.then_some(tile)
}

fn rules(what: &str) -> LinkError {
    LinkError::Rules(what.to_owned())
}
