//! Taking connections, for every process that does.
//!
//! Who has just been accepted waits in the `lobby` until it has shown what it is (`open`); what
//! becomes of those that are not let in is written in the `journal`.

mod journal;
mod lobby;
mod open;
mod refusals;

use std::{future::Future, net::SocketAddr, sync::Arc, time::Duration};

use lie_protocol::Refuse;
use tokio::{
    net::{TcpListener, TcpStream},
    sync::Semaphore,
    task::JoinSet,
    time::{Instant, interval_at, sleep, timeout},
};
use tokio_util::sync::CancellationToken;

use crate::{
    connection::{HANDSHAKE_DEADLINE, LinkError},
    handshake,
    network::{self, Exposure},
};
use journal::Journal;
pub(crate) use lobby::{Lobby, Place};
pub(crate) use open::Caller;
use open::{Rejected, open};
use refusals::Reason;
pub(crate) use refusals::Refusals;

/// Pause after the system refused to accept, for want of file handles for instance.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);
/// How long sessions may take to say goodbye.
const FAREWELL: Duration = Duration::from_millis(500);
/// How often it is said how many were refused.
const SUMMARY_EVERY: Duration = Duration::from_secs(60);

/// Whom to take.
pub(crate) struct Gate {
    /// Which addresses, and how connections are protected.
    pub(crate) exposure: Exposure,
    /// Most peers at once that have said hello.
    pub(crate) limit: usize,
    /// Where those that are not taken are counted.
    pub(crate) refusals: Arc<Refusals>,
}

/// Takes connections until `shutdown`. Each has a task of its own, which ends when `handle`
/// returns; `handle` gets peers that have said hello, and over TLS if the gate asks for it. How a
/// connection ended is logged here and nowhere else.
pub(crate) async fn serve<H, F>(
    listener: TcpListener,
    gate: Gate,
    shutdown: CancellationToken,
    handle: H,
) where
    H: Fn(Caller, SocketAddr) -> F + Send + Sync + 'static,
    F: Future<Output = Result<(), LinkError>> + Send + 'static,
{
    let door = Arc::new(Door {
        exposure: gate.exposure,
        limit: gate.limit,
        seats: Semaphore::new(gate.limit),
        journal: Journal::default(),
        refusals: gate.refusals,
        shutdown: shutdown.clone(),
        handle,
    });
    let lobby = Lobby::default();
    let mut sessions = JoinSet::new();
    let mut summary = interval_at(Instant::now() + SUMMARY_EVERY, SUMMARY_EVERY);
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            Some(_) = sessions.join_next() => continue,
            _ = summary.tick() => {
                door.journal.summarise();
                continue;
            }
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
        if !network::allows(&door.exposure, peer.ip()) {
            door.refusals.refused(Reason::OtherMachine);
            door.journal.refused(peer, "refused, it is another machine");
            continue;
        }
        network::prepare(&stream);
        sessions.spawn(door.clone().receive(stream, peer, lobby.enter(peer.ip())));
    }
    drop(listener);
    let all_left = async { while sessions.join_next().await.is_some() {} };
    if timeout(FAREWELL, all_left).await.is_err() {
        tracing::debug!("some sessions were cut off");
    }
    door.journal.summarise();
}

/// What all connections of a process come through.
struct Door<H> {
    exposure: Exposure,
    limit: usize,
    seats: Semaphore,
    journal: Journal,
    refusals: Arc<Refusals>,
    shutdown: CancellationToken,
    handle: H,
}

impl<H, F> Door<H>
where
    H: Fn(Caller, SocketAddr) -> F,
    F: Future<Output = Result<(), LinkError>>,
{
    /// One connection from beginning to end.
    async fn receive(self: Arc<Self>, stream: TcpStream, peer: SocketAddr, place: Place) {
        let opening = timeout(HANDSHAKE_DEADLINE, open(stream, &self.exposure));
        let opened = tokio::select! {
            opened = opening => opened,
            () = self.shutdown.cancelled() => return,
            () = place.lost() => Ok(Err(LinkError::CrowdedOut.into())),
        };
        let opened = opened.unwrap_or_else(|_| Err(LinkError::Silent(HANDSHAKE_DEADLINE).into()));
        let mut caller = match opened {
            Ok(caller) => caller,
            Err(rejected) => return self.turn_away(rejected, peer, place).await,
        };
        let Ok(_seat) = self.seats.try_acquire() else {
            let reason = format!("there are {} connections already", self.limit);
            self.refusals.refused(Reason::Full);
            let error = handshake::refuse(&mut caller.sender, Refuse::new(&reason)).await;
            return self.note(peer, &error);
        };
        drop(place);
        if let Err(error) = (self.handle)(caller, peer).await {
            self.refusals.ended(&error);
            self.note(peer, &error);
        } else {
            tracing::debug!("{peer}: disconnected");
        }
    }

    async fn turn_away(&self, rejected: Rejected, peer: SocketAddr, place: Place) {
        if let Some(reason) = Reason::of(&rejected.error) {
            self.refusals.refused(reason);
        }
        match &rejected.error {
            LinkError::Closed => tracing::debug!("{peer}: disconnected"),
            LinkError::Handshake(failure) => {
                self.journal.refused(peer, &format!("refused: {failure}"));
            }
            error => self.journal.refused(peer, &error.to_string()),
        }
        tokio::select! {
            () = rejected.see_off() => {}
            () = place.lost() => {}
            () = self.shutdown.cancelled() => {}
        }
    }

    fn note(&self, peer: SocketAddr, error: &LinkError) {
        match error {
            LinkError::Closed => tracing::debug!("{peer}: disconnected"),
            LinkError::Refused(_) => tracing::info!("{peer}: {error}"),
            error => self.journal.refused(peer, &error.to_string()),
        }
    }
}
