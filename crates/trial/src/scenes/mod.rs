//! Scene files, with the files that they name.

mod files;
mod seeds;

use std::fs;

use lie_farm::scene_blob;
use lie_scene::{Scene, Summary, load};

pub(crate) use files::Files;
pub(crate) use seeds::of_every_kind;

use crate::{Form, Memory, Run, Target};

/// Files of a few KiB; a picture in them may say that it is large, see `load::picture`.
const MEMORY: Memory = Memory {
    fixed: 64 << 20,
    for_each: 1024,
};

/// An OBJ file with its materials and pictures.
pub(crate) const OBJ: Target = Target {
    name: "scene_obj",
    seeds: seeds::obj,
    open: || open("main.obj"),
    memory: MEMORY,
    form: Form::Files,
};

/// A glTF file, as text with its buffers or as GLB.
pub(crate) const GLTF: Target = Target {
    name: "scene_gltf",
    seeds: seeds::gltf,
    open: || open("main.gltf"),
    memory: MEMORY,
    form: Form::Files,
};

/// A scene file with the geometry that it names.
pub(crate) const TOML: Target = Target {
    name: "scene_toml",
    seeds: seeds::toml,
    open: || open("scene.toml"),
    memory: MEMORY,
    form: Form::Files,
};

/// Files are written to a folder and read from there, as users' are.
fn open(main: &'static str) -> Run {
    let folder = tempfile::tempdir().unwrap();
    Box::new(move |bytes| {
        let files = Files::split(bytes);
        for (name, content) in &files.0 {
            fs::write(folder.path().join(name), content).unwrap();
        }
        let is_taken = check(&folder.path().join(main));
        for (name, _) in &files.0 {
            // The same name twice is one file.
            let _ = fs::remove_file(folder.path().join(name));
        }
        is_taken
    })
}

fn check(path: &std::path::Path) -> bool {
    match load(path) {
        Ok(loaded) => {
            assert_eq!(loaded.scene.validate(), Ok(()));
            let _ = Summary::new(&loaded.scene).to_string();
            travels(&loaded.scene);
            true
        }
        Err(error) => {
            // Of the file itself or of one that it names.
            let (message, folder) = (error.to_string(), path.parent().unwrap());
            let folder = folder.to_string_lossy();
            assert!(message.contains(&*folder), "{message}");
            assert!(message.len() < 4096, "fit to be shown: {}", message.len());
            false
        }
    }
}

/// What a constructor loads its shaders must get.
fn travels(scene: &Scene) {
    let bytes = scene_blob::encode(scene).unwrap();
    let back = scene_blob::decode(&bytes).unwrap();
    assert!(scene_blob::encode(&back).unwrap() == bytes);
}
