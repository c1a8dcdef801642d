use glam::Vec3;

use super::*;
use crate::{CellKey, Observation, Outcome, Proof, Region, TreeError};

const BOUNDS: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};

const SETTINGS: LieSettings = LieSettings {
    max_depth: 4,
    split_threshold: 2,
    split_samples: 2,
    trust: 4,
    inherit: true,
    crowd: 64,
    masking: 0.0,
};

const FIT: TreeFit = TreeFit {
    bounds: BOUNDS,
    lights: 4,
    triangles: 100,
    settings: SETTINGS,
};

fn seen(point: Vec3, blockers: &[Option<u32>]) -> Observation {
    let outcome = |(light, &blocker): (u32, _)| Outcome {
        blocker,
        importance: 0.5,
        luminance: 0.25,
        ..Outcome::of(light % 4)
    };
    Observation {
        outcomes: (1..).zip(blockers).map(outcome).collect(),
        ..Observation::at(point)
    }
}

/// Two levels of cells, one of them with proofs.
fn tree() -> LieTree {
    let mut tree = LieTree::new(BOUNDS, 4, SETTINGS);
    let blockers = [7, 99, 3, 50].map(Some);
    for corner in [0.3, 0.4, -0.5] {
        let point = Vec3::splat(corner);
        let samples = [&[None; 4][..], &blockers].map(|blockers| seen(point, blockers));
        tree.record(&samples);
    }
    let key = tree.key_at(Vec3::splat(-0.5));
    let region = Region::new(
        Aabb::around([Vec3::splat(-0.6), Vec3::splat(-0.4)]),
        vec![
            (0, Proof::Behind([9, 4, 99].into())),
            (1, Proof::Hidden),
            (3, Proof::Open),
        ],
    );
    tree.settle(key, region);
    tree.commit();
    tree
}

#[test]
fn a_tree_comes_back_as_it_was_and_learns_on_alike() {
    let mut tree = tree();
    assert_eq!(tree.validate(), Ok(()));
    let mut copy = LieTree::from_bytes(&tree.to_bytes(), &FIT).unwrap();
    assert_eq!(copy, tree);
    let samples = [seen(Vec3::splat(0.9), &[Some(1), None, Some(2), None])];
    for tree in [&mut tree, &mut copy] {
        tree.record(&samples);
        tree.commit();
    }
    assert_eq!(copy, tree);
}

#[test]
fn what_is_shared_is_written_once_and_shared_again() {
    let mut tree = LieTree::new(BOUNDS, 4, SETTINGS);
    let blockers: Vec<Option<u32>> = (0..64).map(Some).collect();
    let samples = [&[None; 4][..], &blockers].map(|blockers| seen(Vec3::splat(0.5), blockers));
    tree.record(&samples);
    let before = tree.to_bytes().len();
    let deepest = tree.key_at(Vec3::splat(0.5));
    assert!(deepest.depth() == 4, "it was split as far as possible");
    // Not eight lists to a level.
    assert!(before < 4 * 64 * 4, "{before} bytes");
    let copy = LieTree::from_bytes(&tree.to_bytes(), &FIT).unwrap();
    assert_eq!((copy.stats(), &copy), (tree.stats(), &tree));
}

#[test]
fn a_tree_of_other_rules_or_of_another_scene_is_refused_by_name() {
    let bytes = tree().to_bytes();
    let refused = |fit: TreeFit| LieTree::from_bytes(&bytes, &fit).unwrap_err();
    let with = |settings| refused(TreeFit { settings, ..FIT }).to_string();
    for (settings, expected) in [
        (
            LieSettings {
                max_depth: 5,
                ..SETTINGS
            },
            "depth of 4, not 5",
        ),
        (
            LieSettings {
                split_threshold: 9,
                ..SETTINGS
            },
            "threshold of 2, not 9",
        ),
        (
            LieSettings {
                split_samples: 1,
                ..SETTINGS
            },
            "samples of 2, not 1",
        ),
        (
            LieSettings {
                trust: 0,
                ..SETTINGS
            },
            "trust of 4, not 0",
        ),
        (
            LieSettings {
                inherit: false,
                ..SETTINGS
            },
            "inheritance true, not false",
        ),
        (
            LieSettings {
                crowd: 6,
                ..SETTINGS
            },
            "crowd of 64, not 6",
        ),
        (
            LieSettings {
                masking: 0.02,
                ..SETTINGS
            },
            "masking 0, not 0.02",
        ),
    ] {
        let message = with(settings);
        assert!(message.ends_with(expected), "{message}");
    }
    let bounds = Aabb::around([Vec3::ZERO, Vec3::ONE]);
    assert_eq!(refused(TreeFit { bounds, ..FIT }), TreeError::Scene);
    assert_eq!(refused(TreeFit { lights: 5, ..FIT }), TreeError::Scene);
    let fewer = refused(TreeFit {
        triangles: 99,
        ..FIT
    });
    assert_eq!(fewer, TreeError::Malformed("there is no such triangle"));
}

