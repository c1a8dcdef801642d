//! The process that renders tiles.
//!
//! One side dials the constructor (`upstream`) and keeps a `Stage` up to date: the world
//! and the newest LIEs. The other takes clients (`client_session`), whose tiles a pool of
//! plain threads renders (`render_pool`) from the stage as it is at that moment.

mod answers;
mod assembly;
mod audit;
mod client_session;
mod ledger;
mod measured;
mod meter;
mod render_pool;
mod report;
mod scene_fetch;
mod stage;
mod upstream;

use std::sync::Arc;

use lie_accel::AccelKind;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use crate::{
    cache::SceneCache,
    connection::LinkError,
    metrics,
    network::{Exposure, Ports},
    serve::{Gate, Refusals, serve},
};
use meter::Meter;
use render_pool::RenderPool;
use stage::Stage;

/// Most clients at once.
pub const MAX_CLIENTS: usize = 64;

/// How a shader works.
#[derive(Clone, Debug)]
pub struct ShaderConfig {
    /// Where the constructor is, as [`network::dial_constructor`](crate::network::dial_constructor) takes it.
    pub constructor: String,
    /// Whom it talks to.
    pub exposure: Exposure,
    /// Render threads, at least one.
    pub threads: usize,
    /// What finds hits in the scene.
    pub accel: AccelKind,
    /// Share of the pixels, in `[0, 1]`, in which the LIEs are held against the scene after a frame
    /// was rendered with them.
    pub audit: f32,
    /// Where scenes are kept; none goes without.
    pub cache: Option<SceneCache>,
}

/// Why a shader cannot work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShaderError {
    /// The threads cannot be started.
    #[error("cannot start the render threads: {0}")]
    Threads(std::io::Error),
    /// The listener has no address.
    #[error("the listening socket has no address: {0}")]
    Listener(std::io::Error),
    /// The constructor's address can never be dialled.
    #[error(transparent)]
    Constructor(#[from] crate::network::NetworkError),
    /// There is somebody at the constructor's address, but not for us.
    #[error("the constructor at {address}: {cause}")]
    Refused {
        /// Its address.
        address: String,
        /// What is in the way.
        cause: LinkError,
    },
}

/// What all sessions share.
struct Shared {
    stage: watch::Sender<Option<Arc<Stage>>>,
    pool: RenderPool,
    /// What is done here, counted.
    meter: Arc<Meter>,
    refusals: Arc<Refusals>,
    threads: u32,
    shutdown: CancellationToken,
}

/// Renders for whoever asks, until `shutdown`. The constructor may come late, go and come
/// back: as long as there is a scene, clients are served with what is at hand.
///
/// # Errors
/// [`ShaderError`], at the start only: once a constructor has taken us in, whatever happens
/// to it may pass.
pub async fn run(
    config: ShaderConfig,
    ports: impl Into<Ports>,
    shutdown: CancellationToken,
) -> Result<(), ShaderError> {
    let ports = ports.into();
    let address = ports.farm.local_addr().map_err(ShaderError::Listener)?;
    let threads = config.threads.max(1);
    let meter = Arc::<Meter>::default();
    let pool = RenderPool::start(threads, config.audit, meter.clone());
    let shared = Arc::new(Shared {
        stage: watch::Sender::new(None),
        pool: pool.map_err(ShaderError::Threads)?,
        meter,
        refusals: Arc::default(),
        threads: threads as u32,
        shutdown: shutdown.clone(),
    });
    let gate = Gate {
        exposure: config.exposure.clone(),
        limit: MAX_CLIENTS,
        refusals: shared.refusals.clone(),
    };
    let sessions = shared.clone();
    let serving = serve(ports.farm, gate, shutdown.clone(), move |caller, _peer| {
        let shared = sessions.clone();
        async move { client_session::run(&shared, caller).await }
    });
    let upstream = async {
        let result = upstream::keep(&config, &shared, address.port()).await;
        if result.is_err() {
            shutdown.cancel();
        }
        result
    };
    let measured = shared.clone();
    let ((), result) = tokio::select! {
        ended = async { tokio::join!(serving, upstream) } => ended,
        never = metrics::serve(ports.metrics, move || measured.metrics()) => match never {},
    };
    shared.pool.close();
    result
}

#[cfg(test)]
mod tests;
