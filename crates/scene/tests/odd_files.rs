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

/// Cuts a file short at every few bytes and changes its bytes one by one: nothing may
/// panic, hang, or come out as an invalid scene.
fn abuse(bytes: &[u8], extension: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("abused").with_extension(extension);
    let check = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        if let Err(message) = load_timed(&path) {
            assert!(message.contains("abused"), "names the file: {message}");
        }
    };
    let step = (bytes.len() / 400).max(1);
    for length in (0..bytes.len()).step_by(step) {
        check(&bytes[..length]);
    }
    for place in (0..bytes.len()).step_by(step) {
        for value in [0, b'9', b'-', b'}', 0x7f, 0xff] {
            let mut changed = bytes.to_vec();
            changed[place] = value;
            check(&changed);
        }
    }
}

#[test]
fn cut_and_changed_glb_files_are_survived() {
    let scene = lie_scene::cornell_box();
    abuse(&lie_scene::export_glb(&scene).unwrap().content, "glb");
    if let Some(folder) = odd() {
        abuse(&std::fs::read(folder.join("Lights.glb")).unwrap(), "glb");
        abuse(&std::fs::read(folder.join("NoScene.gltf")).unwrap(), "gltf");
    }
}

#[test]
fn cut_and_changed_obj_and_toml_files_are_survived() {
    let obj = "mtllib a.mtl\no a\nusemtl b\nv 0 0 0\nv 1 0 0 1 1 1\nv 1 1 0\nv 0 1e0 0\nvt 0 0\nvn 0 0 1\n\
               f 1 2 3 4\nf -4/1 -3/1 -2/1\nf 1//1 2//1 3//1\nl 1 2\n";
    abuse(obj.as_bytes(), "obj");
    let toml = "name = \"a\"\n[[geometry]]\ngenerator = \"cornell-box\"\nscale = 2\n[[light]]\nkind = \"spot\"\n\
                position = [0, 1, 2]\ntarget = [0, 0, 0]\nradiant_intensity = [1, 2, 3]\nouter_degrees = 30\n\
                [[walkthrough]]\nname = \"w\"\n[[walkthrough.key_frame]]\ntime_s = 0\neye = [0, 0, 0]\ntarget = [1, 0, 0]\n";
    abuse(toml.as_bytes(), "toml");
}

/// A document with one triangle whose parts a test may spoil.
fn triangle_gltf(spoil: &dyn Fn(&mut String)) -> Result<Loaded, String> {
    let mut text = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
        "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#
        .to_owned();
    spoil(&mut text);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("triangle.gltf");
    std::fs::write(&path, text).unwrap();
    load_timed(&path)
}

#[test]
fn hostile_documents_end_in_a_message() {
    assert_eq!(triangle_gltf(&|_| {}).unwrap().scene.geometry.len(), 1);
    for (from, to, piece) in [
        ("\"count\":3", "\"count\":4", "4 elements do not fit"),
        ("\"count\":3", "\"count\":18446744073709551615", "too many"),
        (
            "\"byteLength\":36}]",
            "\"byteLength\":36,\"byteOffset\":18446744073709551615}]",
            "buffer view 0",
        ),
        (
            "\"bufferView\":0,",
            "\"bufferView\":0,\"byteOffset\":18446744073709551615,",
            "do not fit",
        ),
        ("\"bufferView\":0,", "", ""),
        (
            "\"asset\"",
            "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\"",
            "KHR_draco_mesh_compression",
        ),
        (
            "\"mesh\":0}",
            "\"mesh\":0,\"scale\":[1e39,1,1]}",
            "triangle.gltf",
        ),
        ("\"mesh\":0}", "\"mesh\":0,\"children\":[0]}", "node 0"),
        ("AACAPw", "AADAfw", "POSITION"),
        ("\"POSITION\":0", "\"NORMAL\":0", "POSITION"),
        ("\"version\":\"2.0\"", "\"version\":\"1.0\"", "expected 2.x"),
        ("data:;base64,", "data:;base64,!", "buffer 0"),
        ("data:;base64,", "http://x/", "relative"),
        ("\"type\":\"VEC3\"", "\"type\":\"VEC2\"", "expected Vec3"),
    ] {
        let message = match triangle_gltf(&|text| *text = text.replacen(from, to, 1)) {
            Ok(_) => String::from("(loads)"),
            Err(message) => message,
        };
        assert!(message.contains(piece), "{to} → {message}");
    }
}

#[test]
fn a_long_chain_of_nodes_does_not_overflow_the_stack() {
    let mut nodes = String::new();
    for index in 1..100_000 {
        nodes.push_str(&format!("{{\"children\":[{}]}},", index));
    }
    nodes.push_str("{\"mesh\":0}");
    let loaded = triangle_gltf(&|text| {
        *text = text.replacen("{\"mesh\":0}", &nodes, 1);
    });
    assert_eq!(loaded.unwrap().scene.geometry.len(), 1);
}
