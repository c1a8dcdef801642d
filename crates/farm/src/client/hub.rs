use std::{
    collections::BTreeMap,
    sync::{Mutex, MutexGuard, PoisonError},
};

use lie_protocol::{ClientToShader, SceneHash, Text, TileDone, TileFailed};
use tokio::sync::{mpsc, watch};
use tokio_util::sync::CancellationToken;

use crate::scheduler::ShaderId;

/// Events that may wait for a frame; who has more to tell waits.
const EVENTS: usize = 256;

/// Where the sessions with shaders and the frame in work meet.
pub(super) struct Hub {
    /// The scene that every shader must have.
    pub(super) scene: SceneHash,
    /// Whether its shaders replay costs instead of rendering.
    pub(super) replays: bool,
    state: Mutex<State>,
    count: watch::Sender<usize>,
    other_scene: watch::Sender<Option<Text>>,
}

#[derive(Default)]
struct State {
    links: BTreeMap<ShaderId, Link>,
    last_id: ShaderId,
    /// The frame in work and who waits for its tiles.
    frame: Option<(u64, mpsc::Sender<Event>)>,
}

/// A session with a shader, from outside. Numbers are never given twice.
#[derive(Clone)]
pub(super) struct Link {
    pub(super) address: String,
    pub(super) threads: u32,
    pub(super) outbox: mpsc::Sender<ClientToShader>,
    /// Ends the session.
    pub(super) cut: CancellationToken,
}

/// What a frame hears.
pub(super) enum Event {
    Joined(ShaderId, Link),
    Left(ShaderId),
    Tile(ShaderId, TileDone),
    Failed(ShaderId, TileFailed),
}

impl Hub {
    pub(super) fn new(scene: SceneHash, replays: bool) -> Self {
        Self {
            scene,
            replays,
            state: Mutex::default(),
            count: watch::Sender::new(0),
            other_scene: watch::Sender::new(None),
        }
    }

    /// Makes a frame the one that hears events, and gives it the sessions there are.
    pub(super) fn attach(&self, frame: u64) -> (BTreeMap<ShaderId, Link>, mpsc::Receiver<Event>) {
        let (sender, receiver) = mpsc::channel(EVENTS);
        let mut state = self.lock();
        state.frame = Some((frame, sender));
        (state.links.clone(), receiver)
    }

    /// A session has begun.
    pub(super) async fn join(&self, link: Link) -> ShaderId {
        let (id, listener) = {
            let mut state = self.lock();
            state.last_id += 1;
            let id = state.last_id;
            state.links.insert(id, link.clone());
            (id, state.listener(None))
        };
        self.count.send_modify(|count| *count += 1);
        tell(listener, Event::Joined(id, link)).await;
        id
    }

    /// A session has ended.
    pub(super) async fn leave(&self, id: ShaderId) {
        let listener = {
            let mut state = self.lock();
            state.links.remove(&id);
            state.listener(None)
        };
        self.count.send_modify(|count| *count -= 1);
        tell(listener, Event::Left(id)).await;
    }

    /// A tile has come; one of another frame than that in work is nobody's business.
    pub(super) async fn tile(&self, id: ShaderId, done: TileDone) {
        let listener = self.lock().listener(Some(done.report.frame));
        tell(listener, Event::Tile(id, done)).await;
    }

    /// A tile cannot be rendered there.
    pub(super) async fn failed(&self, id: ShaderId, failed: TileFailed) {
        let listener = self.lock().listener(Some(failed.frame));
        tell(listener, Event::Failed(id, failed)).await;
    }

    /// Render threads of all sessions there are.
    pub(super) fn threads(&self) -> u32 {
        self.lock().links.values().map(|link| link.threads).sum()
    }

    /// Sessions there are.
    pub(super) fn len(&self) -> usize {
        *self.count.borrow()
    }

    /// Waits for that many sessions.
    pub(super) async fn wait_for(&self, count: usize) {
        // The sender lives as long as `self`, so this cannot fail.
        let _ = self.count.subscribe().wait_for(|&now| now >= count).await;
    }

    /// The constructor holds this scene now, which is not ours; `None` if it is.
    pub(super) fn constructor_holds(&self, other: Option<Text>) {
        self.other_scene.send_replace(other);
    }

    /// The name of the scene that the constructor holds, if it is another than ours.
    pub(super) fn other_scene(&self) -> Option<Text> {
        self.other_scene.borrow().clone()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn listener(&self, of_frame: Option<u64>) -> Option<mpsc::Sender<Event>> {
        let (frame, sender) = self.frame.as_ref()?;
        let concerns = of_frame.is_none_or(|number| number == *frame);
        concerns.then(|| sender.clone())
    }
}

async fn tell(listener: Option<mpsc::Sender<Event>>, event: Event) {
    if let Some(listener) = listener {
        // A frame that is finished does not listen any more.
        let _ = listener.send(event).await;
    }
}
