//! `lie render --aovs`, as the real binary: what is in the layers.

#![allow(clippy::unwrap_used)]

mod support;

use std::{collections::BTreeMap, fs, path::Path, process::Command};

use exr::prelude::{ReadChannels, ReadLayers};
use serde_json::Value;
use support::{cornell, failure, lie, succeeds};

const SIZE: (usize, usize) = (48, 32);

const ALWAYS: &str = "B G R albedo.B albedo.G albedo.R cost.Y normal.X normal.Y normal.Z \
                      work.evaluations work.list work.primary work.shadow work.tests";

const OF_CELLS: &str = "cell.depth cell.samples expected_error.Y lights.hidden lights.masked lights.partial \
                        lights.traced lights.unoccluded";

/// The gallery, coarse; in a folder of its own.
fn gallery(folder: &Path) -> std::path::PathBuf {
    let scene = folder.join("scene.toml");
    let text = "name = \"small\"\n[[geometry]]\ngenerator = \"gallery\"\ndetail = 0.25\n\
                [settings]\nlight_samples = 4\n";
    fs::write(&scene, text).unwrap();
    scene
}

/// A render of the coarse gallery's hall with few samples: some lights are known, some not.
fn render(scene: &Path, out: &Path, aovs: &Path, more: &[&str]) -> Command {
    let mut command = lie();
    command.arg("render").arg(scene).arg("--out").arg(out);
    command.arg("--aovs").arg(aovs);
    command.args(["--size", &format!("{}x{}", SIZE.0, SIZE.1)]);
    command.args(more);
    command
}

/// All channels of a file by their names.
fn channels(path: &Path) -> BTreeMap<String, Vec<f32>> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .unwrap();
    assert_eq!((image.layer_data.size.0, image.layer_data.size.1), SIZE);
    let list = image.layer_data.channel_data.list;
    list.into_iter()
        .map(|channel| {
            let values = channel.sample_data.values_as_f32().collect();
            (channel.name.to_string(), values)
        })
        .collect()
}

fn names(text: &str) -> Vec<&str> {
    text.split(' ').collect()
}

fn sum(values: &[f32]) -> f64 {
    values.iter().map(|&value| f64::from(value)).sum()
}

#[test]
fn layers_are_named_as_viewers_know_them_and_hold_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let scene = gallery(folder.path());
    let mut command = render(
        &scene,
        &path("out.exr"),
        &path("aovs.exr"),
        &["--samples", "40000", "--trust", "64"],
    );
    succeeds(command.arg("--stats").arg(path("stats.json")));
    let found = channels(&path("aovs.exr"));
    let mut expected = [names(ALWAYS), names(OF_CELLS)].concat();
    expected.sort_unstable();
    assert_eq!(found.keys().collect::<Vec<_>>(), expected);

    // The picture is the picture, for those who read nothing else as well.
    let picture = lie_render::read_image(&path("out.exr")).unwrap();
    assert_eq!(lie_render::read_image(&path("aovs.exr")).unwrap(), picture);

    // What was counted here is what the renderer counted.
    let stats: Value = serde_json::from_slice(&fs::read(path("stats.json")).unwrap()).unwrap();
    for (channel, count) in [
        ("work.primary", "primary_rays"),
        ("work.list", "list_rays"),
        ("work.tests", "occluder_tests"),
        ("work.shadow", "shadow_rays"),
    ] {
        let counted = stats[count].as_f64().unwrap();
        assert!(counted > 0.0, "{count}");
        assert_eq!(sum(&found[channel]), counted, "{channel}");
    }

    // The frame's figure is that of its pixels, by the picture's mean.
    let squares: Vec<f32> = found["expected_error.Y"]
        .iter()
        .map(|error| error * error)
        .collect();
    let luminances = picture.radiance().iter();
    let luminances: Vec<f32> = luminances
        .map(|&value| lie_render::luminance(value))
        .collect();
    let pixels = squares.len() as f64;
    let expected = (sum(&squares) / pixels).sqrt() / (sum(&luminances) / pixels);
    let stated = stats["lie"]["expected_error"].as_f64().unwrap();
    assert!(
        (stated / expected - 1.0).abs() < 1.0e-4,
        "{stated} is not {expected}"
    );

    let lights = names(OF_CELLS).into_iter();
    let lights: Vec<&str> = lights.filter(|name| name.starts_with("lights.")).collect();
    let all = lie_scene::load(&scene).unwrap().scene.lights.len() as f32;
    for pixel in 0..SIZE.0 * SIZE.1 {
        let at = |name: &str| found[name][pixel];
        let normal = ["normal.X", "normal.Y", "normal.Z"].map(at);
        let length = normal.iter().map(|part| part * part).sum::<f32>().sqrt();
        let sees = length > 0.0;
        assert!(!sees || (length - 1.0).abs() < 1.0e-4, "{normal:?}");
        let classes: f32 = lights.iter().map(|&name| at(name)).sum();
        assert_eq!(classes, if sees { all } else { 0.0 });
        for name in ["albedo.R", "albedo.G", "albedo.B"] {
            assert!((0.0..=1.0).contains(&at(name)), "{name}");
        }
        assert!((0.0..=9.0).contains(&at("cell.depth")));
        assert!(at("cost.Y") > 0.0);
    }
    for name in OF_CELLS.split(' ').filter(|&name| name != "lights.masked") {
        assert!(sum(&found[name]) > 0.0, "{name} is nothing anywhere");
    }
}

