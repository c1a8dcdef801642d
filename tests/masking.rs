//! Masking, end to end: faint lights beside a bright one are left out, and nobody sees it.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::{fmt::Write, path::Path};

use lie_render::Film;
use serde_json::Value;

/// The Cornell box, with thirty faint lights before its opening.
fn scene(home: &Path) -> std::path::PathBuf {
    let mut text = String::from("[[geometry]]\ngenerator = \"cornell-box\"\n");
    for number in 0..30 {
        let (x, y) = (number % 6, number / 6);
        writeln!(text, "[[light]]\nkind = \"point\"").unwrap();
        writeln!(text, "position = [{}.0, {}.0, 3.0]", x - 3, y + 1).unwrap();
        writeln!(text, "radiant_intensity = [0.01, 0.01, 0.01]").unwrap();
    }
    let path = home.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    path
}

fn render(scene: &Path, options: &[&str]) -> (Film, Value) {
    let home = scene.parent().unwrap();
    let [out, stats] = ["frame.exr", "stats.json"].map(|name| home.join(name));
    let mut command = support::lie();
    command.arg("render").arg(scene).args(["--log", "error"]);
    command.args(["--size", "96x96", "--light-samples", "16"]);
    command.args(["--samples", "147456"]).args(options);
    command.arg("--out").arg(&out).arg("--stats").arg(&stats);
    support::succeeds(&mut command);
    let stats = serde_json::from_slice(&std::fs::read(stats).unwrap()).unwrap();
    (lie_render::read_image(&out).unwrap(), stats)
}

#[test]
fn what_is_masked_is_not_seen() {
    let home = tempfile::tempdir().unwrap();
    let scene = scene(home.path());
    for trust in ["0", "512"] {
        let (full, without) = render(&scene, &["--trust", trust]);
        let (masked, with) = render(&scene, &["--trust", trust, "--masking", "0.02"]);
        assert_eq!(without["lie"]["masked"], 0);
        let count = with["lie"]["masked"].as_u64().unwrap();
        assert!(count > 0, "trust {trust}: nothing is masked");
        let figures = lie_render::compare(&masked, &full, 0.0).unwrap();
        assert!(figures.differing > 0.0, "trust {trust}: {count} masked");
        assert!(figures.flip_mean < 0.01, "trust {trust}: {figures:?}");
        assert!(figures.relative_rmse < 0.02, "trust {trust}: {figures:?}");
        // Shadows are left out, or lights: either way about as much as allowed at most.
        for (masked, full) in masked.radiance().iter().zip(full.radiance()) {
            let (masked, full) = (masked.element_sum(), full.element_sum());
            let error = (masked - full).abs();
            assert!(error <= 0.025 * full, "trust {trust}: {masked} {full}");
        }
    }
}

#[test]
fn all_who_construct_take_a_fraction_and_nothing_else() {
    let scene = support::cornell();
    for name in ["render", "run", "constructor"] {
        for wrong in ["1.5", "-0.02", "NaN"] {
            let mut command = support::lie();
            command.arg(name).arg(&scene);
            command.args(["--masking", wrong]);
            let message = support::failure(&mut command, 2);
            assert!(message.contains("from 0 to 1"), "{message}");
        }
    }
}
