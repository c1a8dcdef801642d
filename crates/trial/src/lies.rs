//! LIEs from a file: the tree alone, and the file around it.

use std::fs;

use glam::UVec2;
use lie_farm::{Builder, View, snapshot::SnapshotFile};
use lie_octree::{LieTree, TreeFit};

use crate::{Form, Memory, Target, fixture::Fixture};

/// A tree's own bytes.
pub(crate) const TREE: Target = Target {
    name: "tree",
    seeds: || {
        let fixture = Fixture::new();
        let (empty, learnt) = (fixture.builder(), fixture.learnt());
        let all = [empty, learnt].map(|builder| builder.tree().to_bytes());
        all.into()
    },
    open: || {
        let fixture = Fixture::new();
        let fit = fit(&fixture.builder());
        Box::new(move |bytes| read_tree(bytes, &fit))
    },
    memory: Memory {
        fixed: 1 << 20,
        for_each: 256,
    },
    form: Form::Bytes,
};

/// A whole snapshot.
pub(crate) const SNAPSHOT: Target = Target {
    name: "snapshot",
    seeds: || {
        let fixture = Fixture::new();
        let all = [fixture.builder(), fixture.learnt()];
        all.iter().map(|builder| saved(&fixture, builder)).collect()
    },
    open: || {
        let (folder, fixture) = (tempfile::tempdir().unwrap(), Fixture::new());
        let path = folder.path().join("a.lies");
        let mut builder = fixture.builder();
        Box::new(move |bytes| {
            // The folder lives as long as this does.
            let _ = &folder;
            let taken = [bytes, &sealed(bytes)].map(|content| {
                fs::write(&path, content).unwrap();
                restore(&path, &mut builder, &fixture)
            });
            taken.contains(&true)
        })
    },
    memory: Memory {
        fixed: 1 << 20,
        for_each: 512,
    },
    form: Form::Bytes,
};

fn fit(builder: &Builder) -> TreeFit {
    let scene = builder.world().scene();
    TreeFit {
        bounds: scene.geometry.bounds(),
        lights: scene.lights.len() as u32,
        triangles: scene.geometry.len() as u32,
        settings: builder.tree().settings(),
    }
}

fn read_tree(bytes: &[u8], fit: &TreeFit) -> bool {
    let Ok(mut tree) = LieTree::from_bytes(bytes, fit) else {
        return false;
    };
    assert_eq!(tree.validate(), Ok(()));
    let again = LieTree::from_bytes(&tree.to_bytes(), fit).unwrap();
    assert!(again == tree);
    let _ = (tree.stats(), tree.commit());
    let states = tree.keys().into_iter().map(|key| tree.state(key));
    assert!(
        states
            .flatten()
            .all(|state| state.version <= tree.version())
    );
    true
}

/// What a builder would leave behind.
fn saved(fixture: &Fixture, builder: &Builder) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.lies");
    let file = SnapshotFile::new(&path);
    file.save(&builder.snapshot(), fixture.hash).unwrap();
    fs::read(path).unwrap()
}

/// Where a snapshot has its checksum: that of everything else.
const CHECKSUM: std::ops::Range<usize> = 64..96;

/// The same with a right checksum: otherwise hardly anything would get past it.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    let mut sealed = bytes.to_vec();
    if let Some(rest) = bytes.get(CHECKSUM.end..) {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&bytes[..CHECKSUM.start]).update(rest);
        sealed[CHECKSUM].copy_from_slice(hasher.finalize().as_bytes());
    }
    sealed
}

/// Restores, and if that succeeds goes on as a constructor would.
fn restore(path: &std::path::Path, builder: &mut Builder, fixture: &Fixture) -> bool {
    let file = SnapshotFile::new(path);
    let _ = file.check();
    if !file.restore(builder, fixture.hash).is_ok_and(|done| done) {
        return false;
    }
    assert_eq!(builder.tree().validate(), Ok(()));
    let size = UVec2::new(8, 4);
    let camera = fixture.scene().cameras[0].clone();
    builder.look(&[View { camera, size }]);
    file.save(&builder.snapshot(), fixture.hash).unwrap();
    assert!(file.restore(builder, fixture.hash).unwrap());
    true
}
