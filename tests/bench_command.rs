//! `lie bench`, as the real binary.

#![allow(clippy::unwrap_used)]

mod support;

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;
use support::{cornell, failure, lie, succeeds, wait_until};

/// A small measurement of the Cornell box.
fn bench(command: &str, more: &[&str]) -> Command {
    let mut bench = lie();
    bench.args(["bench", command]).arg(cornell());
    if !more.contains(&"--size") {
        bench.args(["--size", "64x48"]);
    }
    bench.args(more);
    bench
}

/// What a measurement writes to `--json`.
fn json(mut bench: Command) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.json");
    succeeds(bench.arg("--json").arg(&path));
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Checks that rows have these keys, and a number in those that are not in `may_be_null`.
fn check_rows(rows: &Value, keys: &str, may_be_null: &[&str]) {
    let rows = rows.as_array().unwrap();
    assert!(!rows.is_empty());
    for row in rows {
        for key in keys.split(' ') {
            let value = row.get(key).unwrap_or_else(|| panic!("no {key} in {row}"));
            let is_text = ["scene", "integrator", "mode"].contains(&key);
            let is_right = if is_text {
                value.is_string()
            } else {
                value.is_number()
            };
            assert!(
                is_right || (value.is_null() && may_be_null.contains(&key)),
                "{key} in {row}"
            );
        }
    }
}

