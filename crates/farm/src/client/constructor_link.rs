use std::time::Duration;

use lie_protocol::{
    CameraUpdate, ClientToConstructor as Out, ConstructorToClient as In, LieStatus, Ping, Pong,
    Role, RosterEntry, SceneSummary,
};
use tokio::{
    io::{AsyncRead, ReadHalf, WriteHalf},
    net::TcpStream,
    sync::{mpsc, watch},
    time::sleep,
};
use tokio_util::sync::CancellationToken;

use super::{ClientConfig, ClientError};
use crate::{
    connection::{self, LinkError, Receiver, Sender},
    handshake, network,
    outbox::{heartbeat, say_goodbye},
};

/// Pause before dialling the constructor again.
const PAUSE: Duration = Duration::from_secs(1);
/// Pongs that may wait.
const PONGS: usize = 4;

/// A connection that is welcome.
pub(super) struct Link {
    receiver: Receiver<ReadHalf<TcpStream>>,
    sender: Sender<WriteHalf<TcpStream>>,
}

/// What the link moves.
pub(super) struct Ends {
    pub(super) cameras: watch::Receiver<Option<CameraUpdate>>,
    pub(super) statuses: watch::Sender<LieStatus>,
    pub(super) rosters: watch::Sender<Vec<RosterEntry>>,
}

/// Connects and is welcomed.
pub(super) async fn open(config: &ClientConfig) -> Result<(SceneSummary, Link), ClientError> {
    let stream = network::dial(&config.constructor, config.exposure).await?;
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::hello(Role::Client, 0, 0);
    let refused = |cause| ClientError::Constructor {
        address: config.constructor.clone(),
        cause,
    };
    match handshake::greet(&mut receiver, &mut sender, hello).await {
        Ok(In::Welcome(welcome)) => Ok((welcome.scene, Link { receiver, sender })),
        Ok(In::Refuse(refusal)) => Err(refused(LinkError::Refused(refusal.reason))),
        Ok(_) => Err(refused(LinkError::Rules("no welcome".to_owned()))),
        Err(error) => Err(refused(error)),
    }
}

/// Keeps the connection, dialling again when it is lost, until `shutdown`.
pub(super) async fn keep(
    config: ClientConfig,
    mut link: Link,
    mut ends: Ends,
    shutdown: CancellationToken,
) {
    loop {
        match serve(link, &mut ends, &shutdown).await {
            Ok(()) => return,
            Err(error) => tracing::warn!("the constructor is gone: {error}; dialling again"),
        }
        link = loop {
            tokio::select! {
                () = sleep(PAUSE) => {}
                () = shutdown.cancelled() => return,
            }
            match open(&config).await {
                Ok((_, link)) => break link,
                Err(error) => tracing::debug!("{error}"),
            }
        };
        tracing::info!("the constructor is back");
    }
}

async fn serve(link: Link, ends: &mut Ends, shutdown: &CancellationToken) -> Result<(), LinkError> {
    let Link {
        mut receiver,
        mut sender,
    } = link;
    let (pongs, owed_pongs) = mpsc::channel(PONGS);
    let Ends {
        cameras,
        statuses,
        rosters,
    } = ends;
    tokio::select! {
        ended = listen(&mut receiver, statuses, rosters, &pongs) => ended,
        ended = talk(&mut sender, cameras, owed_pongs, shutdown) => ended,
    }
}

async fn listen<R: AsyncRead + Unpin>(
    receiver: &mut Receiver<R>,
    statuses: &watch::Sender<LieStatus>,
    rosters: &watch::Sender<Vec<RosterEntry>>,
    pongs: &mpsc::Sender<Pong>,
) -> Result<(), LinkError> {
    loop {
        match receiver.receive().await? {
            In::Roster(roster) => {
                rosters.send_replace(roster.shaders);
            }
            In::LieStatus(status) => {
                statuses.send_replace(status);
            }
            In::Ping(Ping { nonce }) => {
                // A full queue means that bytes are on their way: sign of life enough.
                let _ = pongs.try_send(Pong { nonce });
            }
            In::Pong(_) => {}
            In::Welcome(_) => return Err(LinkError::Rules("a second welcome".to_owned())),
            In::Goodbye(goodbye) => return Err(LinkError::Refused(goodbye.reason)),
            In::Refuse(refusal) => return Err(LinkError::Refused(refusal.reason)),
        }
    }
}

async fn talk(
    sender: &mut Sender<WriteHalf<TcpStream>>,
    cameras: &mut watch::Receiver<Option<CameraUpdate>>,
    mut pongs: mpsc::Receiver<Pong>,
    shutdown: &CancellationToken,
) -> Result<(), LinkError> {
    // A constructor that is new does not know where we look.
    cameras.mark_changed();
    let mut heartbeat = heartbeat();
    let mut nonce = 0;
    loop {
        let message = tokio::select! {
            Ok(()) = cameras.changed() => match cameras.borrow_and_update().clone() {
                Some(camera) => Out::Camera(camera),
                None => continue,
            },
            Some(pong) = pongs.recv() => Out::Pong(pong),
            _ = heartbeat.tick() => {
                nonce += 1;
                Out::Ping(Ping { nonce })
            }
            () = shutdown.cancelled() => {
                say_goodbye::<Out, _>(sender, "the client is ending").await;
                return Ok(());
            }
        };
        sender.send(&message).await?;
    }
}
