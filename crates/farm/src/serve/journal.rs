//! What is logged of peers that are refused: each address and reason once, then how often.

use std::{
    collections::HashMap,
    net::{IpAddr, SocketAddr},
    sync::{Mutex, MutexGuard, PoisonError},
};

use super::lobby::network_of;

/// Most reasons that one address gets told apart by.
const REASONS_PER_ADDRESS: usize = 8;
/// Most addresses and reasons to remember.
const ENTRIES: usize = 512;

/// Refusals since the last summary. Who was silent for a whole interval is forgotten, and logged
/// again when it comes back.
#[derive(Default)]
pub(super) struct Journal(Mutex<State>);

#[derive(Default)]
struct State {
    entries: HashMap<(IpAddr, String), Entry>,
    /// Refusals that are not told apart any more.
    others: u64,
}

struct Entry {
    /// The first who gave the reason.
    peer: SocketAddr,
    /// Since the last summary, and beyond the one that was logged.
    repeated: u64,
}

impl Journal {
    /// Logs a refusal, or counts it if there was the same before.
    pub(super) fn refused(&self, peer: SocketAddr, reason: &str) {
        if self.is_news(peer, reason) {
            tracing::warn!("{peer}: {reason}");
        } else {
            tracing::debug!("{peer}: {reason}");
        }
    }

    /// Logs how often refusals were repeated.
    pub(super) fn summarise(&self) {
        for line in self.summary() {
            tracing::warn!("{line}");
        }
    }

    fn is_news(&self, peer: SocketAddr, reason: &str) -> bool {
        let mut state = self.lock();
        let key = (network_of(peer.ip()), reason.to_owned());
        if let Some(entry) = state.entries.get_mut(&key) {
            entry.repeated += 1;
            return false;
        }
        let of_this = state.entries.keys().filter(|(ip, _)| *ip == key.0).count();
        if of_this >= REASONS_PER_ADDRESS || state.entries.len() >= ENTRIES {
            state.others += 1;
            return false;
        }
        state.entries.insert(key, Entry { peer, repeated: 0 });
        true
    }

    fn summary(&self) -> Vec<String> {
        let mut state = self.lock();
        let mut lines = Vec::new();
        state.entries.retain(|(_, reason), entry| {
            let times = std::mem::take(&mut entry.repeated);
            if times > 0 {
                let ip = entry.peer.ip();
                lines.push(format!("{ip}: {times} more times: {reason}"));
            }
            times > 0
        });
        let others = std::mem::take(&mut state.others);
        if others > 0 {
            lines.push(format!(
                "{others} more connections were refused, for too many reasons to tell"
            ));
        }
        lines
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(number: u32) -> SocketAddr {
        let port = 1000 + (number % 1000) as u16;
        SocketAddr::new(std::net::Ipv4Addr::from(0x0a00_0000 + number).into(), port)
    }

    #[test]
    fn the_same_is_logged_once_and_then_counted() {
        let journal = Journal::default();
        let (first, again) = (peer(1), SocketAddr::new(peer(1).ip(), 9));
        assert!(journal.is_news(first, "garbage"));
        for _ in 0..41 {
            assert!(!journal.is_news(again, "garbage"));
        }
        assert!(journal.is_news(again, "expired"));
        assert!(journal.is_news(peer(2), "garbage"));
        assert_eq!(journal.summary(), ["10.0.0.1: 41 more times: garbage"]);
        // It went on until now, so it is no news yet; the others have stopped.
        assert!(!journal.is_news(first, "garbage"));
        assert!(journal.is_news(first, "expired"));
        assert_eq!(journal.summary(), ["10.0.0.1: 1 more times: garbage"]);
        assert_eq!(journal.summary(), Vec::<String>::new());
        assert!(journal.is_news(first, "garbage"));
    }

    #[test]
    fn neither_many_reasons_nor_many_addresses_fill_log_or_memory() {
        let journal = Journal::default();
        let told = (0..1000).filter(|i| journal.is_news(peer(1), &i.to_string()));
        assert_eq!(told.count(), REASONS_PER_ADDRESS);
        let told = (0..100_000).filter(|&i| journal.is_news(peer(2 + i), "garbage"));
        assert_eq!(told.count(), ENTRIES - REASONS_PER_ADDRESS);
        let lines = journal.summary();
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(journal.lock().entries.is_empty());
    }
}
