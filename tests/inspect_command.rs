//! `lie inspect`, as the real binary.

#![allow(clippy::unwrap_used)]

mod support;

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;
use support::{cornell, failure, lie, succeeds};

/// The gallery, coarse; in a folder of its own.
fn gallery(folder: &Path) -> PathBuf {
    let scene = folder.join("scene.toml");
    let text = "name = \"small\"\n[[geometry]]\ngenerator = \"gallery\"\ndetail = 0.25\n\
                [settings]\nlight_samples = 4\n";
    fs::write(&scene, text).unwrap();
    scene
}

fn inspect(scene: &Path, more: &[&str]) -> Command {
    let mut command = lie();
    command.arg("inspect").arg(scene);
    command.args(["--size", "48x32", "--samples", "20000", "--trust", "64"]);
    command.args(more);
    command
}

fn output(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?} failed: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

fn keys(value: &Value) -> BTreeSet<&str> {
    value
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect()
}

fn check_keys(value: &Value, expected: &str) {
    assert_eq!(keys(value), expected.split_whitespace().collect());
}

fn sum(lights: &[Value], key: &str) -> f64 {
    lights
        .iter()
        .map(|light| light[key].as_f64().unwrap())
        .sum()
}

#[test]
fn a_pixel_is_told_in_a_table_and_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, json) = (gallery(folder.path()), folder.path().join("pixel.json"));
    let more = ["--pixel", "20,21", "--json", json.to_str().unwrap()];
    let table = output(&mut inspect(&scene, &more));
    for expected in [
        "pixel 20,21 of 48 x 32",
        "surface ",
        "cell ",
        "region ",
        "samples ",
        "rays ",
        "share %",
        "lights left out",
    ] {
        assert!(table.contains(expected), "no '{expected}' in {table}");
    }
    let all = output(inspect(&scene, &more).arg("--all"));
    assert!(!all.contains("left out:"), "{all}");
    assert!(all.lines().count() > table.lines().count());

    let report: Value = serde_json::from_slice(&fs::read(&json).unwrap()).unwrap();
    check_keys(&report, "camera size pixel samples version trust seen");
    assert_eq!(report["pixel"], serde_json::json!([20, 21]));
    let seen = &report["seen"];
    check_keys(seen, "surface cell lights totals");
    check_keys(
        &seen["surface"],
        "position shadow_origin normal distance triangle mesh material emitted",
    );
    check_keys(
        &seen["cell"],
        "path depth bounds region holds samples dark_samples occluders",
    );
    check_keys(
        &seen["totals"],
        "exact shaded luminance error expected_error standard_rays traced_rays saved_rays \
         list_rays occluder_tests",
    );
    let lights = seen["lights"].as_array().unwrap();
    assert_eq!(
        lights.len(),
        lie_scene::load(&scene).unwrap().scene.lights.len()
    );
    for light in lights {
        check_keys(
            light,
            "light name kind class open answer evidence needed exact shaded luminance error \
             expected_error standard_rays traced_rays saved_rays list_rays occluder_tests \
             occluders missed",
        );
        for occluder in light["occluders"].as_array().unwrap() {
            check_keys(occluder, "triangle mesh material confirmed");
        }
    }
    for key in [
        "standard_rays",
        "traced_rays",
        "saved_rays",
        "occluder_tests",
    ] {
        assert_eq!(
            sum(lights, key),
            seen["totals"][key].as_f64().unwrap(),
            "{key}"
        );
    }
    let luminance = seen["totals"]["luminance"].as_f64().unwrap();
    assert!(luminance > 0.0);
    assert!((sum(lights, "luminance") / luminance - 1.0).abs() < 1.0e-4);

    // The table is sorted by what lights give.
    let shares: Vec<f64> = all
        .lines()
        .skip_while(|line| !line.contains("share %"))
        .skip(1)
        .filter_map(|line| share(line, lights))
        .collect();
    assert_eq!(shares.len(), lights.len());
    assert!(shares.is_sorted_by(|a, b| a >= b), "{shares:?}");
}