#[test]
fn every_part_of_the_bytes_alone_is_refused() {
    let bytes = tree().to_bytes();
    for length in 0..bytes.len() {
        assert!(
            LieTree::from_bytes(&bytes[..length], &FIT).is_err(),
            "{length}"
        );
    }
    let longer = [&bytes[..], &[0]].concat();
    let refused = LieTree::from_bytes(&longer, &FIT).unwrap_err();
    assert_eq!(refused, TreeError::Malformed("bytes follow its end"));
}

/// The bytes of an empty tree up to its root, and another root.
fn with_root(root: &[u8]) -> Vec<u8> {
    let mut bytes = LieTree::new(BOUNDS, 4, SETTINGS).to_bytes();
    let empty_leaf = [tag::LEAF, 0, 0, 0, 0, 0, 0];
    let before = bytes.len() - empty_leaf.len();
    assert_eq!(bytes.split_off(before), empty_leaf);
    bytes.extend_from_slice(root);
    bytes
}

#[test]
fn roots_that_cannot_be_are_refused() {
    let leaf = [tag::LEAF, 0, 0, 0, 0, 0, 0];
    let deep = [tag::INNER; 30];
    // All eight children the same cell with children: eight times as many a level.
    let inner = [&[tag::INNER], &leaf[..], &[tag::SAME; 7]].concat();
    let twice = [&[tag::INNER], &inner[..], &[tag::SAME; 7]].concat();
    // Seen from samples of its own, and repeated.
    let sampled = [
        &[tag::INNER][..],
        &[tag::LEAF, 1, 0, 0, 0, 0, 0],
        &[tag::SAME; 7],
    ]
    .concat();
    let huge = [0xff, 0xff, 0xff, 0xff, 0x0f];
    let many = [&leaf[..6], &huge].concat();
    let endless = [&[tag::LEAF][..], &[0xff; 40]].concat();
    let later = [tag::LEAF, 0, 0, 2, 0, 0, 0];
    for (root, expected) in [
        (&deep[..], "too deep"),
        (&twice, "repeats"),
        (&sampled, "repeats"),
        (&[tag::SAME], "repeats"),
        (&[255], "repeats"),
        (&many, "too soon"),
        (&endless, "too many"),
        (&later, "later version"),
    ] {
        let refused = LieTree::from_bytes(&with_root(root), &FIT).unwrap_err();
        assert!(
            refused.to_string().contains(expected),
            "{root:?}: {refused}"
        );
    }
    assert!(LieTree::from_bytes(&with_root(&inner), &FIT).is_ok());
}

#[test]
fn cells_that_wait_for_a_commit_are_kept() {
    let mut tree = tree();
    tree.split(CellKey::ROOT.child(0));
    tree.record(&[seen(Vec3::splat(0.9), &[None; 4])]);
    let mut copy = LieTree::from_bytes(&tree.to_bytes(), &FIT).unwrap();
    assert_eq!(copy.commit(), tree.commit());
}

/// A shader would take a cell of a version that is not there yet for newer than its next change.
#[test]
fn no_cell_is_of_a_version_that_nothing_has_begun() {
    let mut tree = tree();
    let point = Vec3::splat(0.9);
    let region = Region::new(Aabb::around([point]), vec![(0, Proof::Hidden)]);
    tree.settle(tree.key_at(point), region);
    // Begun and not committed.
    assert!(!tree.changed.is_empty());
    assert_eq!(tree.lie_at(point).version, tree.version() + 1);
    assert_eq!(LieTree::from_bytes(&tree.to_bytes(), &FIT).unwrap(), tree);
    tree.changed.clear();
    let refused = LieTree::from_bytes(&tree.to_bytes(), &FIT).unwrap_err();
    assert_eq!(
        refused,
        TreeError::Malformed("a cell is of a later version")
    );
}
