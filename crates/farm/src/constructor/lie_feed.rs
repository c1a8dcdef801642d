use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use lie_octree::{CellKey, LieTree};
use tokio::sync::Notify;

/// The newest tree, and what each shader does not have of it yet.
///
/// A shader's debt is a *set* of cells, bounded by the octree however slow the shader; what
/// it gets is always the newest state.
pub(super) struct LieFeed(Mutex<State>);

struct State {
    tree: LieTree,
    debts: BTreeMap<u32, Debt>,
}

struct Debt {
    /// The version that the shader has once it has applied what was taken for it.
    version: u64,
    owed: Owed,
    bell: Arc<Notify>,
}

enum Owed {
    Everything,
    Cells(BTreeSet<CellKey>),
}

/// Cells to send: their states in `tree` lead from one version to the other.
pub(super) struct Update {
    pub(super) tree: LieTree,
    /// 0 is a snapshot.
    pub(super) from_version: u64,
    pub(super) to_version: u64,
    /// Parents before children.
    pub(super) keys: Vec<CellKey>,
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
            debts: BTreeMap::new(),
        }))
    }

    /// There is a newer tree, which differs in these cells.
    pub(super) fn publish(&self, tree: LieTree, changed: &[CellKey]) {
        let mut state = self.lock();
        state.tree = tree;
        for debt in state.debts.values_mut() {
            if let Owed::Cells(cells) = &mut debt.owed {
                cells.extend(changed);
            }
            debt.bell.notify_one();
        }
    }

    /// A shader wants everything, and then what changes.
    pub(super) fn subscribe(&self, id: u32) -> Subscription<'_> {
        let bell = Arc::new(Notify::new());
        bell.notify_one();
        let debt = Debt {
            version: 0,
            owed: Owed::Everything,
            bell: bell.clone(),
        };
        self.lock().debts.insert(id, debt);
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

impl Subscription<'_> {
    /// Waits until something is owed. May be dropped while it waits.
    pub(super) async fn owed(&self) {
        self.bell.notified().await;
    }

    /// Takes what is owed; it then counts as sent.
    pub(super) fn take(&self) -> Option<Update> {
        let mut state = self.feed.lock();
        let State { tree, debts } = &mut *state;
        let debt = debts.get_mut(&self.id)?;
        let (tree, to_version) = (tree.clone(), tree.version());
        let owed = std::mem::replace(&mut debt.owed, Owed::Cells(BTreeSet::new()));
        let from_version = debt.version;
        debt.version = to_version;
        drop(state);
        match owed {
            Owed::Everything => Some(Update {
                keys: tree.keys(),
                tree,
                from_version: 0,
                to_version,
            }),
            Owed::Cells(cells) if cells.is_empty() => None,
            Owed::Cells(cells) => Some(Update {
                tree,
                from_version,
                to_version,
                keys: cells.into_iter().collect(),
            }),
        }
    }

    /// The shader has lost its place: everything is owed again.
    pub(super) fn resync(&self) {
        if let Some(debt) = self.feed.lock().debts.get_mut(&self.id) {
            debt.owed = Owed::Everything;
        }
        self.bell.notify_one();
    }
}

impl Drop for Subscription<'_> {
    fn drop(&mut self) {
        self.feed.lock().debts.remove(&self.id);
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
        let mut parts = Parts::of(update);
        while let Some(part) = parts.next() {
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
}
