//! What must hold for any world and any order of samples.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;
use lie_geom::{Aabb, RandomKey, Ray};
use lie_octree::{
    Between, CellBody, CellKey, CellState, GROUP, LieSettings, LieState, LieTree, Observation,
    Observer, Outcome, Replica, ShadowRay, Visibility,
};
use proptest::prelude::*;

const BOUNDS: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};

/// One made-up sample: where, and per light what it met.
fn observation() -> impl Strategy<Value = Observation> {
    let outcome = (0u32..6, prop::option::of(0u32..12), 1u32..6, 0.0f32..1.0).prop_map(
        |(light, blocker, rays, importance)| Outcome {
            blocker,
            rays,
            importance,
            ..Outcome::of(light)
        },
    );
    let point = [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from_array);
    (point, prop::collection::vec(outcome, 0..6)).prop_map(|(point, outcomes)| Observation {
        outcomes,
        ..Observation::at(point)
    })
}

fn settings() -> impl Strategy<Value = LieSettings> {
    (1u32..5, 1u32..8, 1u32..5, 0u32..5, any::<bool>(), 1u32..20).prop_map(
        |(max_depth, split_threshold, split_samples, trust, inherit, crowd)| LieSettings {
            max_depth,
            split_threshold,
            split_samples,
            trust,
            inherit,
            crowd,
            masking: 0.0,
        },
    )
}

/// A world in which the odd triangles are in nobody's way to the left of the middle.
struct Right;

impl Between for Right {
    fn between(&self, _light: u32, ends: Aabb) -> impl Fn(u32) -> bool {
        move |triangle| triangle % 2 == 0 || ends.max.x > 0.1
    }
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

#[test]
fn equal_parts_of_a_cell_are_one() {
    let mut copy = Replica::new(LieTree::new(BOUNDS, 6, LieSettings::default()).cube(), 0);
    let state = |octant: usize, version: u64, light: u32| CellState {
        key: CellKey::ROOT.child(octant),
        version,
        body: CellBody::Leaf(LieState {
            hidden: vec![light],
            ..LieState::default()
        }),
    };
    for (octant, light) in [3, 5, 3, 3, 5, 3, 3, 3].into_iter().enumerate() {
        copy.apply(&state(octant, 1, light), |lie| lie.hidden[0]);
    }
    let distinct = |copy: &Replica<u32>| {
        let mut seen = BTreeSet::new();
        copy.for_each_leaf(|_, value| {
            seen.insert((std::ptr::from_ref(value) as usize, *value));
        });
        seen.len()
    };
    assert_eq!(distinct(&copy), 2);
    // One of them changes: the others stay.
    copy.apply(&state(0, 2, 4), |lie| lie.hidden[0]);
    let mut values = vec![];
    copy.for_each_leaf(|_, value| values.push(*value));
    assert_eq!(values, [4, 5, 3, 3, 5, 3, 3, 3]);
    assert_eq!(distinct(&copy), 3);
}

proptest! {
    /// An LIE holds only lights that some sample saw, and an occluder list only triangles
    /// that blocked some sample's ray to that light: a sample in its cell, or, where cells
    /// inherit, in one that it is part of.
    #[test]
    fn nothing_is_known_that_was_not_observed(
        samples in prop::collection::vec(observation(), 0..200), settings in settings(),
        batch in 1usize..50,
    ) {
        let mut tree = LieTree::new(BOUNDS, 6, settings);
        for batch in samples.chunks(batch) {
            tree.record(batch);
        }
        prop_assert_eq!(tree.validate(), Ok(()));
        for key in tree.keys() {
            let cell = tree.state(key).unwrap();
            let lie_octree::CellBody::Leaf(lie) = cell.body else { continue };
            let here: Vec<_> = samples
                .iter()
                .filter(|s| settings.inherit || tree.key_at(s.point) == key)
                .collect();
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
        let mut tree = LieTree::new(BOUNDS, 6, settings);
        let mut follower = replica(&tree);
        let mut late = None;
        let mut history: Vec<CellState> = vec![];
        for (index, batch) in batches.iter().enumerate() {
            if index == join {
                late = Some(snapshot(&tree));
            }
            tree.record_between(batch, &Right);
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

    /// Where every ray agrees with the tree, the predicted picture is the actual one; and
    /// what is new is known at once to the points that follow.
    #[test]
    fn a_converged_tree_predicts_what_is(points in prop::collection::vec([-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0], 1..40)) {
        let mut points: Vec<Vec3> = points.into_iter().map(Vec3::from_array).collect();
        let settings = LieSettings { trust: 0, ..LieSettings::default() };
        let mut tree = LieTree::new(BOUNDS, 6, settings);
        let rays: Vec<ShadowRay> = (0..)
            .zip(&points)
            .map(|(point, &from)| ShadowRay { point, ray: Ray::segment(from, 5.0 * Vec3::Y), weight: 2.0, beside: 0.5 })
            .collect();
        let mut observe = || {
            let mut observer = Observer::new(&tree, &points, 0.0, RandomKey::new(1), &Slab);
            observer.light(0, &rays);
            let seen = observer.finish();
            tree.record(&seen);
            seen
        };
        for seen in observe() {
            let blocked = seen.point.x > 0.3;
            prop_assert_eq!(seen.actual, if blocked { 0.0 } else { 2.0 });
            prop_assert_eq!(seen.outcomes[0].blocker.is_some(), blocked);
            prop_assert_eq!(seen.outcomes[0].luminance, seen.actual);
            prop_assert_eq!(seen.outcomes[0].beside, 0.5);
        }
        observe();
        for seen in observe() {
            prop_assert_eq!(seen.predicted, seen.actual);
        }
        points.retain(|point| point.x > 0.3);
        let evidence = points.first().and_then(|&point| tree.lie_at(point).evidence(0).cloned());
        prop_assert!(evidence.is_none_or(|known| known.occluders.len() == 1));
    }
}

/// A world in which two triangles, one behind the other, are in the way above x = 0.3.
struct Slab;

impl Visibility for Slab {
    type Rays = Vec<Ray>;

    fn gather(&self, rays: &[Ray]) -> Vec<Ray> {
        rays.to_vec()
    }

    fn blockers(&self, rays: &Vec<Ray>) -> [Option<u32>; GROUP] {
        let mut blockers = [None; GROUP];
        for (place, blocker) in blockers.iter_mut().enumerate().take(rays.len()) {
            let found = 5 + (place % 2) as u32;
            *blocker = (self.blocked_by(found, rays) >> place & 1 == 1).then_some(found);
        }
        blockers
    }

    fn blocked_by(&self, triangle: u32, rays: &Vec<Ray>) -> u32 {
        let is_blocked = |ray: &Ray| (5..7).contains(&triangle) && ray.origin.x > 0.3;
        rays.iter().enumerate().fold(0, |mask, (lane, ray)| {
            mask | u32::from(is_blocked(ray)) << lane
        })
    }

    fn neighbours(&self, triangle: u32, found: &mut Vec<u32>) {
        found.push(triangle + 1);
    }

    fn aim(&self, _: u32, _: u32, _: u32, _: RandomKey) -> Option<(Ray, Vec3)> {
        None
    }
}
