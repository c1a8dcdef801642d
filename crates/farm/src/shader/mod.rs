//! The process that renders tiles.
//!
//! One side dials the constructor (`upstream`) and keeps a `Stage` up to date: the world
//! and the newest LIEs. The other takes clients (`client_session`), whose tiles a pool of
//! plain threads renders (`render_pool`) from the stage as it is at that moment.

mod assembly;
mod audit;
mod client_session;
mod ledger;
mod render_pool;
mod scene_fetch;
mod stage;
mod upstream;

use std::sync::Arc;

use lie_accel::AccelKind;
use tokio::{
    net::{TcpListener, TcpStream},
    sync::watch,
};
use tokio_util::sync::CancellationToken;

use crate::{
    cache::SceneCache,
    connection::{self, LinkError},
    network::Exposure,
    serve::serve,
};
use render_pool::RenderPool;
use stage::Stage;

/// Most clients at once.
pub const MAX_CLIENTS: usize = 64;

/// How a shader works.
#[derive(Clone, Debug)]
pub struct ShaderConfig {
    /// Where the constructor is, as `host:port`.
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
}

/// What all sessions share.
struct Shared {
    stage: watch::Sender<Option<Arc<Stage>>>,
    pool: RenderPool,
    threads: u32,
    shutdown: CancellationToken,
}

/// Renders for whoever asks, until `shutdown`. The constructor may come late, go and come
/// back: as long as there is a scene, clients are served with what is at hand.
///
/// # Errors
/// [`ShaderError`], at the start only.
pub async fn run(
    config: ShaderConfig,
    listener: TcpListener,
    shutdown: CancellationToken,
) -> Result<(), ShaderError> {
    let port = listener.local_addr().map_err(ShaderError::Listener)?.port();
    let threads = config.threads.max(1);
    let shared = Arc::new(Shared {
        stage: watch::Sender::new(None),
        pool: RenderPool::start(threads, config.audit).map_err(ShaderError::Threads)?,
        threads: threads as u32,
        shutdown: shutdown.clone(),
    });
    let exposure = config.exposure;
    let sessions = shared.clone();
    let serving = serve(
        listener,
        exposure,
        MAX_CLIENTS,
        shutdown.clone(),
        move |stream, _peer| session(sessions.clone(), stream),
    );
    let upstream = async {
        let result = upstream::keep(&config, &shared, port).await;
        if result.is_err() {
            shutdown.cancel();
        }
        result
    };
    let ((), result) = tokio::join!(serving, upstream);
    shared.pool.close();
    result
}

async fn session(shared: Arc<Shared>, stream: TcpStream) -> Result<(), LinkError> {
    let (receiver, sender) = connection::split(stream);
    client_session::run(&shared, receiver, sender).await
}

#[cfg(test)]
mod tests;
