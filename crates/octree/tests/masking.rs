//! Masking (LIE §5): shadows that are left out are never worth more than their share, and
//! come back.

#![allow(clippy::unwrap_used)]

use glam::Vec3;
use lie_geom::Aabb;
use lie_octree::{CellKey, LieSettings, LieTree, Observation, Outcome};
use proptest::prelude::*;

const BOUNDS: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};

/// Settings under which there is one cell.
fn one_cell(masking: f32, trust: u32) -> LieSettings {
    LieSettings {
        max_depth: 0,
        masking,
        trust,
        ..LieSettings::default()
    }
}

/// A ray to a light that gives this much, or is blocked.
fn outcome(light: u32, luminance: f32, is_blocked: bool) -> Outcome {
    Outcome {
        blocker: is_blocked.then_some(light),
        rays: 2,
        importance: luminance.min(1.0),
        luminance: if is_blocked { 0.0 } else { luminance },
        withheld: if is_blocked { luminance } else { 0.0 },
        ..Outcome::of(light)
    }
}

fn sample(point: Vec3, outcomes: Vec<Outcome>) -> Observation {
    Observation {
        outcomes,
        ..Observation::at(point)
    }
}

/// Lights of the one cell whose shadows shaders leave out.
fn masked(tree: &LieTree) -> Vec<u32> {
    let lie = tree.lie_at(Vec3::ZERO);
    let masked = lie.lights().filter(|entry| entry.mask.is_some());
    masked.map(|entry| entry.light).collect()
}

