use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use lie_octree::{CellKey, LieTree};
use tokio::sync::Notify;

/// The newest tree, and what each shader does not have of it yet.
///
/// A shader's debt is a *set* of cells, bounded by the octree however slow the shader; what
/// it gets is always the newest state. Shaders that have the same edition are owed the same, and
/// share one set: hundreds that keep up cost no more than one.
pub(super) struct LieFeed(Mutex<State>);

struct State {
    tree: LieTree,
    /// Counts what was published, from 1; 0 is having nothing.
    edition: u64,
    places: BTreeMap<u32, Place>,
    /// What is owed to whoever has that edition.
    debts: BTreeMap<u64, Debt>,
}

/// A shader.
struct Place {
    /// What it has once it has applied what was taken for it.
    edition: u64,
    version: u64,
    bell: Arc<Notify>,
}

#[derive(Default)]
struct Debt {
    /// How many shaders owe it; it is forgotten with the last.
    shaders: usize,
    /// Of edition 0 it is everything, and this is empty.
    cells: BTreeSet<CellKey>,
    /// The same as a list, as long as it stays the same.
    keys: Option<Arc<[CellKey]>>,
}

/// Cells to send: their states in `tree` lead from one version to the other.
pub(super) struct Update {
    pub(super) tree: LieTree,
    /// 0 is a snapshot.
    pub(super) from_version: u64,
    pub(super) to_version: u64,
    /// From which edition to which: updates for which they are the same are the same.
    pub(super) editions: (u64, u64),
    /// Parents before children.
    pub(super) keys: Arc<[CellKey]>,
}

/// A shader's place in the feed; given back when dropped.
pub(super) struct Subscription<'a> {
    feed: &'a LieFeed,
    id: u32,
    bell: Arc<Notify>,
}

impl LieFeed {
    pub(super) fn new(tree: LieTree) -> Self {
        Self(Mutex::new(State {
            tree,
            edition: 1,
            places: BTreeMap::new(),
            debts: BTreeMap::new(),
        }))
    }

    /// There is a newer tree, which differs in these cells.
    pub(super) fn publish(&self, tree: LieTree, changed: &[CellKey]) {
        let mut state = self.lock();
        state.tree = tree;
        state.edition += 1;
        for (&edition, debt) in &mut state.debts {
            debt.keys = None;
            if edition > 0 {
                debt.cells.extend(changed);
            }
        }
        for place in state.places.values() {
            place.bell.notify_one();
        }
    }

    /// A shader wants everything, and then what changes.
    pub(super) fn subscribe(&self, id: u32) -> Subscription<'_> {
        let bell = Arc::new(Notify::new());
        bell.notify_one();
        let place = Place {
            edition: 0,
            version: 0,
            bell: bell.clone(),
        };
        let mut state = self.lock();
        state.places.insert(id, place);
        state.owe(0);
        drop(state);
        Subscription {
            feed: self,
            id,
            bell,
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// One more shader has this edition.
    fn owe(&mut self, edition: u64) {
        self.debts.entry(edition).or_default().shaders += 1;
    }

    /// One shader less has it.
    fn forgive(&mut self, edition: u64) {
        if let Some(debt) = self.debts.get_mut(&edition) {
            debt.shaders -= 1;
            if debt.shaders == 0 {
                self.debts.remove(&edition);
            }
        }
    }

    /// All that is owed to whoever has this edition.
    fn keys(&mut self, edition: u64) -> Arc<[CellKey]> {
        let Self { tree, debts, .. } = self;
        let debt = debts.entry(edition).or_default();
        let list = || match edition {
            0 => tree.keys().into(),
            _ => debt.cells.iter().copied().collect(),
        };
        debt.keys.get_or_insert_with(list).clone()
    }
}

impl Subscription<'_> {
    /// Waits until something is owed. May be dropped while it waits.
    pub(super) async fn owed(&self) {
        self.bell.notified().await;
    }

    /// Takes what is owed; it then counts as sent.
    pub(super) fn take(&self) -> Option<Update> {
        let mut state = self.feed.lock();
        let (to, to_version) = (state.edition, state.tree.version());
        let place = state.places.get_mut(&self.id)?;
        let (from, from_version) = (place.edition, place.version);
        (place.edition, place.version) = (to, to_version);
        let keys = state.keys(from);
        state.forgive(from);
        state.owe(to);
        if from > 0 && keys.is_empty() {
            return None;
        }
        Some(Update {
            tree: state.tree.clone(),
            from_version,
            to_version,
            editions: (from, to),
            keys,
        })
    }

