use std::{
    collections::BTreeMap,
    net::{IpAddr, SocketAddr},
    sync::atomic::{AtomicU32, AtomicUsize, Ordering},
};

use lie_protocol::{Hello, Role, Roster, RosterEntry, Text};
use tokio::sync::watch;

use super::{MAX_CLIENTS, MAX_SHADERS};

/// Who is there. Numbers are never given twice.
#[derive(Default)]
pub(super) struct Registry {
    next_id: AtomicU32,
    clients: AtomicUsize,
    shaders: watch::Sender<BTreeMap<u32, RosterEntry>>,
}

/// A place among the shaders or clients; given back when dropped.
pub(super) struct Member<'a> {
    registry: &'a Registry,
    id: u32,
    is_client: bool,
}

impl Registry {
    /// Takes a shader in, not yet ready; `None` if there are too many.
    pub(super) fn join_shader(&self, ip: IpAddr, hello: &Hello) -> Option<Member<'_>> {
        let id = self.next_id();
        let address = SocketAddr::new(ip.to_canonical(), hello.listen_port);
        let entry = RosterEntry {
            id,
            address: Text::new(&address.to_string()),
            threads: hello.threads,
            ready: false,
            replays: hello.role == Role::Replay,
        };
        let joined = self.shaders.send_if_modified(|shaders| {
            let room = shaders.len() < MAX_SHADERS;
            if room {
                shaders.insert(id, entry);
            }
            room
        });
        joined.then_some(Member {
            registry: self,
            id,
            is_client: false,
        })
    }

    /// Takes a client in; `None` if there are too many.
    pub(super) fn join_client(&self) -> Option<Member<'_>> {
        if self.clients.fetch_add(1, Ordering::Relaxed) >= MAX_CLIENTS {
            self.clients.fetch_sub(1, Ordering::Relaxed);
            return None;
        }
        Some(Member {
            registry: self,
            id: self.next_id(),
            is_client: true,
        })
    }

    /// The shaders, and when they change.
    pub(super) fn watch(&self) -> watch::Receiver<BTreeMap<u32, RosterEntry>> {
        self.shaders.subscribe()
    }

    fn next_id(&self) -> u32 {
        self.next_id.fetch_add(1, Ordering::Relaxed) + 1
    }
}

impl Member<'_> {
    /// Its number.
    pub(super) fn id(&self) -> u32 {
        self.id
    }

    /// The shader takes clients from now on.
    pub(super) fn ready(&self) {
        self.registry.shaders.send_if_modified(|shaders| {
            let entry = shaders.get_mut(&self.id);
            entry.is_some_and(|entry| !std::mem::replace(&mut entry.ready, true))
        });
        tracing::info!("shader {} is ready", self.id);
    }
}

impl Drop for Member<'_> {
    fn drop(&mut self) {
        if self.is_client {
            self.registry.clients.fetch_sub(1, Ordering::Relaxed);
            tracing::info!("client {} has left", self.id);
        } else {
            self.registry
                .shaders
                .send_if_modified(|shaders| shaders.remove(&self.id).is_some());
            tracing::info!("shader {} has left", self.id);
        }
    }
}

/// The roster for the wire.
pub(super) fn roster(shaders: &BTreeMap<u32, RosterEntry>) -> Roster {
    Roster {
        shaders: shaders.values().cloned().collect(),
    }
}
