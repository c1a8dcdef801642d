use std::{sync::Arc, time::Duration};

use lie_octree::LieSettings;
use lie_protocol::{
    ConstructorToShader as In, ResyncRequest, Role, ShaderReady, ShaderToConstructor as Out,
    ShaderWelcome, Subscribe,
};
use tokio::{io::AsyncRead, sync::mpsc, task::spawn_blocking, time::sleep};

use super::{
    ShaderConfig, ShaderError, Shared,
    answers::{answer, post},
    assembly::{Assembly, Update},
    audit, report, scene_fetch,
    stage::Stage,
};
use crate::{
    LieReplica,
    connection::{self, LinkError, Receiver},
    discovery::DiscoveryError,
    handshake,
    network::{self, NetworkError},
    once::Once,
    outbox::drain,
    secure::Stream,
};

/// First pause before dialling again; it doubles up to the last.
const FIRST_PAUSE: Duration = Duration::from_millis(100);
const LAST_PAUSE: Duration = Duration::from_secs(2);
/// Messages to the constructor that may wait.
const OUTBOX: usize = 16;

/// Keeps a connection to the constructor, dialling again whenever it is lost.
pub(super) async fn keep(
    config: &ShaderConfig,
    shared: &Shared,
    port: u16,
) -> Result<(), ShaderError> {
    let work = async {
        let mut pause = FIRST_PAUSE;
        let mut was_known = false;
        let mut welcome = Welcome::default();
        loop {
            match network::dial_constructor(&config.constructor, &config.exposure).await {
                Ok(stream) => {
                    was_known = true;
                    let ended = session(config, shared, port, stream, &mut welcome).await;
                    if shared.shutdown.is_cancelled() {
                        return Ok(());
                    }
                    if std::mem::take(&mut welcome.is_new) {
                        pause = FIRST_PAUSE;
                    }
                    welcome.lost(config, ended)?;
                }
                Err(NetworkError::Handshake { cause, .. }) => {
                    was_known = true;
                    welcome.lost(config, cause.into())?;
                }
                Err(
                    error @ (NetworkError::Dial { .. }
                    | NetworkError::Discovery(DiscoveryError::Nobody(_))),
                ) => {
                    was_known = true;
                    if pause == FIRST_PAUSE {
                        tracing::info!("{error}; trying again until it is there");
                    } else {
                        tracing::debug!("{error}");
                    }
                }
                // A name that was known once may be unknown for a while, or another's as well.
                Err(error @ (NetworkError::Address { .. } | NetworkError::Discovery(_)))
                    if was_known =>
                {
                    tracing::debug!("{error}");
                }
                Err(error) => return Err(ShaderError::Constructor(error)),
            }
            sleep(pause).await;
            pause = (2 * pause).min(LAST_PAUSE);
        }
    };
    tokio::select! {
        result = work => result,
        () = shared.shutdown.cancelled() => Ok(()),
    }
}

/// What is remembered of the constructor from one connection to the next.
#[derive(Default)]
struct Welcome {
    /// It has taken us in at least once.
    is_old: bool,
    /// It has taken us in on the connection that ended last.
    is_new: bool,
    /// Why it was lost last.
    reasons: Once,
    /// A scene that is ready but for its first LIEs.
    prepared: Option<Arc<Stage>>,
}

impl Welcome {
    fn given(&mut self) {
        (self.is_old, self.is_new) = (true, true);
        self.reasons.forget();
    }

    /// A connection is lost. What will not pass by itself ends a shader that has nothing yet to
    /// render with; any other goes on, and tries again.
    fn lost(&mut self, config: &ShaderConfig, cause: LinkError) -> Result<(), ShaderError> {
        if cause.is_lasting() && !self.is_old {
            let address = config.constructor.clone();
            return Err(ShaderError::Refused { address, cause });
        }
        let line = format!("the constructor is gone: {cause}; dialling again");
        self.reasons.warn(&line);
        Ok(())
    }
}