#[test]
fn where_nothing_is_relied_on_by_samples_no_error_is_to_be_expected() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let scene = gallery(folder.path());
    let mut command = render(
        &scene,
        &path("out.exr"),
        &path("aovs.exr"),
        &[
            "--samples",
            "20000",
            "--trust",
            "4000000000",
            "--split-samples",
            "16",
        ],
    );
    succeeds(command.arg("--stats").arg(path("stats.json")));
    let stats: Value = serde_json::from_slice(&fs::read(path("stats.json")).unwrap()).unwrap();
    assert!(
        stats["trusted_fraction"].as_f64().unwrap() > 0.1,
        "geometry settles some"
    );
    let found = channels(&path("aovs.exr"));
    assert_eq!(sum(&found["expected_error.Y"]), 0.0);
    assert_eq!(stats["lie"]["expected_error"], 0.0);
}

#[test]
fn masking_never_costs_more() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let scene = gallery(folder.path());
    let found = |masking: &str| {
        let aovs = path(&format!("{masking}.exr"));
        let more = ["--samples", "60000", "--trust", "64", "--masking", masking];
        // What is proven is not masked: both go by samples.
        let mut command = render(&scene, &path("out.png"), &aovs, &more);
        succeeds(command.arg("--no-proofs"));
        channels(&aovs)
    };
    let (without, with) = (found("0"), found("0.05"));
    assert_eq!(sum(&without["lights.masked"]), 0.0);
    assert!(sum(&with["lights.masked"]) > 0.0);
    let mut pairs = without["cost.Y"].iter().zip(&with["cost.Y"]);
    assert!(pairs.all(|(without, with)| with <= without));
    assert!(sum(&with["cost.Y"]) < sum(&without["cost.Y"]));
    // The same cells, from the same samples.
    for name in ["cell.depth", "cell.samples", "lights.traced"] {
        assert_eq!(with[name], without[name], "{name}");
    }
}

#[test]
fn without_lies_there_are_no_cells_and_threads_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for integrator in ["standard", "ward"] {
        let files = ["1", "2"].map(|threads| {
            let aovs = path(&format!("{integrator}-{threads}.exr"));
            let more = ["--integrator", integrator, "--threads", threads];
            let mut command = render(&cornell(), &path("out.png"), &aovs, &more);
            succeeds(command.args(["--precision", "half", "--spp", "2"]));
            fs::read(aovs).unwrap()
        });
        assert!(files[0] == files[1], "{integrator}");
        let found = channels(&path(&format!("{integrator}-1.exr")));
        assert_eq!(found.keys().collect::<Vec<_>>(), names(ALWAYS));
        assert!(found["work.primary"].iter().all(|&rays| rays == 2.0));
    }
}

#[test]
fn what_cannot_be_is_said_before_anything_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for (out, aovs, code, expected) in [
        ("a.exr", "b.png", 2, "ends in .exr"),
        ("a.exr", "b", 2, "ends in .exr"),
        ("a.exr", "a.exr", 2, "same file"),
        ("a.exr", "no/such/b.exr", 1, "there is no folder"),
    ] {
        let mut command = render(&cornell(), &path(out), &path(aovs), &[]);
        let message = failure(&mut command, code);
        assert!(message.contains(expected), "{aovs}: {message}");
        assert!(message.contains(aovs), "{aovs}: {message}");
        assert!(!path(out).exists(), "{aovs} left a picture");
    }
}