#[test]
fn table1_compares_every_integrator_with_the_standard() {
    let written = json(bench("table1", &["--repeat", "1", "--threads", "1,2,1"]));
    let keys = "scene integrator threads frame_ms frame_ms_min frame_ms_max speedup relative_rmse \
                flip_mean lie_bytes";
    check_rows(&written["rows"], keys, &[]);
    let rows = written["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 8, "four integrators on one thread and on two");
    let (one, two) = rows.split_at(rows.len() / 2);
    assert!(one.iter().all(|row| row["threads"] == 1));
    assert!(two.iter().all(|row| row["threads"] == 2));
    assert_eq!(one[0]["integrator"], "standard");
    for row in rows {
        let number = |key: &str| row[key].as_f64().unwrap();
        assert_eq!(row["scene"], "cornell");
        assert!(number("frame_ms") > 0.0 && number("speedup") > 0.0, "{row}");
        assert!(number("frame_ms_min") <= number("frame_ms"), "{row}");
        assert!(number("frame_ms_max") >= number("frame_ms"), "{row}");
        if row["integrator"] == "standard" {
            assert_eq!((number("speedup"), number("relative_rmse")), (1.0, 0.0));
        }
        if row["integrator"] == "lie" {
            assert!(
                number("lie_bytes") > 0.0 && number("relative_rmse") < 0.02,
                "{row}"
            );
        }
    }
    assert!(written["machine"]["cores"].as_u64().unwrap() > 0);
    assert!(
        written["command"]
            .as_str()
            .unwrap()
            .starts_with("lie bench table1")
    );
}

#[test]
fn table2_says_where_the_time_goes() {
    let written = json(bench("table2", &["--repeat", "2", "--threads", "1"]));
    let keys = "scene threads visibility_ms unoccluded_ms partial_ms total_ms relative_rmse";
    check_rows(&written["rows"], keys, &[]);
    let rows = written["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 1);
    for key in ["visibility_ms", "total_ms"] {
        assert!(rows[0][key].as_f64().unwrap() > 0.0, "{key}");
    }
}

/// A coarse gallery: lights enough to mask some.
fn coarse_gallery(folder: &Path) -> PathBuf {
    let scene = folder.join("scene.toml");
    let text = "name = \"coarse\"\n[[geometry]]\ngenerator = \"gallery\"\ndetail = 0.25\n\
                [settings]\nlight_samples = 4\n";
    fs::write(&scene, text).unwrap();
    scene
}

#[test]
fn figure4_shows_that_masking_never_costs_more() {
    let folder = tempfile::tempdir().unwrap();
    let scene = coarse_gallery(folder.path());
    let measure = |threads: &str| {
        let mut bench = lie();
        bench.args(["bench", "figure4"]).arg(&scene);
        bench.args(["--size", "64x48", "--passes", "24", "--trust", "64"]);
        // What is proven is not masked: both go by samples.
        bench
            .args(["--no-proofs", "--threads", threads, "--report"])
            .arg(folder.path());
        json(bench)
    };
    let written = measure("1");
    let keys = "scene integrator mean_cost_us mean_measured_us cheaper_pixels saved \
                relative_rmse flip_mean";
    check_rows(&written["rows"], keys, &["cheaper_pixels", "saved"]);
    let rows = written["rows"].as_array().unwrap();
    let names: Vec<&str> = rows
        .iter()
        .map(|row| row["integrator"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["standard", "lie", "lie-masked"]);
    let number = |row: usize, key: &str| rows[row][key].as_f64().unwrap();
    assert!(number(2, "mean_cost_us") < number(1, "mean_cost_us"));
    assert!((0.0..=1.0).contains(&number(2, "cheaper_pixels")));
    assert!(number(2, "cheaper_pixels") > 0.0 && number(2, "saved") > 0.0);
    assert!(rows[1]["saved"].is_null() && rows[0]["cheaper_pixels"].is_null());
    let again = measure("2");
    for (row, key) in [(0, "mean_cost_us"), (1, "mean_cost_us"), (2, "saved")] {
        assert_eq!(again["rows"][row][key], rows[row][key], "{key}");
    }

    let out = folder.path().join("figure4.md");
    let text = fs::read_to_string(&out).unwrap();
    check_links(&out, &text);
    let costs = ["lie", "lie-masked", "standard"].map(|name| {
        let file = format!("figure4/figure4-coarse-{name}.png");
        let picture = lie_render::read_image(&folder.path().join(file)).unwrap();
        assert_eq!(picture.size(), glam::UVec2::new(64, 48));
        picture
    });
    // On one scale, masking is nowhere brighter.
    let pixels = costs[0].radiance().iter().zip(costs[1].radiance());
    for (without, with) in pixels {
        assert!(with.x <= without.x && with.x == with.y && with.y == with.z);
    }
}

#[test]
fn a_report_is_written_as_it_grows() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let scene = coarse_gallery(folder.path());
    let more = "--repeat 1 --limit 600 --passes 2000 --walk-frames 0 --size 16x16 --threads 1";
    let mut report = bench("report", &more.split(' ').collect::<Vec<_>>());
    report.arg(&scene).arg("--out").arg(path("results.md"));
    report.arg("--json").arg(path("results.json"));
    let mut running = report.spawn().unwrap();
    // Two thousand passes over the gallery are far away when the box has been measured.
    wait_until("a scene's results", || {
        assert!(
            running.try_wait().unwrap().is_none(),
            "it has ended already"
        );
        let text = fs::read_to_string(path("results.md")).unwrap_or_default();
        let json = fs::read(path("results.json")).unwrap_or_default();
        let json: Value = serde_json::from_slice(&json).unwrap_or_default();
        let rows = json["table1"]
            .as_array()
            .is_some_and(|rows| !rows.is_empty());
        rows && text.contains("cornell") && !text.contains("coarse")
    });
    running.kill().unwrap();
    running.wait().unwrap();
}

#[test]
fn converge_begins_with_nothing_and_ends_near_the_standard() {
    let more = [
        "--repeat",
        "1",
        "--limit",
        "60",
        "--passes",
        "16",
        "--walk-frames",
        "2",
    ];
    let written = json(bench(
        "converge",
        &[&more[..], &["--size", "128x96"]].concat(),
    ));
    let keys = "scene mode time_ms samples relative_rmse trusted_fraction";
    check_rows(&written["rows"], keys, &[]);
    check_summary(&written["summary"], &["paper", "trust"]);
    for mode in ["paper", "trust"] {
        let rows = written["rows"].as_array().unwrap();
        let rows: Vec<&Value> = rows.iter().filter(|row| row["mode"] == mode).collect();
        let (first, last) = (rows[0], rows[rows.len() - 1]);
        assert_eq!(
            (&first["time_ms"], &first["samples"]),
            (&0.0.into(), &0.into())
        );
        for pair in rows.windows(2) {
            for key in ["time_ms", "samples"] {
                assert!(pair[0][key].as_f64() < pair[1][key].as_f64(), "{key} rises");
            }
        }
        assert!(last["relative_rmse"].as_f64().unwrap() < 0.02, "{last}");
        // Nothing known is dark in the paper's mode, and traced with trust.
        let cold = first["relative_rmse"].as_f64().unwrap();
        assert_eq!(cold > 0.1, mode == "paper", "{first}");
    }
}

/// Checks the summary of one scene that has a walk, in these modes.
fn check_summary(summary: &Value, modes: &[&str]) {
    let keys = "scene mode standard_frame_ms converged_ms converged_standard_frames \
                first_frame_ms first_frame_relative_rmse last_frame_trusted_fraction \
                worst_walk_relative_rmse lie_bytes";
    check_rows(
        summary,
        keys,
        &["converged_ms", "converged_standard_frames"],
    );
    let summary = summary.as_array().unwrap();
    let names: Vec<&str> = summary
        .iter()
        .map(|line| line["mode"].as_str().unwrap())
        .collect();
    assert_eq!(names, modes);
    for line in summary {
        assert!(line["lie_bytes"].as_u64().unwrap() > 0);
        let [time, frame, frames] = [
            "converged_ms",
            "standard_frame_ms",
            "converged_standard_frames",
        ]
        .map(|key| line[key].as_f64());
        let ratio = time.map(|time| time / frame.unwrap());
        assert_eq!(ratio.is_some(), frames.is_some(), "{line}");
        assert!(
            (ratio.unwrap_or(0.0) - frames.unwrap_or(0.0)).abs() < 1.0e-6,
            "{line}"
        );
    }
}

#[test]
fn an_ablation_has_a_mode_without_each_piece() {
    let folder = tempfile::tempdir().unwrap();
    let more = [
        "--repeat",
        "1",
        "--passes",
        "2",
        "--walk-frames",
        "1",
        "--ablation",
    ];
    let mut all = bench("converge", &more);
    all.arg("--report").arg(folder.path());
    let written = json(all);
    let modes = [
        "paper",
        "trust",
        "no-proofs",
        "from-scratch",
        "no-crowd",
        "in-order",
    ];
    check_summary(&written["summary"], &modes);
    let number = |mode: &str, key: &str| {
        let lines = written["summary"].as_array().unwrap();
        let line = lines.iter().find(|line| line["mode"] == mode).unwrap();
        line[key].as_f64().unwrap()
    };
    for mode in &modes[1..] {
        // Nothing is known yet, so nothing is wrong.
        assert_eq!(number(mode, "first_frame_relative_rmse"), 0.0, "{mode}");
    }
    assert_ne!(
        number("no-proofs", "lie_bytes"),
        number("trust", "lie_bytes")
    );
    let samples = |mode: &str| {
        let mut rows = written["rows"].as_array().unwrap().iter();
        rows.rfind(|row| row["mode"] == mode).unwrap()["samples"].as_u64()
    };
    assert!(
        samples("in-order") > samples("trust"),
        "also where nothing is in doubt"
    );
    let report = folder.path().join("converge.md");
    let text = fs::read_to_string(&report).unwrap();
    check_links(&report, &text);
    for mode in modes {
        assert!(text.contains(&format!("ode *{mode}* ")), "{mode} in {text}");
        assert!(text.contains(&format!("| cornell | {mode} |")), "{text}");
    }
}

#[test]
fn modes_are_measured_in_the_order_in_which_they_are_named_and_once() {
    let more = [
        "--repeat",
        "1",
        "--passes",
        "1",
        "--walk-frames",
        "0",
        "--modes",
    ];
    let mut some = bench("converge", &more);
    some.arg("in-order,trust,in-order");
    let written = json(some);
    let lines = written["summary"].as_array().unwrap();
    let names: Vec<&Value> = lines.iter().map(|line| &line["mode"]).collect();
    assert_eq!(names, ["in-order", "trust"]);
}

#[test]
fn a_limit_ends_convergence_early() {
    let more = ["--repeat", "1", "--limit", "0.000001"];
    let written = json(bench("converge", &more));
    assert_eq!(
        written["rows"].as_array().unwrap().len(),
        2,
        "only the first frames"
    );
    for line in written["summary"].as_array().unwrap() {
        assert!(line["converged_ms"].is_null() && line["worst_walk_relative_rmse"].is_null());
        assert!(line["standard_frame_ms"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn a_report_has_tables_plots_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("docs/results.md");
    let mut report = bench(
        "report",
        &["--repeat", "1", "--passes", "2", "--limit", "10"],
    );
    succeeds(report.arg("--out").arg(&out));
    let text = fs::read_to_string(&out).unwrap();
    for part in [
        "Table 1",
        "Table 2",
        "Figure 4",
        "Convergence",
        "processor",
        "rustc",
        "lie bench report",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    check_links(&out, &text);
    let picture = lie_render::read_image(&out.with_extension("").join("cornell.png")).unwrap();
    assert_eq!(picture.size(), glam::UVec2::new(64, 48));

    let mut table = bench(
        "table1",
        &["--repeat", "1", "--passes", "1", "--threads", "1"],
    );
    succeeds(table.arg("--report").arg(folder.path()));
    let out = folder.path().join("table1.md");
    check_links(&out, &fs::read_to_string(&out).unwrap());
}

/// Every picture that a report shows is there.
fn check_links(report: &Path, text: &str) {
    let links: Vec<&str> = text
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .collect();
    assert!(links.len() > 1, "{text}");
    for link in links {
        let path = report.parent().unwrap().join(link);
        assert!(fs::metadata(&path).unwrap().len() > 0, "{}", path.display());
    }
}

#[test]
fn growth_makes_its_own_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = lie();
    bench.args(["bench", "growth", "--size", "32x32", "--repeat", "1"]);
    bench.args(["--threads", "1", "--axes", "lights,triangles"]);
    bench.args(["--lights", "10,40,10", "--triangles", "200k", "--report"]);
    bench.arg(folder.path());
    let written = json(bench);
    let keys = "integrator lights triangles build_ms frame_ms frame_ms_min frame_ms_max speedup \
                relative_rmse construct_ms visibility_ms traced_ms";
    check_rows(&written["rows"], keys, &[]);
    let rows = written["rows"].as_array().unwrap();
    let sizes: Vec<(&Value, &Value)> = rows
        .iter()
        .map(|row| (&row["grows"], &row["lights"]))
        .collect();
    let (lights, triangles) = (Value::from("lights"), Value::from("triangles"));
    let (ten, forty, hundred) = (10.into(), 40.into(), 100.into());
    assert_eq!(
        sizes,
        [
            (&lights, &ten),
            (&lights, &ten),
            (&lights, &forty),
            (&lights, &forty),
            (&triangles, &hundred),
            (&triangles, &hundred)
        ]
    );
    for row in rows.iter().filter(|row| row["integrator"] == "lie") {
        assert!(row["relative_rmse"].as_f64().unwrap() < 0.02, "{row}");
    }
    for name in ["growth-lights.svg", "growth-triangles.svg"] {
        assert!(folder.path().join("growth").join(name).exists(), "{name}");
    }
    for (option, value) in [
        ("--lights", "0"),
        ("--triangles", "17M"),
        ("--lights", "some"),
    ] {
        let mut bench = lie();
        let message = failure(bench.args(["bench", "growth", option, value]), 2);
        assert!(message.contains(value.trim_end_matches('M')), "{message}");
    }
}

#[test]
fn a_farm_renders_what_one_process_does() {
    let keys = "scene threads local_ms farm_ms ratio ratio_min ratio_max idle_ms render_ms pack_ms \
                rest_ms unpack_ms latency_ms pixel_bytes differing trusted_fraction";
    let common = ["--repeat", "2", "--samples", "20000", "--threads"];
    let half = json(bench("farm", &[&common[..], &["1,2"]].concat()));
    check_rows(&half["rows"], keys, &[]);
    let float = [&common[..], &["1", "--precision", "float", "--compress"]].concat();
    let float = json(bench("farm", &float));
    let rows = |written: &Value| written["rows"].as_array().unwrap().clone();
    let (half, float) = (rows(&half), rows(&float));
    assert_eq!((half.len(), float.len()), (2, 1));
    for row in half.iter().chain(&float) {
        assert_eq!(row["differing"], 0.0, "{row}");
        assert!(row["trusted_fraction"].as_f64().unwrap() > 0.0, "{row}");
        let time = |key: &str| row[key].as_f64().unwrap();
        assert!(time("ratio_min") <= time("ratio") && time("ratio") <= time("ratio_max"));
        assert!(time("render_ms") > 0.0 && time("latency_ms") <= time("farm_ms_max"));
    }
    assert_eq!(half[1]["threads"], 2);
    assert_eq!(half[0]["pixel_bytes"], 64 * 48 * 3 * 2);
    assert!(float[0]["pixel_bytes"].as_u64().unwrap() < 64 * 48 * 3 * 4);
}

#[test]
fn wrong_arguments_end_in_2_and_say_what_was_expected() {
    for (command, arguments, expected) in [
        ("table1", &["no/such/scene"][..], "no/such/scene"),
        ("table1", &["--camera", "nowhere"], "it has: front"),
        ("table1", &["--size", "64"], "WIDTHxHEIGHT"),
        ("table1", &["--size", "0x3"], "WIDTHxHEIGHT"),
        ("table1", &["--repeat", "0"], "--repeat"),
        ("table1", &["--threads", "1,x"], "--threads"),
        ("table1", &["--threads", "5000"], "5000 threads"),
        ("table1", &["--passes", "0"], "--passes"),
        (
            "table1",
            &["--passes", "1", "--samples", "1"],
            "cannot be used with",
        ),
        (
            "table1",
            &["scenes/cornell"],
            "another scene is called 'cornell'",
        ),
        ("table1", &["--max-passes", "0"], "--max-passes"),
        (
            "table2",
            &["--passes", "1", "--max-passes", "2"],
            "cannot be used with",
        ),
        ("figure4", &["--threads", "1,2"], "--threads"),
        ("figure4", &["--camera", "nowhere"], "it has: front"),
        ("table2", &["--repeat", "-1"], "-1"),
        ("table2", &["--accel", "kd"], "bvh, grid"),
        ("converge", &["--limit", "0"], "seconds"),
        ("converge", &["--limit", "inf"], "seconds"),
        ("converge", &["--walk-frames", "x"], "--walk-frames"),
        ("converge", &["--threads", "1,2"], "--threads"),
        ("converge", &["--modes", "trust,none"], "no-proofs"),
        ("converge", &["--modes", ""], "--modes"),
        (
            "converge",
            &["--ablation", "--modes", "trust"],
            "cannot be used with",
        ),
        ("farm", &["--repeat", "0"], "--repeat"),
        ("farm", &["--precision", "double"], "half, float"),
        ("farm", &["no/such/scene"], "no/such/scene"),
        ("report", &["--no-such-option"], "--no-such-option"),
        ("table3", &[], "table3"),
    ] {
        let message = failure(&mut bench(command, arguments), 2);
        assert!(
            message.contains(expected),
            "{command} {arguments:?}: {message}"
        );
    }
}

#[test]
fn where_nothing_can_be_written_nothing_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let mut table = bench("table1", &[]);
    table
        .arg("--json")
        .arg(folder.path().join("no/such/rows.json"));
    assert!(failure(&mut table, 1).contains("no/such"));
    let mut table = bench("table1", &[]);
    table.arg("--report").arg(&file);
    assert!(failure(&mut table, 1).contains("file"));
}

/// One camera, no walkthrough, and nothing that shines but what is there by default.
#[test]
fn a_bare_model_can_be_measured() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("floor.obj");
    fs::write(
        &model,
        "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n",
    )
    .unwrap();
    for command in ["table1", "converge"] {
        let mut bench = lie();
        bench.args(["bench", command]).arg(&model);
        bench.args(["--size", "16x16", "--repeat", "1", "--passes", "2"]);
        let written = json(bench);
        for row in written["rows"].as_array().unwrap() {
            assert_eq!(row["scene"], "floor");
            assert!(row["relative_rmse"].is_number(), "{row}");
        }
        for line in written["summary"].as_array().into_iter().flatten() {
            assert!(line["worst_walk_relative_rmse"].is_null(), "{line}");
        }
    }
}

/// Every picture is black, so that any error would be infinite.
#[test]
fn a_scene_that_no_light_reaches_can_be_measured() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("dark.toml");
    let text = "name = \"dark\"\n[[geometry]]\ngenerator = \"cornell-box\"\nkeep_lights = false\n\
                [[light]]\nkind = \"point\"\nposition = [0, 50, 0]\nradiant_intensity = [1, 1, 1]\n";
    fs::write(&scene, text).unwrap();
    let mut bench = lie();
    bench.args(["bench", "table1"]).arg(&scene);
    bench.args(["--size", "16x16", "--repeat", "1", "--passes", "1"]);
    let written = json(bench);
    for row in written["rows"].as_array().unwrap() {
        assert_eq!(row["relative_rmse"], 0.0, "{row}");
    }
}
