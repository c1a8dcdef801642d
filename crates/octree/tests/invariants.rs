//! What must hold for any world and any order of samples.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;
use lie_geom::{Aabb, RandomKey, Ray};
use lie_octree::{
    CellKey, CellState, LieSettings, LieState, LieTree, Observation, Outcome, Replica, ShadowRay,
    Visibility, observe,
};
use proptest::prelude::*;

const BOUNDS: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};

/// One made-up sample: where, and per light what it met.
fn observation() -> impl Strategy<Value = Observation> {
    let outcome = (0u32..6, prop::option::of(0u32..12), 0.0f32..1.0).prop_map(
        |(light, blocker, importance)| Outcome {
            light,
            blocker,
            importance,
        },
    );
    let point = [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from_array);
    (point, prop::collection::vec(outcome, 0..6)).prop_map(|(point, mut outcomes)| {
        outcomes.sort_by_key(|outcome| outcome.light);
        outcomes.dedup_by_key(|outcome| outcome.light);
        Observation {
            point,
            outcomes,
            predicted: 0.0,
            actual: 0.0,
            trusted: 0,
            scene_rays: 0,
        }
    })
}

fn settings() -> impl Strategy<Value = LieSettings> {
    (1u32..5, 1u32..8, 0u32..5).prop_map(|(max_depth, split_threshold, trust)| LieSettings {
        max_depth,
        split_threshold,
        trust,
    })
}

fn replica(tree: &LieTree) -> Replica<LieState> {
    Replica::new(tree.cube(), LieState::default())
}

fn leaves(replica: &Replica<LieState>) -> BTreeMap<CellKey, LieState> {
    let mut leaves = BTreeMap::new();
    replica.for_each_leaf(|key, lie| {
        leaves.insert(key, lie.clone());
    });
    leaves
}

/// The tree as a replica fed with everything at once.
fn snapshot(tree: &LieTree) -> Replica<LieState> {
    let mut copy = replica(tree);
    for key in tree.keys() {
        copy.apply(&tree.state(key).unwrap(), LieState::clone);
    }
    copy
}

proptest! {
    /// An LIE holds only lights that some sample in its cell saw, and an occluder list
    /// only triangles that blocked some sample's ray to that light there.
    #[test]
    fn nothing_is_known_that_was_not_observed(
        samples in prop::collection::vec(observation(), 0..200), settings in settings(),
    ) {
        let mut tree = LieTree::new(BOUNDS, settings);
        for sample in &samples {
            tree.record(sample);
        }
        prop_assert_eq!(tree.validate(), Ok(()));
        for key in tree.keys() {
            let cell = tree.state(key).unwrap();
            let lie_octree::CellBody::Leaf(lie) = cell.body else { continue };
            let here: Vec<_> = samples.iter().filter(|s| tree.key_at(s.point) == key).collect();
            let observed: BTreeSet<(u32, Option<u32>)> = here
                .iter()
                .flat_map(|s| s.outcomes.iter().map(|o| (o.light, o.blocker)))
                .collect();
            for entry in lie.lights {
                prop_assert!(observed.contains(&(entry.light, None)));
                for triangle in entry.occluders {
                    prop_assert!(observed.contains(&(entry.light, Some(triangle))));
                }
            }
        }
    }

    /// Deltas applied in order give the constructor's tree; so do a snapshot taken at any
    /// time plus the deltas after it; so do states applied late, doubled and out of order.
    #[test]
    fn deltas_and_snapshots_give_the_constructors_tree(
        batches in prop::collection::vec(prop::collection::vec(observation(), 0..30), 1..8),
        settings in settings(), join in 0usize..8, shuffle in any::<u64>(),
    ) {
        let mut tree = LieTree::new(BOUNDS, settings);
        let mut follower = replica(&tree);
        let mut late = None;
        let mut history: Vec<CellState> = vec![];
        for (index, batch) in batches.iter().enumerate() {
            if index == join {
                late = Some(snapshot(&tree));
            }
            for sample in batch {
                tree.record(sample);
            }
            for key in tree.commit() {
                let state = tree.state(key).unwrap();
                follower.apply(&state, LieState::clone);
                if let Some(late) = &mut late {
                    late.apply(&state, LieState::clone);
                }
                history.push(state);
            }
        }
        let expected = leaves(&snapshot(&tree));
        prop_assert_eq!(&leaves(&follower), &expected);
        if let Some(late) = late {
            prop_assert_eq!(&leaves(&late), &expected);
        }
        let mut shuffled = history.clone();
        shuffled.extend(history);
        shuffled.sort_by_key(|state| RandomKey::new(shuffle).mix(state.key.raw()).mix(state.version).bits(0));
        let mut disordered = replica(&tree);
        for state in &shuffled {
            disordered.apply(state, LieState::clone);
        }
        prop_assert_eq!(&leaves(&disordered), &expected);
    }

    /// Where every ray agrees with the tree, the predicted picture is the actual one.
    #[test]
    fn a_converged_tree_predicts_what_is(points in prop::collection::vec([-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0], 1..40)) {
        struct Slab;
        impl Visibility for Slab {
            fn blocker(&self, ray: &Ray) -> Option<u32> {
                (ray.origin.x > 0.3).then_some(5)
            }
            fn blocks(&self, triangle: u32, ray: &Ray) -> bool {
                self.blocker(ray) == Some(triangle)
            }
        }
        let mut tree = LieTree::new(BOUNDS, LieSettings { trust: 0, ..LieSettings::default() });
        let rays = |p: Vec3| [ShadowRay { light: 0, ray: Ray::segment(p, 5.0 * Vec3::Y), weight: 2.0 }];
        for _ in 0..2 {
            for &point in &points {
                let point = Vec3::from_array(point);
                let seen = observe(&tree, point, &rays(point), 0.0, &Slab);
                tree.record(&seen);
            }
        }
        for &point in &points {
            let point = Vec3::from_array(point);
            let seen = observe(&tree, point, &rays(point), 0.0, &Slab);
            prop_assert_eq!(seen.predicted, seen.actual);
        }
    }
}
