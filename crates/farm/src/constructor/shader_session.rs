use lie_protocol::{
    ConstructorToShader as Out, Ping, Pong, SceneChunk, SceneReady, SceneRequest,
    ShaderToConstructor as In, ShaderWelcome, limit,
};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    sync::mpsc,
};

use super::{Shared, census::ShaderRecord, lie_feed::Update, registry::Member};
use crate::{
    connection::{LinkError, Receiver, Sender},
    outbox::{heartbeat, say_goodbye},
};

/// What the listening half asks of the talking half.
enum Command {
    Scene(SceneRequest),
    Subscribe,
    Ready,
    Resync,
    Pong(Pong),
}

/// Commands that may wait; a shader in its senses has three.
const COMMANDS: usize = 16;

/// Serves a shader until it leaves.
pub(super) async fn run<R, W>(
    shared: &Shared,
    member: &Member<'_>,
    record: &ShaderRecord,
    mut receiver: Receiver<R>,
    mut sender: Sender<W>,
) -> Result<(), LinkError>
where
    R: AsyncRead + Unpin,
    W: AsyncWrite + Unpin,
{
    let welcome = ShaderWelcome {
        id: member.id(),
        scene: shared.blob.hash(),
        scene_length: shared.blob.bytes().len() as u64,
        settings: shared.settings,
    };
    receiver.count_into(&record.received);
    sender.count_into(&record.sent);
    sender.send(&Out::Welcome(welcome)).await?;
    tracing::info!("shader {} has joined", member.id());
    let (commands, orders) = mpsc::channel(COMMANDS);
    tokio::select! {
        ended = listen(shared, record, receiver, &commands) => ended,
        ended = talk(shared, member, record, sender, orders) => ended,
    }
}

async fn listen<R: AsyncRead + Unpin>(
    shared: &Shared,
    record: &ShaderRecord,
    mut receiver: Receiver<R>,
    commands: &mpsc::Sender<Command>,
) -> Result<(), LinkError> {
    loop {
        let message = receiver.receive().await?;
        record.heard();
        let command = match message {
            In::SceneRequest(request) => Command::Scene(request),
            In::Subscribe(_) => Command::Subscribe,
            In::Ready(_) => Command::Ready,
            In::Resync(_) => Command::Resync,
            In::Ping(Ping { nonce }) => {
                // A full queue means that bytes are on their way: sign of life enough.
                let _ = commands.try_send(Command::Pong(Pong { nonce }));
                continue;
            }
            In::Pong(Pong { nonce }) => {
                record.answered(nonce);
                continue;
            }
            In::Report(report) => {
                record.reported(report);
                continue;
            }
            In::Audit(report) => {
                if shared.audits.add(&report) {
                    shared.views.look_again();
                }
                // Clients are told of it.
                shared.progress.send_modify(|_| {});
                continue;
            }
            In::Goodbye(goodbye) => return Err(LinkError::Refused(goodbye.reason)),
        };
        if commands.try_send(command).is_err() {
            return Err(LinkError::Rules("too many requests at once".to_owned()));
        }
    }
}

async fn talk<W: AsyncWrite + Unpin>(
    shared: &Shared,
    member: &Member<'_>,
    record: &ShaderRecord,
    mut sender: Sender<W>,
    mut orders: mpsc::Receiver<Command>,
) -> Result<(), LinkError> {
    let mut heartbeat = heartbeat();
    let mut subscription = None;
    let mut nonce = 0;
    loop {
        let owed = async {
            match &subscription {
                Some(subscription) => super::lie_feed::Subscription::owed(subscription).await,
                None => std::future::pending().await,
            }
        };
        tokio::select! {
            order = orders.recv() => match order {
                Some(Command::Scene(request)) => send_scene(shared, request, &mut sender).await?,
                Some(Command::Subscribe) if subscription.is_none() => {
                    subscription = Some(shared.feed.subscribe(member.id()));
                }
                Some(Command::Subscribe) => {}
                Some(Command::Ready) => member.ready(),
                Some(Command::Resync) => {
                    if let Some(subscription) = &subscription {
                        tracing::info!("shader {} asks for a snapshot", member.id());
                        subscription.resync();
                    }
                }
                Some(Command::Pong(pong)) => sender.send(&Out::Pong(pong)).await?,
                None => return Ok(()),
            },
            () = owed => {
                let update = subscription.as_ref().and_then(|subscription| subscription.take());
                if let Some(update) = update {
                    send_update(shared, update, &mut sender).await?;
                }
            }
            _ = heartbeat.tick() => {
                nonce += 1;
                record.asked(nonce);
                sender.send(&Out::Ping(Ping { nonce })).await?;
            }
            () = shared.shutdown.cancelled() => {
                say_goodbye::<Out, W>(&mut sender, "the constructor is ending").await;
                return Ok(());
            }
        }
    }
}

/// Sends the scene, a chunk at a time: the socket's pace is ours.
async fn send_scene<W: AsyncWrite + Unpin>(
    shared: &Shared,
    request: SceneRequest,
    sender: &mut Sender<W>,
) -> Result<(), LinkError> {
    let bytes = shared.blob.bytes();
    let start = usize::try_from(request.offset).ok();
    let rest = start.and_then(|start| bytes.get(start..));
    let Some(rest) = rest.filter(|_| request.scene == shared.blob.hash()) else {
        return Err(LinkError::Rules(
            "a request for a scene that is not here".to_owned(),
        ));
    };
    let mut offset = request.offset;
    for chunk in rest.chunks(limit::SCENE_CHUNK) {
        let message = SceneChunk {
            offset,
            bytes: chunk.to_vec(),
        };
        offset += chunk.len() as u64;
        sender.send(&Out::SceneChunk(message)).await?;
    }
    let scene = request.scene;
    sender.send(&Out::SceneReady(SceneReady { scene })).await
}

/// Sends an update part by part, each of which other shaders may be sent as well.
async fn send_update<W: AsyncWrite + Unpin>(
    shared: &Shared,
    update: Update,
    sender: &mut Sender<W>,
) -> Result<(), LinkError> {
    let mut way = shared.parts.of(update);
    while let Some(part) = way.next().await? {
        sender.send_encoded(part.bytes()).await?;
    }
    Ok(())
}
