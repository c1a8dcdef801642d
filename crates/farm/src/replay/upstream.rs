use std::{sync::atomic::Ordering, time::Duration};

use lie_protocol::{
    ConstructorToReplay as In, LieDeltaHead, Ping, Pong, ResyncRequest, Role, ShaderReady,
    ShaderReport, ShaderToConstructor as Out, Subscribe,
};
use tokio::{
    io::{ReadHalf, WriteHalf},
    sync::mpsc,
    time::{MissedTickBehavior, interval, sleep},
};

use super::{Replay, ReplayConfig, ReplayError};
use crate::{
    connection::{self, LinkError, Receiver, Sender},
    handshake,
    network::{self, NetworkError},
    outbox::drain,
    secure::Stream,
};

/// Pause before a constructor that is not there is dialled again.
const PAUSE: Duration = Duration::from_millis(100);
/// How often the constructor is told what was done.
const REPORT_EVERY: Duration = Duration::from_secs(1);
/// Messages to the constructor that may wait.
const OUTBOX: usize = 16;

/// A replay's session with its constructor.
pub(super) struct Link {
    receiver: Receiver<ReadHalf<Stream>>,
    sender: Sender<WriteHalf<Stream>>,
}

/// Waits for the constructor and is welcomed; `None` if all is to end before.
pub(super) async fn open(
    config: &ReplayConfig,
    replay: &Replay,
    port: u16,
) -> Result<Option<Link>, ReplayError> {
    let stream = loop {
        let dialled = tokio::select! {
            dialled = network::dial(&config.constructor, &config.exposure) => dialled,
            () = replay.shutdown.cancelled() => return Ok(None),
        };
        match dialled {
            Ok(stream) => break stream,
            Err(error @ NetworkError::Dial { .. }) => tracing::debug!("{error}"),
            Err(error) => return Err(error.into()),
        }
        sleep(PAUSE).await;
    };
    let (mut receiver, mut sender) = connection::split(stream);
    let address = config.constructor.clone();
    let hello = handshake::hello(Role::Replay, 1, port);
    let cause = match handshake::greet(&mut receiver, &mut sender, hello).await {
        Ok(In::Welcome(welcome)) if welcome.scene == replay.scene => {
            return Ok(Some(Link { receiver, sender }));
        }
        Ok(In::Welcome(welcome)) => {
            return Err(ReplayError::OtherScene {
                address,
                theirs: welcome.scene,
                ours: replay.scene,
            });
        }
        Ok(In::Refuse(refusal)) => handshake::refused(&receiver, refusal),
        Ok(_) => LinkError::Rules("no welcome".to_owned()),
        Err(error) => error,
    };
    Err(ReplayError::Constructor { address, cause })
}

/// Takes what the constructor sends, and connects anew when it is lost, until the end.
pub(super) async fn keep(
    config: &ReplayConfig,
    replay: &Replay,
    port: u16,
    mut link: Link,
) -> Result<(), ReplayError> {
    loop {
        let ended = link.follow(replay).await;
        if replay.shutdown.is_cancelled() {
            return Ok(());
        }
        if let Err(error) = ended {
            tracing::warn!("the constructor is gone: {error}; dialling again");
        }
        sleep(PAUSE).await;
        link = match open(config, replay, port).await? {
            Some(link) => link,
            None => return Ok(()),
        };
    }
}

impl Link {
    /// Takes what the constructor sends, until the connection ends.
    async fn follow(self, replay: &Replay) -> Result<(), LinkError> {
        let Self {
            mut receiver,
            mut sender,
        } = self;
        let (outbox, messages) = mpsc::channel(OUTBOX);
        replay.lie_version.store(0, Ordering::Relaxed);
        tokio::select! {
            ended = listen(replay, &mut receiver, &outbox) => ended,
            ended = drain(&mut sender, messages, &replay.shutdown, |_| true) => ended,
            () = report(replay, &outbox) => Ok(()),
        }
    }
}

async fn listen(
    replay: &Replay,
    receiver: &mut Receiver<ReadHalf<Stream>>,
    outbox: &mpsc::Sender<Out>,
) -> Result<(), LinkError> {
    let scene = replay.scene;
    post(outbox, Out::Subscribe(Subscribe { scene }))?;
    let mut is_ready = false;
    loop {
        match receiver.receive().await? {
            In::LieDelta(head) if !head.last => {}
            In::LieDelta(head) => {
                take(replay, head, outbox)?;
                if !std::mem::replace(&mut is_ready, true) {
                    post(outbox, Out::Ready(ShaderReady { scene }))?;
                }
            }
            In::Ping(Ping { nonce }) => {
                // A full box means that bytes are on their way: sign of life enough.
                let _ = outbox.try_send(Out::Pong(Pong { nonce }));
            }
            In::Pong(_) => {}
            In::Goodbye(goodbye) => return Err(LinkError::Refused(goodbye.reason)),
            In::Refuse(refusal) => return Err(LinkError::Refused(refusal.reason)),
            In::Welcome(_) => return Err(LinkError::Rules("a second welcome".to_owned())),
        }
    }
}

/// The last part of an update has come.
fn take(replay: &Replay, head: LieDeltaHead, outbox: &mpsc::Sender<Out>) -> Result<(), LinkError> {
    let have_version = replay.lie_version.load(Ordering::Relaxed);
    if head.from_version != 0 && head.from_version != have_version {
        return post(outbox, Out::Resync(ResyncRequest { have_version }));
    }
    replay.lie_version.store(head.to_version, Ordering::Relaxed);
    Ok(())
}

/// Tells the constructor what was done, as a shader does.
async fn report(replay: &Replay, outbox: &mpsc::Sender<Out>) {
    let mut ticks = interval(REPORT_EVERY);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        let report = ShaderReport {
            tiles: replay.tiles.get(),
            render_ns: replay.render_ns.get(),
            lie_version: replay.lie_version.load(Ordering::Relaxed),
            clients: replay.clients.get() as u32,
            ..ShaderReport::default()
        };
        // What does not fit now is out of date by the time that it does.
        let _ = outbox.try_send(Out::Report(report));
    }
}

fn post(outbox: &mpsc::Sender<Out>, message: Out) -> Result<(), LinkError> {
    outbox
        .try_send(message)
        .map_err(|_| LinkError::Rules("the constructor takes no messages".to_owned()))
}
