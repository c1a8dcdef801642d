use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
    time::Duration,
};

use lie_protocol::{ClientToShader as Out, Ping, Pong, Role, RosterEntry, ShaderToClient as In};
use tokio::{
    io::AsyncRead,
    sync::{mpsc, watch},
    task::JoinSet,
    time::{Instant, sleep},
};
use tokio_util::sync::CancellationToken;

use super::hub::{Hub, Link};
use crate::{
    connection::{self, LinkError, Receiver},
    handshake,
    network::{self, Exposure, NetworkError},
    once::Once,
    outbox::drain,
    scheduler::ShaderId,
    secure::Stream,
};

/// First pause before dialling a shader again; it doubles up to the last.
const FIRST_PAUSE: Duration = Duration::from_millis(50);
const LAST_PAUSE: Duration = Duration::from_secs(2);
/// A session that lasted for so long was a good one: after it the shader is dialled soon.
const STEADY: Duration = Duration::from_secs(5);
/// Tiles that a shader may be asked for at once, for each of its threads.
const MOST_CREDITS: usize = 8;
/// A shader that claims more threads gets no more credits.
const MAX_THREADS: u32 = 4096;

/// Where shaders are, and the numbers that the constructor knows them by.
type Places = BTreeMap<String, u32>;

/// Keeps a session with every ready shader of the roster. One that leaves the roster is
/// kept for as long as it lives, so that nothing stops when the constructor does.
pub(super) async fn keep_all(
    hub: Arc<Hub>,
    mut roster: watch::Receiver<Vec<RosterEntry>>,
    exposure: Exposure,
    shutdown: CancellationToken,
) {
    let (places, wanted) = watch::channel(Places::new());
    let mut sessions = JoinSet::new();
    let mut running: HashMap<tokio::task::Id, String> = HashMap::new();
    loop {
        let ready: Places = {
            let roster = roster.borrow_and_update();
            let is_ours = |entry: &&RosterEntry| entry.ready && entry.replays == hub.replays;
            let ready = roster.iter().filter(is_ours);
            // Sorted by number: of one address the newest counts.
            ready
                .map(|entry| (entry.address.as_str().to_owned(), entry.id))
                .collect()
        };
        let known: BTreeSet<String> = running.values().cloned().collect();
        for address in ready.keys().filter(|&address| !known.contains(address)) {
            let session = keep(
                hub.clone(),
                address.clone(),
                exposure.clone(),
                wanted.clone(),
            );
            let handle = sessions.spawn(session);
            running.insert(handle.id(), address.clone());
        }
        places.send_replace(ready);
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

/// Keeps a session with one shader for as long as the roster names it. Who cannot be reached, or
/// never stays for long, is dialled more and more rarely; at once if the roster has it anew.
async fn keep(
    hub: Arc<Hub>,
    address: String,
    exposure: Exposure,
    mut wanted: watch::Receiver<Places>,
) {
    let mut pause = FIRST_PAUSE;
    let mut reasons = Once::default();
    while let Some(number) = number_of(&wanted, &address) {
        match network::dial(&address, &exposure).await {
            Ok(stream) => {
                let begun = Instant::now();
                let (ended, was_welcome) = session(&hub, &address, stream).await;
                if was_welcome {
                    reasons.forget();
                }
                if was_welcome && begun.elapsed() >= STEADY {
                    pause = FIRST_PAUSE;
                }
                match ended {
                    error @ LinkError::Refused(_) => tracing::info!("shader {address}: {error}"),
                    error => reasons.warn(&format!("shader {address}: {error}")),
                }
            }
            Err(NetworkError::Handshake { cause, .. }) => {
                reasons.warn(&format!("shader {address}: {cause}"));
            }
            Err(error) => tracing::debug!("shader {address}: {error}"),
        }
        let is_other = |places: &Places| places.get(&address) != Some(&number);
        tokio::select! {
            () = sleep(pause) => pause = (2 * pause).min(LAST_PAUSE),
            // If the roster has it no more, that was the last round.
            goes_on = async { wanted.wait_for(is_other).await.is_ok() } => {
                if !goes_on {
                    return;
                }
                pause = FIRST_PAUSE;
            }
        }
    }
}

fn number_of(wanted: &watch::Receiver<Places>, address: &str) -> Option<u32> {
    wanted.borrow().get(address).copied()
}

/// One session from beginning to end; says why it ended, and whether the shader took us in.
async fn session(hub: &Hub, address: &str, stream: Stream) -> (LinkError, bool) {
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::hello(Role::Client, 0, 0);
    let answer = match handshake::greet(&mut receiver, &mut sender, hello).await {
        // Whatever the roster says: the picture must be one.
        Ok(In::Welcome(welcome)) if welcome.replays != hub.replays => {
            let kind = if welcome.replays {
                "replays costs"
            } else {
                "renders"
            };
            Err(LinkError::Rules(format!(
                "it {kind}, which is not asked for"
            )))
        }
        Ok(In::Welcome(welcome)) if welcome.scene == hub.scene => Ok(welcome),
        Ok(In::Welcome(_)) => Err(LinkError::Rules("it renders another scene".to_owned())),
        Ok(In::Refuse(refusal)) => Err(handshake::refused(&receiver, refusal)),
        Ok(_) => Err(LinkError::Rules("no welcome".to_owned())),
        Err(error) => Err(error),
    };
    let welcome = match answer {
        Ok(welcome) => welcome,
        Err(error) => return (error, false),
    };
    let threads = welcome.threads.clamp(1, MAX_THREADS);
    // Two frames' requests and what else there is to say.
    let (outbox, messages) = mpsc::channel(2 * MOST_CREDITS * threads as usize + 16);
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
        ended = listen(hub, (id, address), &mut receiver, &outbox) => ended,
        ended = drain(&mut sender, messages, &cut, |_| true) => ended,
    };
    hub.leave(id).await;
    (ended.err().unwrap_or(LinkError::Closed), true)
}

async fn listen<R: AsyncRead + Unpin>(
    hub: &Hub,
    (id, address): (ShaderId, &str),
    receiver: &mut Receiver<R>,
    outbox: &mpsc::Sender<Out>,
) -> Result<(), LinkError> {
    let mut failures = Once::default();
    loop {
        match receiver.receive().await? {
            In::TileDone(done) => hub.tile(id, done).await,
            In::TileFailed(failed) => {
                let reason = &failed.reason;
                failures.warn(&format!("shader {address} cannot render a tile: {reason}"));
                hub.failed(id, failed).await;
            }
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
