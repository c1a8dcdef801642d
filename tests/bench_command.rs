//! `lie bench`, as the real binary.

#![allow(clippy::unwrap_used)]

mod support;

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;
use support::{
    bench::{bench, check_links, check_rows, json},
    failure, lie, succeeds, wait_until,
};

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
fn a_report_has_tables_plots_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("docs/results.md");
    let mut report = bench(
        "report",
        &["--repeat", "1", "--passes", "2", "--limit", "10"],
    );
    fs::create_dir_all(out.parent().unwrap()).unwrap();
    let growth = "## Growth with lights and triangles\n\nMeasured elsewhere.\n";
    fs::write(&out, format!("# Old\n\n{growth}\n## Old\n")).unwrap();
    let rows = folder.path().join("rows.json");
    succeeds(report.arg("--out").arg(&out).arg("--json").arg(&rows));
    let rows: Value = serde_json::from_slice(&fs::read(&rows).unwrap()).unwrap();
    let keys = "scene threads lights triangles build_ms build_ms_min build_ms_max accel_bytes";
    check_rows(&rows["builds"], keys, &[]);
    let text = fs::read_to_string(&out).unwrap();
    assert!(text.ends_with(growth) && !text.contains("Old"), "{text}");
    for part in [
        "acceleration structure",
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

#[test]
fn growth_makes_its_own_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = lie();
    bench.args(["bench", "growth", "--size", "32x32", "--repeat", "1"]);
    bench.args(["--threads", "1", "--axes", "lights,triangles"]);
    bench.args(["--lights", "10,40,10", "--triangles", "200k", "--report"]);
    bench.arg(folder.path());
    let results = folder.path().join("results.md");
    fs::write(
        &results,
        "# Results\n\n## Growth with lights and triangles\n\nOld.\n\n## More\n",
    )
    .unwrap();
    bench.arg("--into").arg(&results);
    let written = json(bench);
    let keys = "integrator lights triangles build_ms frame_ms frame_ms_min frame_ms_max speedup \
                relative_rmse construct_ms visibility_ms traced_ms accel_build_ms accel_bytes";
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
    let text = fs::read_to_string(&results).unwrap();
    check_links(&results, &text);
    for part in [
        "growth-triangles.svg",
        "Measured by `lie bench growth",
        "## More",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert!(!text.contains("Old."), "{text}");
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
