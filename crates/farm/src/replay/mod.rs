//! Shaders that replay recorded costs of tiles instead of rendering: how a large farm would go, seen
//! on one machine. Constructor, client and scheduler are the real ones, and so are the connections:
//! each replay has its own port and its own session with the constructor, as a shader on
//! one thread has. What it leaves out is the scene, the cells in the LIEs' updates (of which it
//! reads the versions), and the rendering. Its pixels are a chequerboard.
//!
//! Nobody gets one by mistake: a replay says that it is one in its hello, a constructor
//! that was not told of a simulation refuses it, the roster and the status name it, and a client that did not
//! ask for replays lets none of them in.

mod clock;
mod recording;
mod session;
mod upstream;

use std::sync::{Arc, atomic::AtomicU64};

use lie_protocol::SceneHash;
use tokio::{net::TcpListener, task::JoinSet};
use tokio_util::sync::CancellationToken;

use crate::{
    connection::LinkError,
    metrics::{Counter, Gauge},
    network::{Exposure, NetworkError},
    serve::{Gate, Refusals, serve},
    shader::MAX_CLIENTS,
};
use clock::Clock;
pub use recording::{RecordedSubject, Recording, RecordingError, RecordingFlaw};
use session::TileJob;

/// How replays work.
#[derive(Clone, Debug)]
pub struct ReplayConfig {
    /// Where the constructor is, as `host:port`.
    pub constructor: String,
    /// Whom they talk to.
    pub exposure: Exposure,
    /// What they replay.
    pub recording: Arc<Recording>,
    /// How many times as long as recorded a tile takes.
    pub slow_down: f64,
}

/// Why there is no simulation, or no more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The clock cannot be started.
    #[error("cannot start the thread that keeps the time: {0}")]
    Threads(std::io::Error),
    /// A listener has no address.
    #[error("a listening socket has no address: {0}")]
    Listener(std::io::Error),
    /// The recording cannot be used.
    #[error(transparent)]
    Recording(#[from] RecordingFlaw),
    /// The constructor's address can never be dialled.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The constructor refuses replays, or cannot be talked to.
    #[error("the constructor at {address}: {cause}")]
    Constructor {
        /// Its address.
        address: String,
        /// What happened.
        cause: LinkError,
    },
    /// The constructor holds another scene.
    #[error(
        "the constructor at {address} holds the scene {theirs}, and the recording is of {ours}"
    )]
    OtherScene {
        /// Its address.
        address: String,
        /// The hash of its scene.
        theirs: SceneHash,
        /// The hash of that which was recorded.
        ours: SceneHash,
    },
}

/// One that stands in for a shader on one thread.
struct Replay {
    recording: Arc<Recording>,
    slow_down: f64,
    scene: SceneHash,
    clock: Arc<Clock<TileJob>>,
    /// Its place in the clock.
    lane: usize,
    lie_version: AtomicU64,
    tiles: Counter,
    render_ns: Counter,
    clients: Gauge,
    shutdown: CancellationToken,
}

/// Replays, one behind each listener, until `shutdown`; the constructor may come late, go and come back.
///
/// # Errors
/// [`ReplayError`].
pub async fn run(
    config: ReplayConfig,
    listeners: Vec<TcpListener>,
    shutdown: CancellationToken,
) -> Result<(), ReplayError> {
    let scene = config.recording.hash()?;
    let clock = Arc::new(Clock::start(listeners.len()).map_err(ReplayError::Threads)?);
    let mut services = JoinSet::new();
    let mut sessions = JoinSet::new();
    let mut result = Ok(());
    for (lane, listener) in listeners.into_iter().enumerate() {
        let port = listener.local_addr().map_err(ReplayError::Listener)?.port();
        let replay = Arc::new(Replay {
            recording: config.recording.clone(),
            slow_down: config.slow_down,
            scene,
            clock: clock.clone(),
            lane,
            lie_version: AtomicU64::new(0),
            tiles: Counter::default(),
            render_ns: Counter::default(),
            clients: Gauge::default(),
            shutdown: shutdown.clone(),
        });
        services.spawn(take_clients(
            replay.clone(),
            listener,
            config.exposure.clone(),
        ));
        // One after the other: a constructor has few places for those that it does not know yet.
        match upstream::open(&config, &replay, port).await {
            Ok(Some(link)) => {
                let config = config.clone();
                sessions.spawn(async move { upstream::keep(&config, &replay, port, link).await });
            }
            Ok(None) => break,
            Err(error) => {
                result = Err(error);
                break;
            }
        }
    }
    if result.is_ok() {
        result = match sessions.join_next().await {
            Some(Ok(ended)) => ended,
            Some(Err(_)) | None => Ok(()),
        };
    }
    shutdown.cancel();
    while services.join_next().await.is_some() {}
    clock.close();
    result
}

async fn take_clients(replay: Arc<Replay>, listener: TcpListener, exposure: Exposure) {
    let gate = Gate {
        exposure,
        limit: MAX_CLIENTS,
        refusals: Arc::<Refusals>::default(),
    };
    let shutdown = replay.shutdown.clone();
    serve(listener, gate, shutdown, move |caller, _peer| {
        let replay = replay.clone();
        async move { session::run(&replay, caller).await }
    })
    .await;
}
