use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use glam::{UVec2, Vec3};
use lie_protocol::{
    BeginFrame, ClientToShader as In, Compression, Ping, PixelFormat, Pong, Refuse, Role,
    ShaderToClient as Out, TileDone, TileReport, TileRequest, TileWelcome, WireCost,
};
use tokio::{
    io::AsyncRead,
    sync::{Notify, mpsc},
};

use super::{
    Replay,
    clock::{Job, Times},
};
use crate::{
    connection::{LinkError, Receiver},
    handshake, outbox, pixels,
    serve::Caller,
};

/// Tiles of a frame that a client may ask for at once.
const OUTSTANDING: u32 = 64;
/// Messages that may wait for a client that takes them slowly.
const OUTBOX: usize = 2 * OUTSTANDING as usize;

/// The two colours of a replay's pixels: nobody takes a chequered frame for a picture.
const COLOURS: [Vec3; 2] = [Vec3::new(1.0, 0.0, 1.0), Vec3::ZERO];

/// Serves a client until it leaves.
pub(super) async fn run(shader: &Arc<Replay>, caller: Caller) -> Result<(), LinkError> {
    let Caller {
        hello,
        mut receiver,
        mut sender,
    } = caller;
    if hello.role != Role::Client {
        let refusal = Refuse::new("a shader takes clients alone");
        return Err(handshake::refuse(&mut sender, refusal).await);
    }
    let welcome = TileWelcome {
        scene: shader.scene,
        threads: 1,
        replays: true,
    };
    sender.send(&Out::Welcome(welcome)).await?;
    let _here = shader.clients.hold();
    let (outbox, messages) = mpsc::channel(OUTBOX);
    let newest = AtomicU64::new(0);
    let wanted = |message: &Out| match message {
        Out::TileDone(done) => done.report.frame >= newest.load(Ordering::Relaxed),
        _ => true,
    };
    let mut session = Session {
        shader,
        frame: None,
        newest: &newest,
        outbox,
        overflow: Arc::default(),
    };
    let overflow = session.overflow.clone();
    tokio::select! {
        ended = session.listen(&mut receiver) => ended,
        ended = outbox::drain(&mut sender, messages, &shader.shutdown, wanted) => ended,
        () = overflow.notified() => Err(rules("it takes its tiles too slowly")),
    }
}

struct Session<'a> {
    shader: &'a Arc<Replay>,
    frame: Option<Arc<Frame>>,
    /// Tiles of frames before this one are void.
    newest: &'a AtomicU64,
    outbox: mpsc::Sender<Out>,
    overflow: Arc<Notify>,
}

/// A client's frame.
struct Frame {
    number: u64,
    begun: Instant,
    format: PixelFormat,
    cancelled: AtomicBool,
    outstanding: AtomicU32,
    outbox: mpsc::Sender<Out>,
    overflow: Arc<Notify>,
}

/// A tile of a frame.
pub(super) struct TileJob {
    shader: Arc<Replay>,
    frame: Arc<Frame>,
    request: TileRequest,
    cost: Duration,
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
        let size = self.shader.recording.size();
        if UVec2::from(begin.size) != size {
            let [width, height] = size.to_array();
            let ours = format!("a frame of another size than the recorded {width}x{height}");
            return Err(LinkError::Rules(ours));
        }
        if begin.compression != Compression::None {
            return Err(rules("pixels are not compressed in a replay"));
        }
        if begin.frame < self.newest.load(Ordering::Relaxed) {
            return Err(rules("the frames' numbers go back"));
        }
        if self.frame.as_ref().is_some_and(|f| f.number == begin.frame) {
            return Err(rules("a frame is begun twice"));
        }
        self.void_before(begin.frame);
        self.frame = Some(Arc::new(Frame {
            number: begin.frame,
            begun: Instant::now(),
            format: begin.format,
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
        let cost = self.shader.recording.cost(&request);
        let cost = cost.ok_or_else(|| rules("a tile whose cost was not recorded"))?;
        if frame.outstanding.fetch_add(1, Ordering::Relaxed) >= OUTSTANDING {
            return Err(rules("more tiles at once than there are credits"));
        }
        let job = TileJob {
            shader: self.shader.clone(),
            frame: frame.clone(),
            request,
            cost: cost.mul_f64(self.shader.slow_down),
        };
        let clock = &self.shader.clock;
        clock.submit(self.shader.lane, job, Instant::now());
        Ok(())
    }

    fn void_before(&mut self, frame: u64) {
        self.newest.fetch_max(frame, Ordering::Relaxed);
        if let Some(old) = self.frame.take_if(|old| old.number < frame) {
            old.cancelled.store(true, Ordering::Relaxed);
            let clock = &self.shader.clock;
            clock.forget_cancelled(self.shader.lane, Instant::now());
        }
    }
}

impl Drop for Session<'_> {
    fn drop(&mut self) {
        self.void_before(u64::MAX);
    }
}

impl Job for TileJob {
    fn cost(&self) -> Duration {
        self.cost
    }

    fn is_cancelled(&self) -> bool {
        self.frame.cancelled.load(Ordering::Relaxed)
    }

    fn done(self, times: Times) {
        let idle = times.started - times.free.max(self.frame.begun).min(times.started);
        let nanoseconds = |duration: Duration| duration.as_nanos() as u64;
        let cost = WireCost {
            queued_ns: nanoseconds(times.started - times.arrived),
            idle_ns: nanoseconds(idle),
            render_ns: nanoseconds(self.cost),
            // What a shader would pack for: here it is by how much the clock was late.
            pack_ns: nanoseconds(times.due.elapsed()),
            ..WireCost::default()
        };
        let report = TileReport {
            frame: self.frame.number,
            tile: self.request.tile,
            lie_version: self.shader.lie_version.load(Ordering::Relaxed),
            cost,
        };
        let [width, height] = self.request.size;
        let pixels = chequered(width, height, self.frame.format);
        self.frame.outstanding.fetch_sub(1, Ordering::Relaxed);
        self.shader.tiles.add(1);
        self.shader.render_ns.add(cost.render_ns);
        let done = Out::TileDone(TileDone { report, pixels });
        if let Err(mpsc::error::TrySendError::Full(_)) = self.frame.outbox.try_send(done) {
            self.frame.overflow.notify_one();
        }
    }
}

/// Pixels of the size of real ones, which are no picture.
fn chequered(width: u32, height: u32, format: PixelFormat) -> Vec<u8> {
    let colour = |at: u32| COLOURS[((at % width / 4 + at / width / 4) % 2) as usize];
    let radiance: Vec<Vec3> = (0..width * height).map(colour).collect();
    pixels::pack(&radiance, format, Compression::None)
}

fn rules(what: &str) -> LinkError {
    LinkError::Rules(what.to_owned())
}
