//! Logs for machines.

use std::process::{Output, Stdio};

use serde_json::Value;

use crate::{
    support::{self, Process},
    view,
};

/// Every line of a log, which must be an object.
fn json_lines(log: &str) -> Vec<Value> {
    let lines = log.lines().map(|line| {
        let value: Value = serde_json::from_str(line).unwrap_or_else(|_| panic!("{line}"));
        assert!(
            value["level"].is_string() && value["message"].is_string(),
            "{line}"
        );
        value
    });
    lines.collect()
}

/// The frames that lines of a log belong to, as view and number.
fn frames(log: &str) -> Vec<(u64, u64)> {
    let lines = json_lines(log);
    let spans = lines.iter().map(|line| &line["span"]);
    let frames = spans.filter(|span| span["name"] == "frame");
    frames
        .map(|span| {
            let number = |key: &str| span[key].as_u64().unwrap();
            (number("view"), number("frame"))
        })
        .collect()
}

#[test]
fn a_frame_is_followed_through_the_logs_of_all_processes() {
    let json = ["--log-format", "json", "--log", "debug"];
    let constructor = Process::start_with(
        &[
            &["constructor", support::cornell().to_str().unwrap()][..],
            &["--threads", "1", "--listen", "127.0.0.1:0"],
        ]
        .concat(),
        &json,
    );
    let shader = Process::start_with(
        &[
            "shader",
            "--constructor",
            &constructor.address,
            "--threads",
            "1",
            "--no-cache",
        ],
        &json,
    );
    let Output { status, stderr, .. } = view(&constructor, "2", "1").args(json).output().unwrap();
    assert!(status.success());
    let of_client = frames(&String::from_utf8(stderr).unwrap());
    let of_shader = frames(&shader.log());
    let &(id, _) = of_client.first().unwrap();
    for number in [1, 2] {
        assert!(of_client.contains(&(id, number)), "{of_client:?}");
        assert!(of_shader.contains(&(id, number)), "{of_shader:?}");
    }
    let looks = json_lines(&constructor.log());
    let look = looks.iter().find(|line| line["view"] == id);
    assert!(look.unwrap()["camera"].is_number());
}

#[test]
fn a_run_logs_json_of_all_its_processes_to_its_last_line() {
    let mut run = support::lie();
    run.arg("run").arg(support::cornell());
    run.args(["--shaders", "2", "--frames", "2", "--size", "64x48"]);
    run.args(["--log-format", "json", "--log", "info"]);
    let Output { status, stderr, .. } = run.stdout(Stdio::null()).output().unwrap();
    assert!(status.success());
    let log = json_lines(&String::from_utf8(stderr).unwrap());
    for who in ["constructor", "shader 1", "shader 2"] {
        assert!(log.iter().any(|line| line["process"] == who), "{who}");
    }
    let mut failing = support::lie();
    failing.args([
        "status",
        "--constructor",
        "127.0.0.1:1",
        "--log-format",
        "json",
    ]);
    let message = support::failure(&mut failing, 1);
    let lines = json_lines(&message);
    assert_eq!(lines.last().unwrap()["exit_code"], 1, "{message}");
}
