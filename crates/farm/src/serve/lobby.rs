//! Where connections wait until it is known who they are.
//!
//! A stranger costs a socket and some work, so there is room for a number of them only. When
//! there is no more, nobody new is turned away: who has waited longest goes, of the address that
//! has the most here. Who says a hello at once is through in some milliseconds, and who says nothing
//! keeps no place from anybody. Those who are through are not counted here and cannot be crowded out.

use std::{
    collections::{BTreeMap, HashMap},
    net::{IpAddr, Ipv6Addr},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use tokio_util::sync::CancellationToken;

/// Most strangers at once.
pub(super) const ROOM: usize = 256;
/// Most strangers of one address.
pub(super) const ROOM_PER_ADDRESS: usize = 64;

/// The strangers there are.
#[derive(Clone, Default)]
pub(crate) struct Lobby(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    last: u64,
    /// By the order in which they came.
    strangers: BTreeMap<u64, Stranger>,
}

struct Stranger {
    address: IpAddr,
    leave: CancellationToken,
}

/// A place in the lobby; given back when dropped.
pub(crate) struct Place {
    lobby: Lobby,
    number: u64,
    leave: CancellationToken,
}

impl Lobby {
    /// Takes a stranger in, if need be in the place of another.
    pub(crate) fn enter(&self, from: IpAddr) -> Place {
        let (address, leave) = (network_of(from), CancellationToken::new());
        let mut state = self.lock();
        state.make_room(address);
        state.last += 1;
        let number = state.last;
        let stranger = Stranger {
            address,
            leave: leave.clone(),
        };
        state.strangers.insert(number, stranger);
        Place {
            lobby: self.clone(),
            number,
            leave,
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn make_room(&mut self, address: IpAddr) {
        let mut counts: HashMap<IpAddr, usize> = HashMap::new();
        for stranger in self.strangers.values() {
            *counts.entry(stranger.address).or_default() += 1;
        }
        let crowded = if counts.get(&address).is_some_and(|&n| n >= ROOM_PER_ADDRESS) {
            Some(address)
        } else if self.strangers.len() >= ROOM {
            let most = counts.into_iter().max_by_key(|&(_, count)| count);
            most.map(|(address, _)| address)
        } else {
            None
        };
        let oldest = self.strangers.iter();
        let oldest = oldest.filter(|(_, stranger)| Some(stranger.address) == crowded);
        if let Some(number) = oldest.map(|(&number, _)| number).next()
            && let Some(stranger) = self.strangers.remove(&number)
        {
            stranger.leave.cancel();
        }
    }
}

impl Place {
    /// Waits until somebody else has got this place.
    pub(crate) async fn lost(&self) {
        self.leave.cancelled().await;
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.lobby.lock().strangers.remove(&self.number);
    }
}

/// The part of an address that its owner cannot choose freely.
pub(super) fn network_of(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            let [a, b, c, d, ..] = address.segments();
            Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0).into()
        }
        v4 @ IpAddr::V4(_) => v4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(text: &str) -> IpAddr {
        text.parse().unwrap()
    }

    #[test]
    fn one_address_only_displaces_itself() {
        let lobby = Lobby::default();
        let honest = lobby.enter(address("10.0.0.1"));
        let flood: Vec<_> = (0..2 * ROOM)
            .map(|_| lobby.enter(address("10.0.0.2")))
            .collect();
        assert!(!honest.leave.is_cancelled());
        let (old, new) = flood.split_at(2 * ROOM - ROOM_PER_ADDRESS);
        assert!(old.iter().all(|place| place.leave.is_cancelled()));
        assert!(new.iter().all(|place| !place.leave.is_cancelled()));
        assert_eq!(lobby.lock().strangers.len(), ROOM_PER_ADDRESS + 1);
    }

    #[test]
    fn many_addresses_make_room_for_others_where_most_are() {
        let lobby = Lobby::default();
        let honest = lobby.enter(address("10.0.0.1"));
        let flood: Vec<_> = (0..ROOM)
            .map(|i| lobby.enter(address(&format!("10.1.0.{}", i % 8))))
            .collect();
        let late = lobby.enter(address("10.0.0.3"));
        assert!(!honest.leave.is_cancelled() && !late.leave.is_cancelled());
        let displaced = flood.iter().filter(|place| place.leave.is_cancelled());
        assert_eq!(displaced.count(), 2);
        drop(flood);
        assert_eq!(lobby.lock().strangers.len(), 2);
        drop((honest, late));
        assert!(lobby.lock().strangers.is_empty());
    }

    #[test]
    fn an_owner_of_many_addresses_is_one() {
        for (one, other, same) in [
            ("127.0.0.1", "::ffff:127.0.0.1", true),
            ("2001:db8::1", "2001:db8::ffff:1:2:3", true),
            ("2001:db8::1", "2001:db8:0:1::1", false),
            ("10.0.0.1", "10.0.0.2", false),
        ] {
            let (one, other) = (network_of(address(one)), network_of(address(other)));
            assert_eq!(one == other, same, "{one} {other}");
        }
    }
}
