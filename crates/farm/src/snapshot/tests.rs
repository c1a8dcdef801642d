use std::sync::{Arc, OnceLock};

use glam::UVec2;
use lie_render::World;
use lie_scene::{Mosque, cornell_box, mosque};
use proptest::{prelude::*, sample::Index};

use super::*;
use crate::{ConstructSettings, View, construct::Finding};

const SIZE: UVec2 = UVec2::new(64, 32);

fn world() -> Arc<World> {
    static WORLD: OnceLock<Arc<World>> = OnceLock::new();
    let make = || {
        let scene = mosque(&Mosque {
            detail: 0.1,
            ..Mosque::default()
        });
        Arc::new(World::new(Arc::new(scene)))
    };
    WORLD.get_or_init(make).clone()
}

fn hash() -> SceneHash {
    static HASH: OnceLock<SceneHash> = OnceLock::new();
    *HASH.get_or_init(|| scene_hash(world().scene()).unwrap())
}

fn view() -> View {
    View {
        camera: world().scene().cameras[0].clone(),
        size: SIZE,
    }
}

fn builder(change: impl FnOnce(&mut ConstructSettings)) -> Builder {
    let mut settings = ConstructSettings::new(world().scene());
    settings.threads = 1;
    // Converges within some passes.
    settings.lie.trust = 32;
    settings.lie.split_samples = 16;
    change(&mut settings);
    Builder::new(world(), settings).unwrap()
}

/// Four passes: a batch.
fn learn(builder: &mut Builder) {
    builder.sample(&[view()], 4 * u64::from(SIZE.element_product()), |_| {});
}

/// A snapshot of some passes, as bytes.
fn saved() -> &'static [u8] {
    static SAVED: OnceLock<Vec<u8>> = OnceLock::new();
    SAVED.get_or_init(|| {
        let mut builder = builder(|_| {});
        learn(&mut builder);
        encode(&builder.snapshot(), hash()).unwrap()
    })
}

#[test]
fn a_snapshot_comes_back_whole_and_a_converged_view_needs_no_samples() {
    let home = tempfile::tempdir().unwrap();
    let file = SnapshotFile::new(home.path().join("mosque.lies"));
    file.check().unwrap();
    let mut cold = builder(|_| {});
    assert!(!file.restore(&mut cold, hash()).unwrap());
    let report = cold.converge(&[view()], 1 << 20, |_| {});
    assert!(report.converged && report.taken > 0, "{report:?}");
    file.save(&cold.snapshot(), hash()).unwrap();
    file.check().unwrap();

    let mut warm = builder(|_| {});
    assert!(file.restore(&mut warm, hash()).unwrap());
    assert_eq!(warm.tree(), cold.tree());
    assert_eq!(warm.tree().validate(), Ok(()));
    let mut renamed = view();
    renamed.camera.name = "another name".to_owned();
    let again = warm.converge(&[renamed.clone()], 1 << 20, |_| {
        panic!("no batch is needed")
    });
    assert_eq!((again.converged, again.taken), (true, 0));
    assert_eq!(again.estimated_error, report.estimated_error);
    assert_eq!(warm.tree(), cold.tree());

    // Another size is another view.
    renamed.size += 1;
    assert!(!warm.look(&[renamed]).converged);
    // The first is remembered meanwhile, and saved.
    assert_eq!(warm.snapshot().views.len(), 2);
    assert!(warm.look(&[view()]).converged);
}

#[test]
fn construction_goes_on_with_other_samples_where_it_was() {
    let mut cold = builder(|_| {});
    learn(&mut cold);
    let snapshot = cold.snapshot();
    let views = &snapshot.views;
    assert_eq!((views.len(), views[0].passes), (1, 4));
    let mut warm = builder(|_| {});
    warm.restore(snapshot);
    for builder in [&mut cold, &mut warm] {
        learn(builder);
    }
    // Batches end with passes here, so what follows is the same.
    assert_eq!(warm.tree(), cold.tree());
}

/// Without doubt, a cell that was split since may be wrong.
#[test]
fn without_doubt_a_view_has_converged_only_while_nothing_has_changed() {
    for (trust, stays) in [(0, false), (32, true)] {
        let mut builder = builder(|settings| settings.lie.trust = trust);
        learn(&mut builder);
        let mut snapshot = builder.snapshot();
        let perfect = Finding {
            error: 0.0,
            doubtful: 0.0,
        };
        snapshot.views[0].last = [Some(perfect); 2];
        builder.restore(snapshot.clone());
        assert!(builder.look(&[view()]).converged);
        builder.restore(snapshot);
        let mut other = view();
        other.camera.eye.x += 0.5;
        builder.batch(&[other]);
        assert_eq!(builder.look(&[view()]).converged, stays);
    }
}

