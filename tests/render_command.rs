//! `lie render` and `lie compare`, as the real binary.

#![allow(clippy::unwrap_used)]

mod support;

use std::{fs, path::Path, process::Command};

use serde_json::Value;
use support::{cornell, failure, lie};

/// A small render of the Cornell box, but for what `more` says.
fn render(out: &Path, more: &[&str]) -> Command {
    let mut command = lie();
    command.arg("render").arg(cornell()).arg("--out").arg(out);
    if !more.contains(&"--size") {
        command.args(["--size", "24x24"]);
    }
    command.args(more);
    command
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn wrong_arguments_end_in_2_and_say_what_was_expected() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a.exr");
    for (arguments, expected) in [
        (&["--size", "24"][..], "WIDTHxHEIGHT"),
        (&["--size", "0x24"], "WIDTHxHEIGHT"),
        (&["--size", "24x99999"], "16384"),
        (&["--spp", "0"], "samples per pixel"),
        (&["--spp", "-1"], "-1"),
        (&["--spp", "1000000"], "samples per pixel"),
        (&["--light-samples", "0"], "light samples"),
        (&["--camera", "nowhere"], "it has: front"),
        (&["--walk", "tour"], "walkthrough"),
        (
            &["--camera", "front", "--walk", "tour"],
            "cannot be used with",
        ),
        (&["--at", "1"], "--walk"),
        (&["--integrator", "path"], "standard, ward, lie"),
        (&["--ward-threshold", "-0.1"], "from 0 to 1"),
        (&["--ward-threshold", "NaN"], "from 0 to 1"),
        (&["--ward-threshold", "1.5"], "from 0 to 1"),
        (&["--ward-threshold", "2"], "from 0 to 1"),
        (&["--exposure", "NaN"], "exposure"),
        (&["--exposure", "1000"], "exposure"),
        (&["--max-depth", "0"], "1..=20"),
        (&["--max-depth", "21"], "1..=20"),
        (&["--max-depth", "40"], "1..=20"),
        (&["--split", "0"], "--split"),
        (&["--trust", "x"], "--trust"),
        (&["--masking", "1.01"], "from 0 to 1"),
        (&["--masking", "-0.02"], "from 0 to 1"),
        (&["--masking", "NaN"], "from 0 to 1"),
        (&["--masking", "1.5"], "from 0 to 1"),
        (&["--masking", "-1"], "from 0 to 1"),
        (&["--masking", "nan"], "from 0 to 1"),
        (&["--repeat", "0"], "--repeat"),
        (&["--precision", "double"], "half, float"),
        (&["--log", "=="], "error"),
        (&["--no-such-option"], "--no-such-option"),
    ] {
        let message = failure(&mut render(&out, arguments), 2);
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert!(!out.exists(), "{arguments:?} left a picture");
    }
}

#[test]
fn wrong_files_end_in_2_and_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("broken.toml"), "[[light]]\nkind = \"torch\"\n").unwrap();
    fs::write(path("text.glb"), "not a binary glTF").unwrap();
    fs::write(path("scene.xyz"), "").unwrap();
    let out = path("a.exr");
    for (name, expected) in [
        ("missing.glb", "missing.glb"),
        ("nowhere", "nowhere"),
        ("no/such/scene.toml", "scene.toml"),
        ("broken.toml", "broken.toml:2:"),
        ("text.glb", "text.glb"),
        ("scene.xyz", "scene.xyz"),
        (".", "scene.toml"),
    ] {
        let mut command = lie();
        command.arg("render").arg(path(name)).arg("--out").arg(&out);
        let message = failure(&mut command, 2);
        assert!(message.contains(expected), "{name}: {message}");
    }
    for ending in ["picture", "picture.jpg", "picture.exr.gz"] {
        let message = failure(&mut render(&path(ending), &[]), 2);
        assert!(message.contains(".exr or .png"), "{ending}: {message}");
    }
}

#[test]
fn a_picture_that_cannot_be_written_ends_in_1() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["no/such/folder/a.exr", "no/such/folder/a.png"] {
        let out = folder.path().join(name);
        let message = failure(&mut render(&out, &["--integrator", "standard"]), 1);
        assert!(message.contains(&out.display().to_string()), "{message}");
    }
}

#[test]
fn statistics_hold_what_was_promised() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let keys = [
        "scene integrator accel threads width height spp frame_ms visibility_ms",
        "unoccluded_ms partial_ms construct_ms primary_rays shadow_rays occluder_tests",
        "build_ms lights triangles accel_bytes",
    ];
    for integrator in ["standard", "ward", "lie"] {
        let stats = path("stats.json");
        let mut command = render(&path("a.exr"), &["--integrator", integrator, "--spp", "2"]);
        let output = command.arg("--stats").arg(&stats).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let stats = json(&stats);
        for key in keys.iter().flat_map(|line| line.split(' ')) {
            assert!(
                !stats[key].is_null(),
                "{integrator}: {key} is missing in {stats}"
            );
        }
        assert_eq!(stats["integrator"], integrator);
        assert_eq!(stats["primary_rays"], 24 * 24 * 2);
        assert_eq!(stats["lie"].is_null(), integrator != "lie");
        for key in ["cells", "entries", "occluders", "bytes"] {
            assert_eq!(stats["lie"][key].is_u64(), integrator == "lie", "{key}");
        }
        assert_eq!(stats["lie"]["expected_error"].is_f64(), integrator == "lie");
    }
}

#[test]
fn half_precision_is_the_picture_rounded() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for (out, precision) in [("float.exr", "float"), ("half.exr", "half")] {
        let more = ["--integrator", "standard", "--precision", precision];
        let output = render(&path(out), &more).output().unwrap();
        assert!(output.status.success(), "{output:?}");
    }
    let mut compare = lie();
    compare
        .arg("compare")
        .args([path("half.exr"), path("float.exr")]);
    let output = compare.arg("--json").arg(path("c.json")).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let distance = json(&path("c.json"))["relative_rmse"].as_f64().unwrap();
    // A half has eleven digits: rounding errs by at most 1 in 2,048.
    assert!(distance > 0.0 && distance < 1.0 / 2048.0, "{distance}");
}

#[test]
fn the_seed_decides() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |seed: &str, threads: &str| {
        let out = folder.path().join(format!("{seed}-{threads}.exr"));
        let more = [
            "--integrator",
            "standard",
            "--seed",
            seed,
            "--threads",
            threads,
        ];
        assert!(render(&out, &more).output().unwrap().status.success());
        fs::read(out).unwrap()
    };
    let first = picture("1", "1");
    assert!(first == picture("1", "2"), "threads change nothing");
    assert!(
        first != picture("2", "1"),
        "another seed is another picture"
    );
}

#[test]
fn compare_refuses_what_cannot_be_compared() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for (out, size) in [("small.exr", "8x8"), ("large.exr", "9x8")] {
        let more = ["--integrator", "standard", "--size", size];
        assert!(render(&path(out), &more).output().unwrap().status.success());
    }
    fs::write(path("broken.exr"), "not a picture").unwrap();
    fs::write(path("text.txt"), "").unwrap();
    for (other, expected) in [
        ("large.exr", "differ in size"),
        ("missing.exr", "missing.exr"),
        ("broken.exr", "broken.exr"),
        ("text.txt", "text.txt"),
    ] {
        let mut compare = lie();
        compare
            .arg("compare")
            .args([path("small.exr"), path(other)]);
        let message = failure(&mut compare, 2);
        assert!(message.contains(expected), "{other}: {message}");
    }
}
