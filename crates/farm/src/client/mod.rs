//! The process that wants pictures: steers the constructor, holds a session to every shader
//! of the roster, and puts frames together.

mod constructor_link;
mod cut;
mod frame_run;
mod hub;
mod request;
mod shader_link;
mod standing;
mod tally;
mod transit;

use std::{sync::Arc, time::Duration};

use glam::UVec2;
use lie_protocol::{CameraUpdate, LieStatus, SceneSummary, Text};
use lie_render::Tile;
use lie_scene::Camera;
use tokio::{sync::watch, task::JoinSet};
use tokio_util::sync::CancellationToken;

use crate::{
    connection::LinkError,
    convert,
    network::{Exposure, NetworkError},
    scheduler::LatePolicy,
};
use frame_run::{FrameRun, Memory};
use hub::Hub;
use tally::Tally;
use tracing::Instrument;

pub use request::{Frame, FrameRequest, FrameStats, ShaderShare};

/// How a client works.
#[derive(Clone, Debug)]
pub struct ClientConfig {
    /// Where the constructor is, as [`network::dial_constructor`](crate::network::dial_constructor) takes it.
    pub constructor: String,
    /// Whom it talks to.
    pub exposure: Exposure,
    /// How long a frame may be without any shader before it fails.
    pub shader_timeout: Duration,
    /// When a tile is late.
    pub late: LatePolicy,
    /// Whether it is served by shaders that replay recorded costs, and by no others: what it gets
    /// is no picture. Without, replays are left alone.
    pub replays: bool,
}

impl ClientConfig {
    /// The usual waits.
    #[must_use]
    pub fn new(constructor: impl Into<String>, exposure: Exposure) -> Self {
        Self {
            constructor: constructor.into(),
            exposure,
            shader_timeout: Duration::from_secs(60),
            late: LatePolicy::default(),
            replays: false,
        }
    }
}

/// Why a client has no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ClientError {
    /// The constructor cannot be reached.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The constructor does not let us in.
    #[error("the constructor at {address}: {cause}")]
    Constructor {
        /// Its address.
        address: String,
        /// What happened.
        cause: LinkError,
    },
    /// Nobody renders.
    #[error("no shader was there for {} s", .0.as_secs_f32())]
    NoShaders(Duration),
    /// The constructor was started anew with another scene, and nobody is left who renders ours.
    #[error(
        "the constructor at {address} now holds another scene, '{scene}', and nobody renders \
         this one any more: connect again to see it"
    )]
    OtherScene {
        /// Its address.
        address: String,
        /// The name of its scene.
        scene: Text,
    },
    /// A tile was tried so often that it cannot be anybody's mishap, by as many shaders as there were.
    #[error(
        "tile {number} of the frame, {size} pixels at {origin}, cannot be rendered: {reasons}",
        size = tile.size,
        origin = tile.origin
    )]
    Tile {
        /// Its number.
        number: u32,
        /// Where it is.
        tile: Tile,
        /// What each of the shaders said.
        reasons: String,
    },
    /// The frame cannot be asked for.
    #[error("the frame's size or samples are out of their limits")]
    Request,
}

/// A connected client. Its connections live in tasks of their own until it is dropped; the
/// constructor may go and come back.
pub struct Client {
    config: ClientConfig,
    summary: SceneSummary,
    hub: Arc<Hub>,
    camera: watch::Sender<Option<CameraUpdate>>,
    status: watch::Receiver<LieStatus>,
    frames: u64,
    memory: Memory,
    tally: Arc<Tally>,
    shutdown: CancellationToken,
    _tasks: JoinSet<()>,
}