#[test]
fn a_snapshot_of_something_else_is_refused_and_said_why() {
    let refused = |bytes: &[u8], builder: Builder, scene| {
        let refusal = decode(bytes, &builder, scene).unwrap_err();
        refusal.to_string()
    };
    let other = scene_hash(&cornell_box()).unwrap();
    assert_eq!(
        refused(saved(), builder(|_| {}), other),
        "it is of another scene"
    );
    for (change, expected) in [
        (
            (|it| it.lie.trust = 0) as fn(&mut ConstructSettings),
            "with proofs",
        ),
        (|it| it.proofs = false, "with proofs"),
        (|it| it.lie.trust = 5, "trust of 32, not 5"),
        (|it| it.lie.max_depth = 3, "depth of"),
    ] {
        let message = refused(saved(), builder(change), hash());
        assert!(message.contains(expected), "{message}");
    }
    let mut newer = saved().to_vec();
    newer[8] = 99;
    assert_eq!(
        refused(&newer, builder(|_| {}), hash()),
        "its format is 99.2, not 1.2"
    );
    let longer = [saved(), &[0]].concat();
    let expected = format!(
        "it should have {} bytes and has {}",
        saved().len(),
        longer.len()
    );
    assert_eq!(refused(&longer, builder(|_| {}), hash()), expected);
    assert!(decode(saved(), &builder(|_| {}), hash()).is_ok());
}

#[test]
fn a_right_checksum_alone_does_not_convince() {
    let (views, tree) = (
        views::encode(&builder(|_| {}).snapshot()).unwrap(),
        vec![1; 99],
    );
    let contents = |views, tree| Contents {
        scene: hash(),
        views,
        tree,
    };
    let bytes = container::encode(&contents(views, tree));
    let refusal = decode(&bytes, &builder(|_| {}), hash()).unwrap_err();
    assert!(matches!(refusal, Refusal::Tree(_)), "{refusal}");
    // Far more views than there are bytes.
    let bytes = container::encode(&contents(vec![1, 252, 255, 255, 255, 255], vec![]));
    let refusal = decode(&bytes, &builder(|_| {}), hash()).unwrap_err();
    assert!(matches!(refusal, Refusal::Views(_)), "{refusal}");
}

#[test]
fn what_is_no_snapshot_is_never_touched_and_what_was_one_is_replaced() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("file");
    let file = SnapshotFile::new(&path);
    let mut builder = builder(|_| {});
    for foreign in ["picture", "LIE-LIE?", "LIESCENE and more"] {
        fs::write(&path, foreign).unwrap();
        assert!(matches!(file.check(), Err(SnapshotError::Foreign(_))));
        assert!(file.restore(&mut builder, hash()).is_err());
        assert!(file.save(&builder.snapshot(), hash()).is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), foreign);
    }
    for torn in [0, 5, 8, 50, 120, saved().len() - 1] {
        fs::write(&path, &saved()[..torn]).unwrap();
        file.check().unwrap();
        assert!(!file.restore(&mut builder, hash()).unwrap(), "{torn}");
        file.save(&builder.snapshot(), hash()).unwrap();
        assert!(file.restore(&mut builder, hash()).unwrap(), "{torn}");
    }
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1);
    assert!(SnapshotFile::new(home.path()).check().is_err());
    let nowhere = SnapshotFile::new(home.path().join("no/such/file"));
    assert!(matches!(nowhere.check(), Err(SnapshotError::Write { .. })));
    assert!(nowhere.save(&builder.snapshot(), hash()).is_err());
}

#[test]
#[cfg(unix)]
fn a_snapshot_belongs_to_its_owner_alone_and_a_link_to_it_stays_one() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let home = tempfile::tempdir().unwrap();
    let (path, link) = (home.path().join("a"), home.path().join("b"));
    fs::write(&path, "").unwrap();
    symlink(&path, &link).unwrap();
    let file = SnapshotFile::new(&link);
    file.save(&builder(|_| {}).snapshot(), hash()).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(
        fs::metadata(&path).unwrap().permissions().mode() & 0o777,
        0o600
    );
    assert!(SnapshotFile::new("/dev/null").check().is_err());
}

proptest! {
    /// Whatever byte is changed, or how much is missing.
    #[test]
    fn damage_is_always_found(place in any::<Index>(), bits in 1u8.., is_cut in any::<bool>()) {
        let place = place.index(saved().len());
        let mut bytes = saved().to_vec();
        if is_cut {
            bytes.truncate(place);
        } else {
            bytes[place] ^= bits;
        }
        static COLD: OnceLock<Builder> = OnceLock::new();
        let cold = COLD.get_or_init(|| builder(|_| {}));
        prop_assert!(decode(&bytes, cold, hash()).is_err());
    }
}