/// A sample of six lights, from bright to faint, some of them blocked.
fn six_lights() -> impl Strategy<Value = Observation> {
    let light = (0.5f32..1.0, prop::bool::weighted(0.1));
    let point = [-1.0f32..1.0, -1.0..1.0, -1.0..1.0].prop_map(Vec3::from_array);
    (point, prop::collection::vec(light, 6)).prop_map(|(point, lights)| {
        let outcomes = (0..).zip(lights).map(|(number, (share, is_blocked))| {
            outcome(number, share * 0.3f32.powi(number as i32), is_blocked)
        });
        sample(point, outcomes.collect())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// After every batch, no sample so far would be shown darker or brighter than it is by
    /// more than the share of the darkest.
    #[test]
    fn what_is_masked_is_within_the_bound(
        samples in prop::collection::vec(six_lights(), 1..200), batch in 1usize..50,
        masking in 0.0f32..1.0, trust in prop::sample::select(vec![0u32, 16, 512]),
    ) {
        let mut tree = LieTree::new(BOUNDS, 6, one_cell(masking, trust));
        let mut known = 0;
        for batch in samples.chunks(batch) {
            tree.record(batch);
            known += batch.len();
            let total = |seen: &Observation| seen.outcomes.iter().map(|outcome| f64::from(outcome.luminance)).sum::<f64>();
            let darkest = samples[..known].iter().map(total).fold(f64::INFINITY, f64::min);
            let masked = masked(&tree);
            let (lit, hidden) = told(&tree);
            for seen in &samples[..known] {
                let error = |outcome: &Outcome| match (lit.contains(&outcome.light), hidden.contains(&outcome.light) || trust == 0) {
                    _ if !masked.contains(&outcome.light) => 0.0,
                    (true, _) => outcome.withheld,
                    (false, true) => -outcome.luminance,
                    (false, false) => f32::NAN,
                };
                let error: f64 = seen.outcomes.iter().map(|outcome| f64::from(error(outcome))).sum();
                prop_assert!(error.abs() <= f64::from(masking) * darkest * (1.0 + 1.0e-6), "{error} {darkest}");
            }
            let state = tree.lie_at(Vec3::ZERO);
            prop_assert!(masked.iter().all(|&light| state.evidence(light).unwrap().clear > 0));
            prop_assert_eq!(tree.validate(), Ok(()));
        }
    }

    /// The same in every cell of a tree that splits, by the cells' own account.
    #[test]
    fn a_tree_that_splits_keeps_the_bound(
        samples in prop::collection::vec(six_lights(), 1..400), batch in 1usize..100,
        masking in 0.0f32..1.0, inherit in any::<bool>(),
    ) {
        let settings = LieSettings {
            split_threshold: 3,
            split_samples: 1,
            trust: 16,
            max_depth: 2,
            inherit,
            masking,
            ..LieSettings::default()
        };
        let mut tree = LieTree::new(BOUNDS, 6, settings);
        for batch in samples.chunks(batch) {
            tree.record(batch);
            prop_assert_eq!(tree.validate(), Ok(()));
        }
    }
}

/// So many samples of a bright light and two faint ones: one that reaches most of them, and
/// one that reaches few.
fn bright_and_faint(count: usize) -> Vec<Observation> {
    let outcomes = |index: usize| {
        vec![
            outcome(0, 10.0, false),
            outcome(1, 0.15, index % 4 == 3),
            outcome(2, 0.04, index % 4 != 3),
        ]
    };
    let samples = (0..count).map(|index| sample(Vec3::ZERO, outcomes(index)));
    samples.collect()
}

/// A tree that has masked both faint lights.
fn taught(trust: u32) -> LieTree {
    let mut tree = LieTree::new(BOUNDS, 3, one_cell(0.02, trust));
    tree.record(&bright_and_faint(300));
    assert_eq!(masked(&tree), [1, 2]);
    tree
}

/// What shaders are told: lights that they shade, and lights that they leave out.
fn told(tree: &LieTree) -> (Vec<u32>, Vec<u32>) {
    let state = tree.state(tree.key_at(Vec3::ZERO)).unwrap();
    let lie_octree::CellBody::Leaf(lie) = state.body else {
        panic!("one cell")
    };
    let lights = lie.lights.iter().map(|lit| lit.light).collect();
    (lights, lie.hidden)
}

#[test]
fn masked_lights_are_told_to_be_whole_or_hidden() {
    assert_eq!(told(&taught(512)), (vec![0, 1], vec![2]));
    // As in the paper: what is not named is hidden.
    assert_eq!(told(&taught(0)), (vec![0, 1], vec![]));
    let state = taught(512).state(CellKey::ROOT).unwrap();
    let lie_octree::CellBody::Leaf(lie) = state.body else {
        panic!("one cell")
    };
    assert!(lie.lights.iter().all(|lit| lit.occluders.is_empty()));
    let mut off = LieTree::new(BOUNDS, 3, one_cell(0.0, 512));
    off.record(&bright_and_faint(300));
    assert_eq!(told(&off), (vec![0, 1, 2], vec![]));
}

#[test]
fn the_faintest_go_first() {
    let mut tree = LieTree::new(BOUNDS, 6, one_cell(0.016, 512));
    tree.record(&bright_and_faint(300));
    assert_eq!(masked(&tree), [2]);
}

#[test]
fn few_samples_mask_nothing() {
    for trust in [0, 512] {
        let mut tree = LieTree::new(BOUNDS, 6, one_cell(1.0, trust));
        tree.record(&bright_and_faint(15));
        assert!(masked(&tree).is_empty());
    }
}

#[test]
fn one_sample_to_the_contrary_ends_it() {
    for (contrary, left) in [
        // Somewhere a faint light is not so faint.
        ([10.0, 0.15, 5.0], vec![1]),
        // Somewhere the bright one gives little.
        ([2.5, 0.15, 0.04], vec![2]),
        // Somewhere there is no light at all.
        ([0.0, 0.0, 0.0], vec![]),
    ] {
        let mut tree = taught(512);
        tree.commit();
        let outcomes = (0..)
            .zip(contrary)
            .map(|(light, luminance)| outcome(light, luminance, luminance == 0.0));
        tree.record(&[sample(Vec3::ZERO, outcomes.collect())]);
        assert_eq!(masked(&tree), left, "{contrary:?}");
        assert_eq!(tree.commit().len(), 1, "shaders are told");
    }
}

#[test]
fn what_shaders_trace_beside_counts_as_given() {
    let mut tree = taught(512);
    let mut near = bright_and_faint(1);
    near[0].outcomes[2].beside = 1.0;
    tree.record(&near);
    assert_eq!(masked(&tree), [1]);
}

#[test]
fn parts_of_a_cell_start_unmasked() {
    let settings = LieSettings {
        max_depth: 1,
        split_threshold: 2,
        split_samples: 1,
        ..one_cell(0.02, 512)
    };
    let mut tree = LieTree::new(BOUNDS, 6, settings);
    tree.record(&bright_and_faint(300));
    assert_eq!(masked(&tree), [1, 2]);
    let blocked = |triangle| Outcome {
        blocker: Some(triangle),
        ..outcome(0, 10.0, true)
    };
    let dark = [7, 8].map(|triangle| sample(Vec3::splat(-0.5), vec![blocked(triangle)]));
    tree.record(&dark);
    assert_eq!(tree.key_at(Vec3::ZERO).depth(), 1);
    assert!(masked(&tree).is_empty());
    tree.record(&bright_and_faint(300));
    assert_eq!(masked(&tree), [1, 2]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Masks drawn afterwards are those that construction would have drawn.
    #[test]
    fn masks_can_be_drawn_later(
        samples in prop::collection::vec(six_lights(), 1..200), batch in 1usize..50,
        masking in 0.0f32..1.0, before in 0.0f32..1.0,
    ) {
        let settings = |masking| LieSettings {
            split_threshold: 1,
            split_samples: 2,
            trust: 16,
            masking,
            ..LieSettings::default()
        };
        let mut with = LieTree::new(BOUNDS, 6, settings(masking));
        let mut without = LieTree::new(BOUNDS, 6, settings(before));
        for batch in samples.chunks(batch) {
            with.record(batch);
            without.record(batch);
        }
        let later = without.with_masking(masking);
        prop_assert_eq!(later.validate(), Ok(()));
        prop_assert_eq!(later.settings(), with.settings());
        prop_assert_eq!(later.keys(), with.keys());
        for key in with.keys() {
            let body = |tree: &LieTree| tree.state(key).map(|state| state.body);
            prop_assert_eq!(body(&later), body(&with));
        }
    }
}
