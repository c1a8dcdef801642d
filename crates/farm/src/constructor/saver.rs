use std::{
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
    time::Duration,
};

use lie_protocol::SceneHash;

use crate::snapshot::{Snapshot, SnapshotFile};

/// How often what was learnt is saved.
const EVERY: Duration = Duration::from_secs(60);

/// The thread that saves LIEs while construction goes on.
pub(super) struct Saver {
    shared: Arc<Shared>,
    thread: JoinHandle<()>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    closed: Condvar,
}

#[derive(Default)]
struct State {
    /// What is not saved yet; a newer one takes its place.
    newest: Option<Snapshot>,
    closed: bool,
}

impl Saver {
    /// Starts the thread.
    pub(super) fn start(file: SnapshotFile, scene: SceneHash) -> io::Result<Self> {
        let shared = Arc::<Shared>::default();
        let theirs = shared.clone();
        let thread = thread::Builder::new()
            .name("snapshots".to_owned())
            .spawn(move || save_now_and_then(&file, scene, &theirs))?;
        Ok(Self { shared, thread })
    }

    /// There is something newer to save.
    pub(super) fn offer(&self, snapshot: Snapshot) {
        self.shared.lock().newest = Some(snapshot);
    }

    /// Saves what is left, and waits for that.
    pub(super) fn finish(self) {
        self.shared.lock().closed = true;
        self.shared.closed.notify_all();
        if self.thread.join().is_err() {
            tracing::error!("saving the LIEs ended in a panic");
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn save_now_and_then(file: &SnapshotFile, scene: SceneHash, shared: &Shared) {
    loop {
        let state = shared.lock();
        let waited = shared
            .closed
            .wait_timeout_while(state, EVERY, |state| !state.closed);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let (newest, closed) = (state.newest.take(), state.closed);
        drop(state);
        if let Some(snapshot) = newest
            && let Err(error) = file.save(&snapshot, scene)
        {
            tracing::warn!("{error}");
        }
        if closed {
            return;
        }
    }
}
