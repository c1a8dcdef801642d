use std::{
    collections::BTreeMap,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

use crate::View;

/// What the clients look at now. Sessions write, construction reads; a new view wakes it.
#[derive(Default)]
pub(super) struct Views {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    /// By client: the serial number of its newest camera, and the view.
    views: BTreeMap<u32, (u64, View)>,
    generation: u64,
    closed: bool,
}

/// All views at one time.
pub(super) struct Snapshot {
    /// Sorted by client.
    pub(super) views: Vec<View>,
    /// The serial number of each client's camera.
    pub(super) serials: BTreeMap<u32, u64>,
    /// Rises with every change.
    pub(super) generation: u64,
}

impl Views {
    /// A client looks elsewhere.
    pub(super) fn set(&self, client: u32, serial: u64, view: View) {
        self.change(|views| {
            views.insert(client, (serial, view));
        });
    }

    /// A client has left.
    pub(super) fn remove(&self, client: u32) {
        self.change(|views| {
            views.remove(&client);
        });
    }

    /// What was known of the views is in doubt.
    pub(super) fn look_again(&self) {
        self.change(|_| {});
    }

    /// Ends every wait, now and later.
    pub(super) fn close(&self) {
        self.lock().closed = true;
        self.changed.notify_all();
    }

    /// Waits until there is a view, of another generation than `done`; `None` after
    /// [`Self::close`].
    pub(super) fn wait(&self, done: Option<u64>) -> Option<Snapshot> {
        let idle = |state: &mut State| {
            !state.closed && (state.views.is_empty() || done == Some(state.generation))
        };
        let state = self
            .changed
            .wait_while(self.lock(), idle)
            .unwrap_or_else(PoisonError::into_inner);
        if state.closed {
            return None;
        }
        let serials = state.views.iter();
        Some(Snapshot {
            views: state.views.values().map(|(_, view)| view.clone()).collect(),
            serials: serials.map(|(&id, &(serial, _))| (id, serial)).collect(),
            generation: state.generation,
        })
    }

    fn change(&self, change: impl FnOnce(&mut BTreeMap<u32, (u64, View)>)) {
        let mut state = self.lock();
        change(&mut state.views);
        state.generation += 1;
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