/// What the light that a row is about gives.
fn share(row: &str, lights: &[Value]) -> Option<f64> {
    let light: u64 = row.split_whitespace().next()?.parse().ok()?;
    let found = lights.iter().find(|known| known["light"] == light)?;
    found["luminance"].as_f64()
}

#[test]
fn what_a_pixel_shows_is_what_the_picture_has() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let scene = gallery(folder.path());
    let options = ["--size", "48x32", "--samples", "20000", "--trust", "64"];
    for (integrator, key) in [("lie", "shaded"), ("standard", "exact")] {
        let mut render = lie();
        render.arg("render").arg(&scene).args(options);
        render.args(["--integrator", integrator, "--out"]);
        succeeds(render.arg(path("a.exr")));
        let picture = lie_render::read_image(&path("a.exr")).unwrap();
        let json = path("pixel.json");
        output(inspect(&scene, &["--pixel", "30,20", "--json"]).arg(&json));
        let report: Value = serde_json::from_slice(&fs::read(&json).unwrap()).unwrap();
        let pixel = picture.radiance()[20 * 48 + 30];
        for channel in 0..3 {
            let light = report["seen"]["totals"][key][channel].as_f64().unwrap();
            let emitted = report["seen"]["surface"]["emitted"][channel]
                .as_f64()
                .unwrap();
            let expected = f64::from(pixel[channel]);
            assert!(
                (light + emitted - expected).abs() <= 1.0e-4 * (1.0 + expected),
                "{key}"
            );
        }
    }
}

#[test]
fn a_pixel_that_sees_nothing_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let text = "[[geometry]]\ngenerator = \"cornell-box\"\n[[camera]]\nname = \"away\"\n\
                eye = [0.0, 100.0, 0.0]\ntarget = [0.0, 200.0, 1.0]\n";
    fs::write(&scene, text).unwrap();
    let json = folder.path().join("pixel.json");
    let mut command = lie();
    command.arg("inspect").arg(&scene);
    command.args(["--camera", "away", "--size", "8x8", "--pixel", "4,4"]);
    command.args(["--samples", "64", "--json"]).arg(&json);
    let text = output(&mut command);
    assert!(text.contains("nothing to see"), "{text}");
    let report: Value = serde_json::from_slice(&fs::read(&json).unwrap()).unwrap();
    assert!(report["seen"].is_null());
}

#[test]
fn what_cannot_be_ends_in_2_and_says_why() {
    for (arguments, expected) in [
        (&["--pixel", "48,0"][..], "outside of the picture"),
        (&["--pixel", "0,32"], "rows 0 to 31"),
        (&["--pixel", "1"], "COLUMN,ROW"),
        (&["--pixel", "-1,2"], "-1"),
        (&[], "--pixel"),
        (&["--pixel", "1,1", "--camera", "nowhere"], "it has: front"),
        (&["--pixel", "1,1", "--walk", "tour"], "walkthrough"),
        (&["--pixel", "1,1", "--light-samples", "0"], "light samples"),
        (&["--pixel", "1,1", "--masking", "2"], "from 0 to 1"),
    ] {
        let message = failure(&mut inspect(&cornell(), arguments), 2);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    let message = failure(
        &mut inspect(Path::new("no/such.glb"), &["--pixel", "1,1"]),
        2,
    );
    assert!(message.contains("no/such.glb"), "{message}");
}

#[test]
fn a_second_look_takes_what_the_first_has_learnt() {
    let folder = tempfile::tempdir().unwrap();
    let scene = gallery(folder.path());
    let file = folder.path().join("lies");
    let look = |samples: &str| {
        let mut command = lie();
        command.arg("inspect").arg(&scene).arg("--lies").arg(&file);
        command.args(["--size", "48x32", "--trust", "64", "--pixel", "20,20"]);
        output(command.args(["--samples", samples]))
    };
    let first = look("20000");
    assert!(fs::metadata(&file).unwrap().len() > 1000);
    assert_eq!(look("0"), first);
}