/// One connection from beginning to end; says why it ended.
async fn session(
    config: &ShaderConfig,
    shared: &Shared,
    port: u16,
    stream: Stream,
    constructor: &mut Welcome,
) -> LinkError {
    let (mut receiver, mut sender) = connection::split(stream);
    receiver.count_into(&shared.meter.from_constructor);
    sender.count_into(&shared.meter.to_constructor);
    let hello = handshake::hello(Role::Shader, shared.threads, port);
    let welcome = match handshake::greet(&mut receiver, &mut sender, hello).await {
        Ok(In::Welcome(welcome)) => welcome,
        Ok(In::Refuse(refusal)) => return handshake::refused(&receiver, refusal),
        Ok(_) => return LinkError::Rules("no welcome".to_owned()),
        Err(error) => return error,
    };
    constructor.given();
    let _here = shared.meter.constructors.hold();
    tracing::info!("the constructor's shader {}", welcome.id);
    let (outbox, messages) = mpsc::channel(OUTBOX);
    let ended = tokio::select! {
        ended = follow(config, shared, &welcome, &mut constructor.prepared, &mut receiver, &outbox) => ended,
        ended = drain(&mut sender, messages, &shared.shutdown, |_| true) => ended,
        () = audit::report(shared, &outbox) => Ok(()),
        () = report::keep(shared, &outbox) => Ok(()),
    };
    ended.err().unwrap_or(LinkError::Closed)
}

/// Gets the scene, then takes in LIE updates for as long as they come. Clients get a new scene with
/// its first LIEs, and the one before until then.
async fn follow<R: AsyncRead + Unpin>(
    config: &ShaderConfig,
    shared: &Shared,
    welcome: &ShaderWelcome,
    prepared: &mut Option<Arc<Stage>>,
    receiver: &mut Receiver<R>,
    outbox: &mpsc::Sender<Out>,
) -> Result<(), LinkError> {
    let settings = LieSettings {
        max_depth: welcome.settings.max_depth,
        split_threshold: welcome.settings.split_threshold,
        trust: welcome.settings.trust,
        ..LieSettings::default()
    };
    let present = shared.stage.borrow().clone();
    if present
        .as_ref()
        .is_some_and(|stage| stage.scene != welcome.scene)
    {
        tracing::warn!("the constructor holds another scene now: clients of ours will be let go");
    }
    let known = present
        .into_iter()
        .chain(prepared.take())
        .find(|stage| stage.scene == welcome.scene);
    let stage = match known {
        Some(stage) => stage,
        None => {
            let world = scene_fetch::world(config, welcome, receiver, outbox).await?;
            Arc::new(Stage::new(welcome.scene, world, settings))
        }
    };
    *prepared = Some(stage.clone());
    let scene = welcome.scene;
    post(outbox, Out::Subscribe(Subscribe { scene }))?;
    let mut ready = false;
    let mut assembly = Assembly::default();
    let mut replica = Some(LieReplica::new(stage.world.clone(), settings));
    loop {
        match receiver.receive().await? {
            In::LieDelta(part) => {
                let update = assembly.add(part);
                let update = update.map_err(|error| LinkError::Rules(error.to_string()))?;
                if let Some(update) = update {
                    let current = replica.take();
                    let is_snapshot = update.from_version == 0;
                    replica = Some(take_in(current, update, &stage, settings, outbox).await?);
                    if is_snapshot && !std::mem::replace(&mut ready, true) {
                        *prepared = None;
                        show(shared, &stage);
                        post(outbox, Out::Ready(ShaderReady { scene }))?;
                    }
                }
            }
            other => answer(other, outbox)?,
        }
    }
}

/// Lets clients have a stage, if they do not have it already.
fn show(shared: &Shared, stage: &Arc<Stage>) {
    shared.stage.send_if_modified(|shown| {
        let is_new = !shown
            .as_ref()
            .is_some_and(|shown| Arc::ptr_eq(shown, stage));
        if is_new {
            *shown = Some(stage.clone());
        }
        is_new
    });
}

/// Applies an update, or asks for a snapshot if it does not fit. Work for another thread.
async fn take_in(
    replica: Option<LieReplica>,
    update: Update,
    stage: &Arc<Stage>,
    settings: LieSettings,
    outbox: &mpsc::Sender<Out>,
) -> Result<LieReplica, LinkError> {
    let fresh = || LieReplica::new(stage.world.clone(), settings);
    let mut replica = match replica {
        Some(replica) if update.from_version != 0 => replica,
        _ => fresh(),
    };
    if update.from_version != replica.version() {
        let have_version = replica.version();
        tracing::info!(
            "an update from version {} came at version {have_version}: asking for a snapshot",
            update.from_version
        );
        post(outbox, Out::Resync(ResyncRequest { have_version }))?;
        return Ok(replica);
    }
    let stage = stage.clone();
    let applied = spawn_blocking(move || {
        replica.apply(&update.cells, update.to_version)?;
        stage.lies.store(Arc::new(replica.publish()));
        Ok(replica)
    })
    .await;
    match applied {
        Ok(Ok(replica)) => Ok(replica),
        Ok(Err::<_, crate::ReplicaError>(error)) => Err(LinkError::Rules(error.to_string())),
        Err(_) => Err(LinkError::Rules(
            "an update could not be applied".to_owned(),
        )),
    }
}
