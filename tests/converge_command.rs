//! `lie bench converge`, as the real binary.

#![allow(clippy::unwrap_used)]

mod support;

use std::fs;

use serde_json::Value;
use support::bench::{bench, check_links, check_rows, json};

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
