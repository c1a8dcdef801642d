//! A tree as bytes: exact when it comes back, and harmless whatever becomes of the bytes.

#![allow(clippy::unwrap_used)]

use glam::Vec3;
use lie_geom::Aabb;
use lie_octree::{LieSettings, LieTree, Observation, Outcome, Proof, Region, TreeFit};
use proptest::{collection::vec, prelude::*, sample::Index};

const BOUNDS: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};

const LIGHTS: u32 = 9;
const TRIANGLES: u32 = 300;

/// Something that happens to a tree.
#[derive(Clone, Debug)]
enum Event {
    Record(Vec<Observation>),
    Settle(Vec3, Region),
    Split(Vec3),
    Commit,
}

fn point() -> impl Strategy<Value = Vec3> {
    [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from_array)
}

fn observation() -> impl Strategy<Value = Observation> {
    let blocker = prop::option::of(0..TRIANGLES);
    let shares = (0.0f32..1.0, 0.0f32..9.0, 0.0f32..9.0);
    let outcome = (0..LIGHTS, blocker, 1u32..70_000, shares).prop_map(
        |(light, blocker, rays, (importance, luminance, withheld))| Outcome {
            blocker,
            rays,
            importance,
            luminance,
            withheld,
            ..Outcome::of(light)
        },
    );
    (point(), vec(outcome, 0..12)).prop_map(|(point, outcomes)| Observation {
        outcomes,
        ..Observation::at(point)
    })
}

fn region() -> impl Strategy<Value = Region> {
    let proof = prop_oneof![
        Just(Proof::Unoccluded),
        Just(Proof::Hidden),
        Just(Proof::Open),
        vec(0..TRIANGLES, 1..9).prop_map(|list| Proof::Behind(list.into())),
    ];
    let lights = prop::collection::btree_map(0..LIGHTS, proof, 0..6);
    (point(), point(), lights)
        .prop_map(|(a, b, lights)| Region::new(Aabb::around([a, b]), lights.into_iter().collect()))
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => vec(observation(), 0..30).prop_map(Event::Record),
        2 => (point(), region()).prop_map(|(point, region)| Event::Settle(point, region)),
        1 => point().prop_map(Event::Split),
        1 => Just(Event::Commit),
    ]
}

fn settings() -> impl Strategy<Value = LieSettings> {
    let masking = prop_oneof![Just(0.0f32), 0.0f32..1.0];
    let limits = (1u32..6, 1u32..8, 1u32..5, 0u32..600, 1u32..20);
    (limits, any::<bool>(), masking).prop_map(
        |((max_depth, split_threshold, split_samples, trust, crowd), inherit, masking)| {
            LieSettings {
                max_depth,
                split_threshold,
                split_samples,
                trust,
                inherit,
                crowd,
                masking,
            }
        },
    )
}

fn grown(settings: LieSettings, events: Vec<Event>) -> LieTree {
    let mut tree = LieTree::new(BOUNDS, LIGHTS, settings);
    for event in events {
        match event {
            Event::Record(mut batch) => {
                // What is certain is not sampled.
                for seen in &mut batch {
                    let lie = tree.lie_at(seen.point);
                    seen.outcomes
                        .retain(|it| !lie.region().is_settled(it.light));
                }
                tree.record(&batch);
            }
            Event::Settle(point, region) => tree.settle(tree.key_at(point), region),
            Event::Split(point) => {
                tree.split(tree.key_at(point));
            }
            Event::Commit => {
                tree.commit();
            }
        }
    }
    tree
}

fn tree() -> impl Strategy<Value = LieTree> {
    (settings(), vec(event(), 0..12)).prop_map(|(settings, events)| grown(settings, events))
}

fn fit(tree: &LieTree) -> TreeFit {
    TreeFit {
        bounds: BOUNDS,
        lights: LIGHTS,
        triangles: TRIANGLES,
        settings: tree.settings(),
    }
}

/// Ways to spoil bytes.
#[derive(Clone, Debug)]
enum Spoil {
    Flip(Index, u8),
    Cut(Index),
    Insert(Index, Vec<u8>),
    Remove(Index, usize),
}

fn spoil() -> impl Strategy<Value = Spoil> {
    prop_oneof![
        4 => (any::<Index>(), 1u8..).prop_map(|(place, bits)| Spoil::Flip(place, bits)),
        1 => any::<Index>().prop_map(Spoil::Cut),
        1 => (any::<Index>(), vec(any::<u8>(), 1..9)).prop_map(|(at, what)| Spoil::Insert(at, what)),
        1 => (any::<Index>(), 1usize..9).prop_map(|(place, count)| Spoil::Remove(place, count)),
    ]
}

fn spoilt(mut bytes: Vec<u8>, spoils: Vec<Spoil>) -> Vec<u8> {
    for spoil in spoils {
        let length = bytes.len();
        match spoil {
            _ if length == 0 => {}
            Spoil::Flip(place, bits) => bytes[place.index(length)] ^= bits,
            Spoil::Cut(place) => bytes.truncate(place.index(length)),
            Spoil::Insert(place, what) => {
                let place = place.index(length);
                bytes.splice(place..place, what);
            }
            Spoil::Remove(place, count) => {
                let place = place.index(length);
                bytes.drain(place..(place + count).min(length));
            }
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// A tree comes back exactly, with what it shares, and learns on alike.
    #[test]
    fn a_tree_comes_back(tree in tree(), next in vec(observation(), 1..20)) {
        let mut tree = tree;
        prop_assert_eq!(tree.validate(), Ok(()));
        let bytes = tree.to_bytes();
        let mut copy = LieTree::from_bytes(&bytes, &fit(&tree)).unwrap();
        prop_assert_eq!(&copy, &tree);
        prop_assert_eq!(copy.stats(), tree.stats());
        prop_assert_eq!(copy.to_bytes(), bytes);
        for tree in [&mut tree, &mut copy] {
            tree.record(&next);
        }
        prop_assert_eq!(copy.commit(), tree.commit());
        prop_assert_eq!(&copy, &tree);
    }

    /// Spoilt bytes are refused, or are a tree that breaks no rule: telling one that was
    /// changed from one that was saved takes a checksum, which files have.
    #[test]
    fn spoilt_bytes_do_no_harm(tree in tree(), spoils in vec(spoil(), 1..4)) {
        let fit = fit(&tree);
        if let Ok(other) = LieTree::from_bytes(&spoilt(tree.to_bytes(), spoils), &fit) {
            prop_assert_eq!(other.validate(), Ok(()));
            for key in other.keys() {
                prop_assert!(other.state(key).is_some());
            }
        }
    }

    #[test]
    fn noise_is_no_tree(noise in vec(any::<u8>(), 0..400)) {
        let tree = LieTree::new(BOUNDS, LIGHTS, LieSettings::default());
        prop_assert!(LieTree::from_bytes(&noise, &fit(&tree)).is_err());
    }
}