    /// The shader has lost its place: everything is owed again.
    pub(super) fn resync(&self) {
        let mut state = self.feed.lock();
        if let Some(place) = state.places.get_mut(&self.id) {
            let before = std::mem::take(&mut place.edition);
            place.version = 0;
            state.forgive(before);
            state.owe(0);
        }
        drop(state);
        self.bell.notify_one();
    }
}

impl Drop for Subscription<'_> {
    fn drop(&mut self) {
        let mut state = self.feed.lock();
        if let Some(place) = state.places.remove(&self.id) {
            state.forgive(place.edition);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lie_geom::Aabb;
    use lie_octree::{LieSettings, LieState, Observation, Outcome, Replica};
    use proptest::prelude::*;

    use super::*;
    use crate::{constructor::delta::Parts, convert};

    /// Something is in the way of every other place.
    fn learn(tree: &mut LieTree, point: Vec3) {
        let stripe = (20.0 * (point.x + point.y)) as u32;
        let outcome = |light| Outcome {
            blocker: stripe.is_multiple_of(2).then_some(stripe),
            importance: 1.0,
            ..Outcome::of(light)
        };
        tree.record(&[Observation {
            outcomes: vec![outcome(0), outcome(3)],
            ..Observation::at(point)
        }]);
    }

    /// Applies what is owed as a shader would.
    fn catch_up(subscription: &Subscription<'_>, replica: &mut Replica<LieState>) {
        let Some(update) = subscription.take() else {
            return;
        };
        if update.from_version != 0 {
            assert_eq!(update.from_version, replica.version());
        }
        let to_version = update.to_version;
        let (parts, mut next) = (Parts::of(&update), Some(0));
        let mut number = 0;
        while let Some(first) = next {
            let (part, following) = parts.part(first, number);
            (next, number) = (following, number + 1);
            for cell in part.cells {
                replica.apply(&convert::cell(cell).unwrap(), LieState::clone);
            }
        }
        replica.reached(to_version);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// However rarely a shader listens, it ends with the constructor's tree.
        #[test]
        fn a_slow_shader_has_the_newest_tree_when_it_has_caught_up(
            batches in proptest::collection::vec(
                (proptest::collection::vec([0.0f32..1.0, 0.0..1.0, 0.0..1.0], 1..40), any::<bool>()),
                1..20,
            ),
        ) {
            let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
            let settings = LieSettings {
                max_depth: 5,
                split_threshold: 3,
                split_samples: 1,
                trust: 2,
                ..LieSettings::default()
            };
            let mut tree = LieTree::new(bounds, 10, settings);
            let feed = LieFeed::new(tree.clone());
            let subscription = feed.subscribe(1);
            let mut replica = Replica::new(tree.cube(), LieState::default());
            for (points, listens) in batches {
                for point in points {
                    learn(&mut tree, Vec3::from(point));
                }
                let changed = tree.commit();
                feed.publish(tree.clone(), &changed);
                if listens {
                    catch_up(&subscription, &mut replica);
                }
            }
            catch_up(&subscription, &mut replica);
            prop_assert!(subscription.take().is_none());
            prop_assert_eq!(replica.version(), tree.version());
            let mut same = true;
            replica.for_each_leaf(|key, lie| {
                let theirs = tree.state(key).map(|state| state.body);
                same &= theirs == Some(lie_octree::CellBody::Leaf(lie.clone()));
            });
            prop_assert!(same);
        }
    }

    #[test]
    fn who_has_the_same_edition_is_owed_the_same_list_and_nothing_is_kept_for_who_has_left() {
        let bounds = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        let mut tree = LieTree::new(bounds, 10, LieSettings::default());
        let feed = LieFeed::new(tree.clone());
        let shaders: Vec<_> = (0..3).map(|id| feed.subscribe(id)).collect();
        let snapshots = [0, 1].map(|id: usize| shaders[id].take().unwrap());
        assert!(Arc::ptr_eq(&snapshots[0].keys, &snapshots[1].keys));
        learn(&mut tree, Vec3::splat(0.3));
        let changed = tree.commit();
        assert!(!changed.is_empty());
        feed.publish(tree.clone(), &changed);
        let updates = [0, 1].map(|id: usize| shaders[id].take().unwrap());
        assert!(Arc::ptr_eq(&updates[0].keys, &updates[1].keys));
        assert_eq!(updates[0].editions, updates[1].editions);
        assert_eq!(updates[0].keys[..], changed[..]);
        // The third has had nothing, and one is lost.
        shaders[0].resync();
        for id in [0, 2] {
            let update = shaders[id].take().unwrap();
            assert_eq!((update.from_version, update.editions.0), (0, 0));
        }
        assert_eq!(feed.lock().debts.len(), 1);
        drop(shaders);
        assert!(feed.lock().debts.is_empty());
    }
}
