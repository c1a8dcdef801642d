//! The converged picture is the reference's: LIEs against a full shadow ray for every light
//! and sample, on every scene at hand. Prints the errors: run with `--nocapture`.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(clippy::print_stdout, reason = "the errors are what one runs it for")]

mod support;

use std::path::{Path, PathBuf};

use serde_json::Value;

/// Relative RMSE that a converged picture may have (the paper gives no figure).
const TOLERANCE: f64 = 0.005;

/// Renders a scene both ways and compares.
fn check(scene: &Path, options: &[&str]) {
    let home = tempfile::tempdir().unwrap();
    let render = |integrator: &str| -> (PathBuf, Value) {
        let picture = home.path().join(format!("{integrator}.exr"));
        let stats = home.path().join(format!("{integrator}.json"));
        let mut command = support::lie();
        command
            .arg("render")
            .arg(scene)
            .args(["--integrator", integrator, "--log", "error"]);
        command
            .args(["--size", "256x192", "--out"])
            .arg(&picture)
            .arg("--stats")
            .arg(&stats);
        if integrator == "lie" {
            command.args(options);
        }
        support::succeeds(&mut command);
        (
            picture,
            serde_json::from_slice(&std::fs::read(&stats).unwrap()).unwrap(),
        )
    };
    let (reference, standard) = render("standard");
    let (picture, lie) = render("lie");
    let [picture, reference] =
        [picture, reference].map(|path| lie_render::read_image(&path).unwrap());
    let figures = lie_render::compare(&picture, &reference, 0.0).unwrap();
    println!(
        "{} {options:?}: relative RMSE {:.4} % ({:.4} % without the worst thousandth), FLIP {:.5}; \
         {:.1} % of the evaluations trusted, {:.1} % of the shadow rays left, {} ms where standard took {} ms",
        scene.display(),
        100.0 * figures.relative_rmse,
        100.0 * figures.relative_rmse_p999,
        figures.flip_mean,
        100.0 * lie["trusted_fraction"].as_f64().unwrap(),
        100.0 * lie["shadow_rays"].as_f64().unwrap()
            / standard["shadow_rays"].as_f64().unwrap().max(1.0),
        lie["frame_ms"],
        standard["frame_ms"],
    );
    let lit = reference
        .radiance()
        .iter()
        .filter(|value| value.max_element() > 0.0)
        .count();
    assert!(
        lit > reference.radiance().len() / 10,
        "the reference must show something"
    );
    assert!(
        lie["trusted_fraction"].as_f64().unwrap() > 0.01,
        "the LIEs must be used"
    );
    assert!(
        figures.relative_rmse < TOLERANCE,
        "relative RMSE {}",
        figures.relative_rmse
    );
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name)
}

/// A public scene beside the repository, with lights of ours; nothing where there is none.
fn public(name: &str, options: &[&str]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    if root.join("../shared/scenes").is_dir() {
        check(
            &root
                .join("tests/fixtures")
                .join(name)
                .with_extension("toml"),
            options,
        );
    } else {
        println!("SKIPPED {name}: ../shared/scenes is not there");
    }
}

#[test]
fn the_cornell_box() {
    check(&shipped("cornell"), DEFAULT);
}

/// With doubt, 16 samples in every pixel: what is not known by then is traced.
const DEFAULT: &[&str] = &["--samples", "786432"];

/// Without doubt: what is not known to be lit is dark, as in the paper. 64 samples in every
/// pixel, or as many as it takes.
const PAPER: &[&str] = &["--trust", "0"];

/// The paper to the letter, with the smaller of its two depths: nothing is inherited, lists
/// have any length, and cells split however few samples they have.
const TO_THE_LETTER: &[&str] = &[
    "--trust",
    "0",
    "--from-scratch",
    "--split-samples",
    "1",
    "--crowd",
    "4294967295",
    "--max-depth",
    "6",
    "--split",
    "64",
];

#[test]
#[ignore = "takes a minute or two"]
fn modern_hall_to_the_letter_of_the_paper() {
    public("modern-hall", TO_THE_LETTER);
}

#[test]
#[ignore = "takes a minute or two"]
fn the_gallery_to_the_letter_of_the_paper() {
    check(&shipped("gallery"), TO_THE_LETTER);
}

#[test]
fn the_cornell_box_as_in_the_paper() {
    check(&shipped("cornell"), PAPER);
}

#[test]
#[ignore = "takes a minute or two"]
fn the_gallery() {
    check(&shipped("gallery"), DEFAULT);
}

#[test]
#[ignore = "takes a minute or two"]
fn the_gallery_as_in_the_paper() {
    check(&shipped("gallery"), PAPER);
}

#[test]
#[ignore = "takes a minute"]
fn modern_hall() {
    public("modern-hall", DEFAULT);
}

#[test]
#[ignore = "takes a minute or two"]
fn modern_hall_as_in_the_paper() {
    public("modern-hall", PAPER);
}

#[test]
#[ignore = "takes many seconds"]
fn breakfast_room() {
    public("breakfast-room", DEFAULT);
    public("breakfast-room", PAPER);
}

#[test]
#[ignore = "takes many seconds"]
fn home_theater() {
    public("home-theater", DEFAULT);
    public("home-theater", PAPER);
}

#[test]
#[ignore = "takes many seconds"]
fn zdm2() {
    public("zdm2", DEFAULT);
    public("zdm2", PAPER);
}

#[test]
#[ignore = "takes many seconds"]
fn the_other_cornell_box() {
    public("cornell-mcguire", DEFAULT);
    public("cornell-mcguire", PAPER);
}
