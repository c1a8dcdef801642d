use std::{sync::Arc, time::Duration};

use lie_protocol::{
    CameraUpdate, ClientToConstructor as Out, ConstructorToClient as In, LieStatus, Ping, Pong,
    Role, RosterEntry, SceneSummary,
};
use tokio::{
    io::{AsyncRead, ReadHalf, WriteHalf},
    sync::{mpsc, watch},
    time::sleep,
};
use tokio_util::sync::CancellationToken;

use super::{ClientConfig, ClientError, hub::Hub, tally::Tally};
use crate::{
    connection::{self, LinkError, Receiver, Sender},
    handshake,
    network::{self, NetworkError},
    once::Once,
    outbox::{heartbeat, say_goodbye},
    secure::Stream,
};

/// Pause before dialling the constructor again.
const PAUSE: Duration = Duration::from_secs(1);
/// Pongs that may wait.
const PONGS: usize = 4;

/// A connection that is welcome.
pub(super) struct Link {
    receiver: Receiver<ReadHalf<Stream>>,
    sender: Sender<WriteHalf<Stream>>,
}

/// What the link moves.
pub(super) struct Ends {
    pub(super) cameras: watch::Receiver<Option<CameraUpdate>>,
    pub(super) statuses: watch::Sender<LieStatus>,
    pub(super) rosters: watch::Sender<Vec<RosterEntry>>,
    pub(super) tally: Arc<Tally>,
}

/// Connects and is welcomed.
pub(super) async fn open(
    config: &ClientConfig,
    tally: &Tally,
) -> Result<(SceneSummary, Link), ClientError> {
    let stream = network::dial_constructor(&config.constructor, &config.exposure).await?;
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::hello(Role::Client, 0, 0);
    let refused = |cause| ClientError::Constructor {
        address: config.constructor.clone(),
        cause,
    };
    match handshake::greet(&mut receiver, &mut sender, hello).await {
        Ok(In::Welcome(welcome)) => {
            tally.welcome(welcome.id);
            Ok((welcome.scene, Link { receiver, sender }))
        }
        Ok(In::Refuse(refusal)) => Err(refused(handshake::refused(&receiver, refusal))),
        Ok(_) => Err(refused(LinkError::Rules("no welcome".to_owned()))),
        Err(error) => Err(refused(error)),
    }
}

impl Ends {
    /// Moves nothing: for a constructor whose scene is not ours.
    fn idle(tally: Arc<Tally>) -> Self {
        Self {
            cameras: watch::channel(None).1,
            statuses: watch::Sender::default(),
            rosters: watch::Sender::default(),
            tally,
        }
    }
}

/// Keeps the connection, dialling again when it is lost, until `shutdown`. A constructor that
/// comes back with another scene is waited out: it may be replaced by one with ours.
pub(super) async fn keep(
    config: ClientConfig,
    mut link: Link,
    mut ends: Ends,
    hub: Arc<Hub>,
    shutdown: CancellationToken,
) {
    loop {
        let served = match hub.other_scene() {
            None => serve(link, &mut ends, &shutdown).await,
            Some(_) => serve(link, &mut Ends::idle(ends.tally.clone()), &shutdown).await,
        };
        match served {
            Ok(()) => return,
            Err(error) => tracing::warn!("the constructor is gone: {error}; dialling again"),
        }
        let mut reasons = Once::default();
        let scene;
        (scene, link) = loop {
            tokio::select! {
                () = sleep(PAUSE) => {}
                () = shutdown.cancelled() => return,
            }
            match open(&config, &ends.tally).await {
                Ok(opened) => break opened,
                // That it is not there yet was said.
                Err(error @ ClientError::Network(NetworkError::Dial { .. })) => {
                    tracing::debug!("{error}");
                }
                Err(error) => reasons.warn(&error.to_string()),
            }
        };
        if scene.hash == hub.scene {
            tracing::info!("the constructor is back");
            hub.constructor_holds(None);
        } else {
            tracing::warn!(
                "the constructor is back with another scene, '{}': pictures of ours go on with \
                 the shaders that still have it",
                scene.name
            );
            hub.constructor_holds(Some(scene.name));
        }
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
        tally,
    } = ends;
    tokio::select! {
        ended = listen(&mut receiver, statuses, rosters, &pongs) => ended,
        ended = talk(&mut sender, cameras, tally, owed_pongs, shutdown) => ended,
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
    sender: &mut Sender<WriteHalf<Stream>>,
    cameras: &mut watch::Receiver<Option<CameraUpdate>>,
    tally: &Tally,
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
                sender.send(&Out::Report(tally.report())).await?;
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
