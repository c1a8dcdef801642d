//! The process that holds the scene and learns the LIEs.
//!
//! [`Prepared`] is everything that can be made ready before anybody connects; [`run`] serves
//! it. Construction has a thread of its own, and neither side ever waits for the other:
//! construction publishes trees (`lie_feed`), sessions publish views (`views`).

mod audits;
mod census;
mod client_session;
mod construction;
mod delta;
mod lie_feed;
mod listing;
mod measured;
mod rate;
mod registry;
mod saver;
mod shader_session;
mod shared_parts;
mod status;
mod views;

use std::sync::Arc;

use lie_accel::AccelKind;
use lie_protocol::{ConstructorToObserver as Out, Refuse, Role, SceneSummary, WireLieSettings};
use lie_render::World;
use lie_scene::Scene;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use crate::{
    Builder, ConstructSettings, LieReplica, PublishedLies, View,
    connection::{LinkError, Sender},
    convert, handshake, metrics,
    network::{Exposure, Ports},
    scene_blob::{self, BlobError, SceneBlob},
    serve::{Caller, Gate, Refusals, serve},
    snapshot::{SnapshotError, SnapshotFile},
};
use audits::Audits;
use census::Census;
use construction::{Construction, Progress};
use lie_feed::LieFeed;
use registry::Registry;
use saver::Saver;
use shared_parts::SharedParts;
use views::Views;

/// Most shaders at once.
pub const MAX_SHADERS: usize = lie_protocol::limit::SHADERS;
/// Most clients at once.
pub const MAX_CLIENTS: usize = 64;
/// Connections past these that are told why they are too many.
const SPARE: usize = 64;

/// How a constructor works.
#[derive(Clone, Debug)]
pub struct ConstructorConfig {
    /// Whom it talks to.
    pub exposure: Exposure,
    /// What finds hits in the scene.
    pub accel: AccelKind,
    /// How it learns.
    pub construct: ConstructSettings,
    /// If set, all it ever learns is learnt before anybody connects.
    pub freeze: Option<Freeze>,
    /// Where LIEs are kept over restarts.
    pub lies: Option<SnapshotFile>,
    /// Whether it takes shaders that replay recorded costs: for simulations, and nothing else.
    pub takes_replays: bool,
}

/// Learning that ends before the first connection: the same LIEs at every start.
#[derive(Clone, Debug, PartialEq)]
pub struct Freeze {
    /// This many construction samples, in whole batches; without, until the view has
    /// converged.
    pub samples: Option<u64>,
    /// What they are spent on.
    pub view: View,
}