impl Client {
    /// Connects to a constructor, and from then on to every shader that it names.
    ///
    /// # Errors
    /// [`ClientError`] if the constructor is not there or does not want us.
    pub async fn connect(config: ClientConfig) -> Result<Self, ClientError> {
        let shutdown = CancellationToken::new();
        let tally = Arc::<Tally>::default();
        let (summary, link) = constructor_link::open(&config, &tally).await?;
        let hub = Arc::new(Hub::new(summary.hash, config.replays));
        let (camera, cameras) = watch::channel(None);
        let (statuses, status) = watch::channel(LieStatus::default());
        let (rosters, roster) = watch::channel(Vec::new());
        let ends = constructor_link::Ends {
            cameras,
            statuses,
            rosters,
            tally: tally.clone(),
        };
        let mut tasks = JoinSet::new();
        let constructor =
            constructor_link::keep(config.clone(), link, ends, hub.clone(), shutdown.clone());
        tasks.spawn(constructor);
        tasks.spawn(shader_link::keep_all(
            hub.clone(),
            roster,
            config.exposure.clone(),
            shutdown.clone(),
        ));
        Ok(Self {
            config,
            summary,
            hub,
            camera,
            status,
            frames: 0,
            memory: Memory::default(),
            tally,
            shutdown,
            _tasks: tasks,
        })
    }

    /// What there is to see.
    #[must_use]
    pub fn scene(&self) -> &SceneSummary {
        &self.summary
    }

    /// What the constructor has learnt, as it tells.
    #[must_use]
    pub fn status(&self) -> watch::Receiver<LieStatus> {
        self.status.clone()
    }

    /// The name of the scene that the constructor holds now, if it came back with another. Frames
    /// of ours go on for as long as there are shaders that have it.
    #[must_use]
    pub fn other_scene(&self) -> Option<Text> {
        self.hub.other_scene()
    }

    /// Shaders that are connected now.
    #[must_use]
    pub fn shaders(&self) -> usize {
        self.hub.len()
    }

    /// Waits until this many shaders are connected.
    pub async fn wait_for_shaders(&self, count: usize) {
        self.hub.wait_for(count).await;
    }

    /// Tells the constructor what is looked at. Returns the number under which
    /// [`LieStatus::camera_serial`] speaks of it.
    pub fn set_camera(&self, camera: &Camera, size: UVec2) -> u64 {
        let mut number = 0;
        self.camera.send_modify(|update| {
            let before = update.as_ref().map_or(0, |update| update.serial);
            number = before + 1;
            *update = Some(CameraUpdate {
                serial: number,
                camera: convert::wire_camera(camera),
                size: size.to_array(),
            });
        });
        number
    }

    /// Waits until nothing is left to learn about the camera of that number, at most this
    /// long; says whether it came to that.
    pub async fn settled(&self, camera_serial: u64, timeout: Duration) -> bool {
        let mut status = self.status.clone();
        let settled = status.wait_for(|status| {
            status.frozen || (status.converged && status.camera_serial >= camera_serial)
        });
        matches!(tokio::time::timeout(timeout, settled).await, Ok(Ok(_)))
    }

    /// Renders a frame with all shaders there are, and with those that come meanwhile. A
    /// shader that is lost is replaced by the others. If this is dropped while it waits, the
    /// shaders are told to stop.
    ///
    /// # Errors
    /// [`ClientError::NoShaders`] if there is none for too long, at once
    /// [`ClientError::OtherScene`] if none will come, and [`ClientError::Tile`] if shaders fail at one of its tiles.
    pub async fn render_frame(&mut self, request: &FrameRequest) -> Result<Frame, ClientError> {
        self.frames += 1;
        let view = self.tally.view();
        let (config, threads) = (&self.config, self.hub.threads());
        let run = FrameRun::new(self.frames, request, config, &mut self.memory, threads)?;
        let run = run.of_view(view);
        let span = tracing::error_span!("frame", view, frame = self.frames);
        self.tally.begin();
        let frame = run.finish(&self.hub).instrument(span.clone()).await?;
        self.tally.finished(&frame.stats);
        span.in_scope(|| tracing::debug!("a frame is done in {:.1} ms", frame.stats.frame_ms));
        Ok(frame)
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.shutdown.cancel();
    }
}
