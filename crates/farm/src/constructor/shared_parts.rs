use std::{
    collections::HashMap,
    sync::{Arc, Mutex, PoisonError, Weak},
};

use lie_protocol::{ConstructorToShader, encode};
use tokio::{sync::OnceCell, task::spawn_blocking};

use super::{delta::Parts, lie_feed::Update};
use crate::connection::LinkError;

/// Parts that were made last and are kept although nobody sends them now: shaders that are a
/// little apart still share them. Each is at most as long as a message.
const KEPT: usize = 4;

/// Parts of updates as bytes, each made once for all shaders that are owed it.
///
/// Shaders that keep up with the constructor have the same version, and so are owed the same.
/// A part lives for as long as somebody sends it: memory is bounded by the shaders,
/// each of which sends one part at a time.
#[derive(Default)]
pub(super) struct SharedParts(Mutex<State>);

#[derive(Default)]
struct State {
    made: HashMap<Name, Weak<OnceCell<Encoded>>>,
    kept: Vec<Arc<OnceCell<Encoded>>>,
}

/// What a part is of: the editions from and to, which say all of an update, and the first of its
/// cells.
type Name = (u64, u64, usize);

/// A part for the wire.
pub(super) struct Encoded {
    bytes: Vec<u8>,
    /// Where the next one begins; `None` if there is none.
    next: Option<(usize, u32)>,
}

/// An update on its way to one shader.
pub(super) struct Way<'a> {
    shared: &'a SharedParts,
    update: Arc<Update>,
    next: Option<(usize, u32)>,
}

impl SharedParts {
    /// The parts of an update, one after the other.
    pub(super) fn of(&self, update: Update) -> Way<'_> {
        Way {
            shared: self,
            update: Arc::new(update),
            next: Some((0, 0)),
        }
    }

    /// The place of a part, in which it may be already.
    fn place(&self, name: Name) -> Arc<OnceCell<Encoded>> {
        // Nothing in here can panic half-way.
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = state.made.get(&name).and_then(Weak::upgrade) {
            return place;
        }
        let place = Arc::<OnceCell<Encoded>>::default();
        state.made.retain(|_, place| place.strong_count() > 0);
        state.made.insert(name, Arc::downgrade(&place));
        if state.kept.len() == KEPT {
            state.kept.remove(0);
        }
        state.kept.push(place.clone());
        place
    }
}

impl Way<'_> {
    /// The next part; `None` if there was none left. Making one is work for another thread.
    ///
    /// # Errors
    /// [`LinkError`] if it cannot be made.
    pub(super) async fn next(&mut self) -> Result<Option<Part>, LinkError> {
        let Some((first, number)) = self.next else {
            return Ok(None);
        };
        let (from, to) = self.update.editions;
        let place = self.shared.place((from, to, first));
        let update = self.update.clone();
        let made = place.get_or_try_init(|| async {
            let made = spawn_blocking(move || make(&update, first, number)).await;
            let broken = |_| LinkError::Rules("a LIE update could not be made".to_owned());
            made.map_err(broken)?
        });
        self.next = made.await?.next;
        Ok(Some(Part(place)))
    }
}

/// A part that is being sent.
pub(super) struct Part(Arc<OnceCell<Encoded>>);

impl Part {
    /// The whole message.
    pub(super) fn bytes(&self) -> &[u8] {
        // It is made before it is given out.
        self.0.get().map_or(&[], |encoded| &encoded.bytes)
    }
}

fn make(update: &Update, first: usize, number: u32) -> Result<Encoded, LinkError> {
    let (part, next) = Parts::of(update).part(first, number);
    let mut bytes = vec![];
    encode(&ConstructorToShader::LieDelta(part), &mut bytes)?;
    Ok(Encoded {
        bytes,
        next: next.map(|key| (key, number + 1)),
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lie_geom::Aabb;
    use lie_octree::{LieSettings, LieTree};
    use lie_protocol::Decoder;

    use super::*;
    use crate::constructor::lie_feed::LieFeed;

    fn feed() -> LieFeed {
        let bounds = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        LieFeed::new(LieTree::new(bounds, 1, LieSettings::default()))
    }

    #[tokio::test]
    async fn who_is_owed_the_same_is_sent_the_same_bytes() {
        let (feed, shared) = (feed(), SharedParts::default());
        let subscriptions = [feed.subscribe(1), feed.subscribe(2)];
        let mut parts = vec![];
        for subscription in &subscriptions {
            let mut way = shared.of(subscription.take().unwrap());
            parts.push(way.next().await.unwrap().unwrap());
            assert!(way.next().await.unwrap().is_none());
        }
        assert!(std::ptr::eq(parts[0].bytes(), parts[1].bytes()));
        let mut decoder = Decoder::default();
        decoder.push(parts[0].bytes());
        let message = decoder.next::<ConstructorToShader>().unwrap();
        let Some(ConstructorToShader::LieDelta(part)) = message else {
            panic!("{message:?}");
        };
        assert_eq!((part.from_version, part.part, part.last), (0, 0, true));
        // A tree that has learnt nothing is empty, and its snapshot is sent all the same.
        assert!(part.cells.is_empty());
    }

    #[test]
    fn what_nobody_sends_is_not_kept_for_long() {
        let shared = SharedParts::default();
        let first = Arc::downgrade(&shared.place((0, 0, 0)));
        assert!(first.upgrade().is_some());
        let sent = shared.place((0, 0, 1));
        for other in 0..KEPT {
            shared.place((1, 2, other));
        }
        assert!(first.upgrade().is_none());
        assert!(Arc::ptr_eq(&sent, &shared.place((0, 0, 1))));
        let state = shared.0.lock().unwrap();
        assert!(state.made.len() <= KEPT + 2, "{}", state.made.len());
    }
}
