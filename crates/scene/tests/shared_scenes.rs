//! The scenes beside the repository, bare and through the fixtures that light them.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::path::{Path, PathBuf};

use lie_scene::{LightKind, Summary, load};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn shared() -> Option<PathBuf> {
    let folder = root().join("../shared/scenes");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: ../shared/scenes is not there");
    None
}

#[test]
fn the_bare_files_load() {
    let Some(folder) = shared() else { return };
    for (name, triangles, lights) in [
        ("cornell-mcguire/CornellBox-Original.obj", 36, 1),
        ("cornell-mcguire/CornellBox-Sphere.obj", 2_188, 1),
        ("modern-hall/staircase2.glb", 28_655, 13),
        ("modern-hall/staircase2.obj", 28_655, 13),
        ("breakfast-room/breakfast-room.glb", 269_538, 1),
        ("home-theater/home-theater.gltf", 7_915, 1),
        ("zdm2/zdm2.glb", 58_772, 1),
    ] {
        let loaded = load(&folder.join(name)).unwrap();
        loaded.scene.validate().unwrap();
        let summary = Summary::new(&loaded.scene);
        println!("{summary}{:#?}\n", loaded.warnings);
        assert_eq!(
            (summary.triangles, summary.light_count()),
            (triangles, lights),
            "{name}"
        );
    }
}

#[test]
fn the_fixtures_light_them() {
    if shared().is_none() {
        return;
    }
    let fixtures = root().join("tests/fixtures");
    for name in [
        "modern-hall",
        "breakfast-room",
        "home-theater",
        "zdm2",
        "cornell-mcguire",
    ] {
        let loaded = load(&fixtures.join(name).with_extension("toml")).unwrap();
        let scene = loaded.scene;
        assert_eq!(scene.name, name);
        assert!(!scene.walkthroughs.is_empty() || name == "cornell-mcguire");
        let bounds = scene.geometry.bounds();
        let mut clear = 0;
        for light in &scene.lights {
            if let LightKind::Point { position, .. } | LightKind::Spot { position, .. } = light.kind
            {
                assert!(
                    bounds.contains(position),
                    "'{}' of {name} is outside",
                    light.name
                );
                clear += 1;
            }
        }
        assert!(clear >= 4 || name == "cornell-mcguire", "{name}");
        assert!(
            bounds.contains(scene.cameras[0].eye) || name == "cornell-mcguire",
            "{name}"
        );
    }
}