/// Why a constructor cannot work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConstructorError {
    /// The scene cannot be sent to shaders.
    #[error(transparent)]
    Blob(#[from] BlobError),
    /// LIEs cannot be kept in this file.
    #[error(transparent)]
    Snapshot(#[from] SnapshotError),
    /// The threads cannot be started.
    #[error("cannot start the construction threads: {0}")]
    Threads(String),
}

/// A constructor that is ready to serve.
pub struct Prepared {
    blob: SceneBlob,
    summary: SceneSummary,
    builder: Builder,
    settings: ConstructSettings,
    frozen: Option<Progress>,
}

impl Prepared {
    /// Packs the scene, builds its acceleration structure, takes over what was saved and, if
    /// asked to freeze, learns all there will be to learn. Takes its time: not for an async task.
    ///
    /// # Errors
    /// [`ConstructorError`].
    pub fn new(scene: Scene, config: &ConstructorConfig) -> Result<Self, ConstructorError> {
        let blob = SceneBlob::new(scene_blob::encode(&scene)?);
        let summary = convert::summary(&scene, blob.hash());
        let world = Arc::new(World::with_accel(Arc::new(scene), config.accel));
        let mut builder = Builder::new(world, config.construct)
            .map_err(|error| ConstructorError::Threads(error.to_string()))?;
        if let Some(file) = &config.lies {
            file.restore(&mut builder, blob.hash())?;
        }
        let frozen = config
            .freeze
            .as_ref()
            .map(|freeze| construction::freeze(&mut builder, freeze));
        if let Some(file) = config.lies.as_ref().filter(|_| builder.taken() > 0)
            && let Err(error) = file.save(&builder.snapshot(), blob.hash())
        {
            tracing::warn!("{error}");
        }
        Ok(Self {
            blob,
            summary,
            builder,
            settings: config.construct,
            frozen,
        })
    }

    /// The LIEs, as a shader has them that takes all there are now.
    #[must_use]
    pub fn lies(&self, world: Arc<World>) -> PublishedLies {
        LieReplica::of(world, self.builder.tree()).publish()
    }
}

/// What all sessions share.
struct Shared {
    blob: SceneBlob,
    summary: SceneSummary,
    settings: WireLieSettings,
    takes_replays: bool,
    feed: LieFeed,
    parts: SharedParts,
    views: Views,
    registry: Registry,
    census: Census,
    refusals: Arc<Refusals>,
    progress: watch::Sender<Progress>,
    audits: Audits,
    shutdown: CancellationToken,
}

/// Serves shaders and clients until `shutdown`.
///
/// # Errors
/// [`ConstructorError::Threads`].
pub async fn run(
    config: ConstructorConfig,
    prepared: Prepared,
    ports: impl Into<Ports>,
    shutdown: CancellationToken,
) -> Result<(), ConstructorError> {
    let ports = ports.into();
    let lie = prepared.settings.lie;
    let shared = Arc::new(Shared {
        blob: prepared.blob,
        summary: prepared.summary,
        settings: WireLieSettings {
            max_depth: lie.max_depth,
            split_threshold: lie.split_threshold,
            trust: lie.trust,
        },
        takes_replays: config.takes_replays,
        feed: LieFeed::new(prepared.builder.tree().clone()),
        parts: SharedParts::default(),
        views: Views::default(),
        registry: Registry::default(),
        census: Census::new(),
        refusals: Arc::default(),
        progress: watch::Sender::new(prepared.frozen.clone().unwrap_or_default()),
        // Where others mask a light, its cells are wrong on purpose.
        audits: Audits::new(prepared.frozen.is_none() && lie.masking == 0.0),
        shutdown: shutdown.clone(),
    });
    let construction = match prepared.frozen {
        Some(_) => None,
        None => {
            let scene = shared.blob.hash();
            let saver = config.lies.map(|file| Saver::start(file, scene));
            let started = saver
                .transpose()
                .and_then(|saver| Construction::start(prepared.builder, shared.clone(), saver));
            Some(started.map_err(|error| ConstructorError::Threads(error.to_string()))?)
        }
    };
    let gate = Gate {
        exposure: config.exposure,
        limit: MAX_SHADERS + MAX_CLIENTS + SPARE,
        refusals: shared.refusals.clone(),
    };
    let sessions = shared.clone();
    let serving = serve(ports.farm, gate, shutdown, move |caller, peer| {
        session(sessions.clone(), caller, peer)
    });
    let measured = shared.clone();
    tokio::select! {
        () = serving => {}
        () = census::keep_rate(&shared) => {}
        never = metrics::serve(ports.metrics, move || measured.metrics()) => match never {},
    }
    shared.views.close();
    if let Some(construction) = construction {
        // At most one batch away, and what is to be saved.
        let joined = tokio::task::spawn_blocking(move || construction.join()).await;
        if !matches!(joined, Ok(true)) {
            tracing::error!("construction ended in a panic");
        }
    }
    Ok(())
}

/// One connection, from the hello on.
async fn session(
    shared: Arc<Shared>,
    caller: Caller,
    peer: std::net::SocketAddr,
) -> Result<(), LinkError> {
    let Caller {
        hello,
        receiver,
        mut sender,
    } = caller;
    match hello.role {
        Role::Replay if !shared.takes_replays => {
            let refusal =
                Refuse::new("this constructor takes no replays: it is not of a simulation");
            Err(handshake::refuse(&mut sender, refusal).await)
        }
        Role::Shader | Role::Replay => {
            let Some(member) = shared.registry.join_shader(peer.ip(), &hello) else {
                return Err(full(&mut sender, "shaders").await);
            };
            let record = shared.census.shader(member.id());
            let result = shader_session::run(&shared, &member, &record, receiver, sender).await;
            shared.census.shader_left(&result);
            result
        }
        Role::Client => {
            let Some(member) = shared.registry.join_client() else {
                return Err(full(&mut sender, "clients").await);
            };
            let record = shared.census.client(member.id(), peer);
            let result = client_session::run(&shared, &member, &record, receiver, sender).await;
            shared.views.remove(member.id());
            result
        }
        Role::Observer => sender.send(&Out::Status(shared.status())).await,
        Role::Constructor => {
            let refusal = Refuse::new("a constructor has no business with a constructor");
            Err(handshake::refuse(&mut sender, refusal).await)
        }
    }
}

async fn full<W: tokio::io::AsyncWrite + Unpin>(sender: &mut Sender<W>, what: &str) -> LinkError {
    let refusal = Refuse::new(&format!(
        "there are as many {what} as this constructor takes"
    ));
    handshake::refuse(sender, refusal).await
}
