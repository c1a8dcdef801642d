//! Taking connections, for every process that does.

use std::{future::Future, net::SocketAddr, time::Duration};

use tokio::{
    net::{TcpListener, TcpStream},
    task::JoinSet,
    time::{sleep, timeout},
};
use tokio_util::sync::CancellationToken;

use crate::{
    connection::LinkError,
    network::{self, Exposure},
};

/// Pause after the system refused to accept, for want of file handles for instance.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);
/// How long sessions may take to say goodbye.
const FAREWELL: Duration = Duration::from_millis(500);

/// Takes connections until `shutdown`, at most `limit` at once; each is handled by a task of
/// its own, which ends when `handle` returns. How it ended is logged here and nowhere else.
pub(crate) async fn serve<H, F>(
    listener: TcpListener,
    exposure: Exposure,
    limit: usize,
    shutdown: CancellationToken,
    handle: H,
) where
    H: Fn(TcpStream, SocketAddr) -> F,
    F: Future<Output = Result<(), LinkError>> + Send + 'static,
{
    let mut sessions = JoinSet::new();
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            Some(_) = sessions.join_next() => continue,
            () = shutdown.cancelled() => break,
        };
        let (stream, peer) = match accepted {
            Ok(accepted) => accepted,
            Err(error) => {
                tracing::warn!("cannot take a connection: {error}");
                sleep(ACCEPT_PAUSE).await;
                continue;
            }
        };
        if !network::allows(exposure, peer.ip()) {
            tracing::warn!("{peer}: refused, it is another machine");
            continue;
        }
        if sessions.len() >= limit {
            tracing::warn!("{peer}: refused, there are {limit} connections already");
            continue;
        }
        network::prepare(&stream);
        let session = handle(stream, peer);
        sessions.spawn(async move { log_end(peer, session.await) });
    }
    drop(listener);
    let all_left = async { while sessions.join_next().await.is_some() {} };
    if timeout(FAREWELL, all_left).await.is_err() {
        tracing::debug!("some sessions were cut off");
    }
}

fn log_end(peer: SocketAddr, result: Result<(), LinkError>) {
    match result {
        Ok(()) | Err(LinkError::Closed) => tracing::debug!("{peer}: disconnected"),
        Err(error @ LinkError::Refused(_)) => tracing::info!("{peer}: {error}"),
        Err(error) => tracing::warn!("{peer}: {error}"),
    }
}
