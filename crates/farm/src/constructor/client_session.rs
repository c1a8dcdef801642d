use std::time::Duration;

use glam::UVec2;
use lie_protocol::{
    CameraUpdate, ClientToConstructor as In, ClientWelcome, ConstructorToClient as Out, LieStatus,
    Ping, Pong, limit,
};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    sync::mpsc,
    time::{MissedTickBehavior, interval},
};

use super::{Shared, census::ClientRecord, registry::Member, registry::roster};
use crate::{
    View,
    connection::{LinkError, Receiver, Sender},
    convert,
    outbox::{heartbeat, say_goodbye},
};

/// How often a client hears what was learnt, at most.
const STATUS_EVERY: Duration = Duration::from_millis(50);
/// Pongs that may wait.
const PONGS: usize = 4;

/// Serves a client until it leaves.
pub(super) async fn run<R, W>(
    shared: &Shared,
    member: &Member<'_>,
    record: &ClientRecord,
    mut receiver: Receiver<R>,
    mut sender: Sender<W>,
) -> Result<(), LinkError>
where
    R: AsyncRead + Unpin,
    W: AsyncWrite + Unpin,
{
    let welcome = ClientWelcome {
        id: member.id(),
        scene: shared.summary.clone(),
    };
    receiver.count_into(&shared.census.traffic.from_clients);
    sender.count_into(&shared.census.traffic.to_clients);
    sender.send(&Out::Welcome(welcome)).await?;
    tracing::info!("client {} has joined", member.id());
    let (pongs, owed_pongs) = mpsc::channel(PONGS);
    tokio::select! {
        ended = listen(shared, member, record, receiver, &pongs) => ended,
        ended = talk(shared, member, sender, owed_pongs) => ended,
    }
}

async fn listen<R: AsyncRead + Unpin>(
    shared: &Shared,
    member: &Member<'_>,
    record: &ClientRecord,
    mut receiver: Receiver<R>,
    pongs: &mpsc::Sender<Pong>,
) -> Result<(), LinkError> {
    loop {
        match receiver.receive().await? {
            In::Camera(update) => {
                let serial = update.serial;
                let view = view(&update)?;
                shared.views.set(member.id(), serial, view);
                record.looked();
                tracing::debug!(
                    view = member.id(),
                    camera = serial,
                    "a client looks elsewhere"
                );
            }
            In::Report(report) => record.reported(report),
            In::Ping(Ping { nonce }) => {
                // A full queue means that bytes are on their way: sign of life enough.
                let _ = pongs.try_send(Pong { nonce });
            }
            In::Pong(_) => {}
            In::Goodbye(goodbye) => return Err(LinkError::Refused(goodbye.reason)),
        }
    }
}

fn view(update: &CameraUpdate) -> Result<View, LinkError> {
    let sides = 1..=limit::FRAME_SIDE;
    if !update.size.iter().all(|side| sides.contains(side)) {
        return Err(LinkError::Rules(
            "a camera with an impossible size".to_owned(),
        ));
    }
    let camera = convert::camera(&update.camera);
    Ok(View {
        camera: camera.map_err(|error| LinkError::Rules(error.to_string()))?,
        size: UVec2::from(update.size),
    })
}

async fn talk<W: AsyncWrite + Unpin>(
    shared: &Shared,
    member: &Member<'_>,
    mut sender: Sender<W>,
    mut pongs: mpsc::Receiver<Pong>,
) -> Result<(), LinkError> {
    let mut shaders = shared.registry.watch();
    shaders.mark_changed();
    let mut progress = shared.progress.subscribe();
    progress.mark_changed();
    let mut is_news = false;
    let mut status_ticks = interval(STATUS_EVERY);
    status_ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut heartbeat = heartbeat();
    let mut nonce = 0;
    loop {
        let message = tokio::select! {
            Ok(()) = shaders.changed() => Out::Roster(roster(&shaders.borrow_and_update())),
            Ok(()) = progress.changed(), if !is_news => {
                is_news = true;
                continue;
            }
            _ = status_ticks.tick(), if is_news => {
                is_news = false;
                let progress = progress.borrow_and_update();
                let serial = progress.serials.get(&member.id());
                Out::LieStatus(LieStatus {
                    camera_serial: serial.copied().unwrap_or(0),
                    ..shared.lie_status(&progress)
                })
            }
            Some(pong) = pongs.recv() => Out::Pong(pong),
            _ = heartbeat.tick() => {
                nonce += 1;
                Out::Ping(Ping { nonce })
            }
            () = shared.shutdown.cancelled() => {
                say_goodbye::<Out, W>(&mut sender, "the constructor is ending").await;
                return Ok(());
            }
        };
        sender.send(&message).await?;
    }
}
