use std::{
    collections::{BTreeSet, HashMap},
    sync::Arc,
    time::Duration,
};

use lie_protocol::{ClientToShader as Out, Ping, Pong, Role, RosterEntry, ShaderToClient as In};
use tokio::{
    io::AsyncRead,
    sync::{mpsc, watch},
    task::JoinSet,
    time::sleep,
};
use tokio_util::sync::CancellationToken;

use super::hub::{Hub, Link};
use crate::{
    connection::{self, LinkError, Receiver},
    handshake,
    network::{self, Exposure},
    outbox::drain,
    scheduler::ShaderId,
};

/// First pause before dialling a shader again; it doubles up to the last.
const FIRST_PAUSE: Duration = Duration::from_millis(50);
const LAST_PAUSE: Duration = Duration::from_secs(2);
/// A shader that claims more threads gets no more credits.
const MAX_THREADS: u32 = 4096;

/// Keeps a session with every ready shader of the roster. One that leaves the roster is
/// kept for as long as it lives, so that nothing stops when the constructor does.
pub(super) async fn keep_all(
    hub: Arc<Hub>,
    mut roster: watch::Receiver<Vec<RosterEntry>>,
    exposure: Exposure,
    shutdown: CancellationToken,
) {
    let (addresses, wanted) = watch::channel(BTreeSet::new());
    let mut sessions = JoinSet::new();
    let mut running: HashMap<tokio::task::Id, String> = HashMap::new();
    loop {
        let ready: BTreeSet<String> = {
            let roster = roster.borrow_and_update();
            let ready = roster.iter().filter(|entry| entry.ready);
            ready
                .map(|entry| entry.address.as_str().to_owned())
                .collect()
        };
        let known: BTreeSet<String> = running.values().cloned().collect();
        for address in ready.difference(&known) {
            let session = keep(hub.clone(), address.clone(), exposure, wanted.clone());
            let handle = sessions.spawn(session);
            running.insert(handle.id(), address.clone());
        }
        addresses.send_replace(ready);
        tokio::select! {
            changed = roster.changed() => if changed.is_err() { return },
            Some(ended) = sessions.join_next_with_id() => {
                let id = match ended {
                    Ok((id, ())) => id,
                    Err(error) => error.id(),
                };
                running.remove(&id);
            }
            () = shutdown.cancelled() => return,
        }
    }
}

/// Keeps a session with one shader for as long as the roster names it.
async fn keep(
    hub: Arc<Hub>,
    address: String,
    exposure: Exposure,
    wanted: watch::Receiver<BTreeSet<String>>,
) {
    let mut pause = FIRST_PAUSE;
    while wanted.borrow().contains(&address) {
        match network::dial(&address, exposure).await {
            Ok(stream) => match session(&hub, &address, stream, &mut pause).await {
                error @ LinkError::Refused(_) => tracing::info!("shader {address}: {error}"),
                error => tracing::warn!("shader {address}: {error}"),
            },
            Err(error) => tracing::debug!("shader {address}: {error}"),
        }
        sleep(pause).await;
        pause = (2 * pause).min(LAST_PAUSE);
    }
}

/// One session from beginning to end; says why it ended.
async fn session(
    hub: &Hub,
    address: &str,
    stream: tokio::net::TcpStream,
    pause: &mut Duration,
) -> LinkError {
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::hello(Role::Client, 0, 0);
    let welcome = match handshake::greet(&mut receiver, &mut sender, hello).await {
        Ok(In::Welcome(welcome)) if welcome.scene == hub.scene => welcome,
        Ok(In::Welcome(_)) => return LinkError::Rules("it renders another scene".to_owned()),
        Ok(In::Refuse(refusal)) => return LinkError::Refused(refusal.reason),
        Ok(_) => return LinkError::Rules("no welcome".to_owned()),
        Err(error) => return error,
    };
    *pause = FIRST_PAUSE;
    let threads = welcome.threads.clamp(1, MAX_THREADS);
    // Two frames' requests and what else there is to say.
    let (outbox, messages) = mpsc::channel(4 * threads as usize + 16);
    let cut = CancellationToken::new();
    let link = Link {
        address: address.to_owned(),
        threads,
        outbox: outbox.clone(),
        cut: cut.clone(),
    };
    let id = hub.join(link).await;
    tracing::info!("shader {address} renders for us");
    let ended = tokio::select! {
        ended = listen(hub, id, &mut receiver, &outbox) => ended,
        ended = drain(&mut sender, messages, &cut, |_| true) => ended,
    };
    hub.leave(id).await;
    ended.err().unwrap_or(LinkError::Closed)
}

async fn listen<R: AsyncRead + Unpin>(
    hub: &Hub,
    id: ShaderId,
    receiver: &mut Receiver<R>,
    outbox: &mpsc::Sender<Out>,
) -> Result<(), LinkError> {
    loop {
        match receiver.receive().await? {
            In::TileDone(done) => hub.tile(id, done).await,
            In::Ping(Ping { nonce }) => {
                // A full box means that bytes are on their way: sign of life enough.
                let _ = outbox.try_send(Out::Pong(Pong { nonce }));
            }
            In::Pong(_) => {}
            In::Welcome(_) => return Err(LinkError::Rules("a second welcome".to_owned())),
            In::Goodbye(goodbye) => return Err(LinkError::Refused(goodbye.reason)),
            In::Refuse(refusal) => return Err(LinkError::Refused(refusal.reason)),
        }
    }
}
