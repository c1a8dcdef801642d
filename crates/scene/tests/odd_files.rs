//! Malformed and unusual files: each ends in a valid scene or in an error that names it.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use lie_scene::{Loaded, load};

/// The folder with the files, if it is there.
fn odd() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/odd");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: ../shared/odd is not there");
    None
}

fn load_timed(path: &Path) -> Result<Loaded, String> {
    let start = Instant::now();
    let result = load(path).map_err(|error| error.to_string());
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{} takes long",
        path.display()
    );
    if let Ok(loaded) = &result {
        loaded.scene.validate().unwrap();
    }
    result
}

/// The buffers of `PrimitiveModes` and `LightsSpot` are Git LFS pointers.
///
/// What each file must come to: triangles, or a piece of the message.
const EXPECTED: [(&str, Result<usize, &str>); 24] = [
    (
        "test-nan.obj",
        Err("test-nan.obj:12:3: expected a finite number, found 'nan'"),
    ),
    ("invalid-face-definition.obj", Ok(0)),
    ("issue-295-trianguation-failure.obj", Ok(28)),
    ("mtl filename with whitespace issue46.obj", Ok(12)),
    ("missing_material_file.obj", Ok(36)),
    (
        "invalid-relative-texture-index.obj",
        Err("invalid-relative-texture-index.obj:2:3: "),
    ),
    (
        "number_formats.obj",
        Err("number_formats.obj:11:14: expected a finite number"),
    ),
    ("concave_polygon.obj", Ok(64)),
    ("box_UTF16BE.obj", Ok(12)),
    ("malformed.obj", Err("malformed.obj:")),
    (
        "invalid_index.obj",
        Err("invalid_index.obj:12:7: '7' refers to number 7 of 6 vertices"),
    ),
    (
        "integer-out-of-bounds.gltf",
        Err("integer-out-of-bounds.gltf:"),
    ),
    (
        "invalid-primitive-indices.gltf",
        Err("invalid-primitive-indices.gltf: "),
    ),
    (
        "truncated_chunk_data.glb",
        Err("truncated_chunk_data.glb: GLB container"),
    ),
    (
        "length_mismatch.glb",
        Err("length_mismatch.glb: GLB container"),
    ),
    ("node_loop.gltf", Err("node_loop.gltf: node 0")),
    ("index_buffer_oob.gltf", Err("index_buffer_oob.gltf: ")),
    ("not_found.gltf", Err("not_found.gltf: buffer 0")),
    (
        "spot_invalid_angles.gltf",
        Err("spot_invalid_angles.gltf: light 0"),
    ),
    (
        "spot_light_without_spot_object.gltf",
        Err("spot_light_without_spot_object.gltf: "),
    ),
    ("NoScene.gltf", Ok(12)),
    (
        "PrimitiveModes.gltf",
        Err("PrimitiveModes.gltf: buffer 0: expected its data"),
    ),
    (
        "LightsSpot.gltf",
        Err("LightsSpot.gltf: buffer 0: expected its data"),
    ),
    ("Lights.glb", Ok(12)),
];

#[test]
fn every_odd_file_ends_as_expected() {
    let Some(folder) = odd() else { return };
    let mut wrong = Vec::new();
    for (name, expected) in EXPECTED {
        let outcome = load_timed(&folder.join(name));
        match &outcome {
            Ok(loaded) => println!(
                "{name}: {} triangles, {:?}",
                loaded.scene.geometry.len(),
                loaded.warnings
            ),
            Err(message) => println!("{message}"),
        }
        let fits = match (&outcome, expected) {
            (Ok(loaded), Ok(triangles)) => loaded.scene.geometry.len() == triangles,
            (Err(message), Err(piece)) => message.contains(piece),
            _ => false,
        };
        if !fits {
            wrong.push(format!(
                "{name}: expected {expected:?}, got {:?}",
                outcome.map(|l| l.scene.geometry.len())
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
