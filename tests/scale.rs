//! Simulated shaders, which nobody may take for real ones; frames that are given up; and the measurements
//! of both.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use glam::UVec2;
use lie_farm::{
    client::{Client, ClientConfig, FrameRequest},
    convert,
    network::Exposure,
    steer::{Input, SteerConfig, steer},
};
use lie_protocol::{Compression, PixelFormat, WireIntegrator};
use support::{
    LONG, Process,
    bench::{bench, check_rows, json},
    cornell, failure, lie, succeeds,
};
use tokio::sync::watch;

/// A recording of 64 x 48 pixels of the Cornell box.
fn recording(folder: &Path) -> PathBuf {
    let path = folder.join("tiles.json");
    let mut record = bench("scale", &["--repeat", "1", "--samples", "2000"]);
    succeeds(record.arg("--record").arg(&path));
    path
}

async fn connect(constructor: &Process, replays: bool) -> Client {
    let config = ClientConfig {
        replays,
        ..ClientConfig::new(&constructor.address, Exposure::Loopback)
    };
    Client::connect(config).await.unwrap()
}

fn request(client: &Client, samples_per_pixel: u32) -> FrameRequest {
    FrameRequest {
        camera: convert::camera(&client.scene().cameras[0]).unwrap(),
        size: UVec2::new(64, 48),
        samples_per_pixel,
        light_samples: 16,
        integrator: WireIntegrator::Standard,
        seed: 7,
        format: PixelFormat::F32,
        compression: Compression::None,
    }
}

#[tokio::test]
async fn replays_and_shaders_serve_those_alone_that_asked_for_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path());
    let constructor = Process::constructor(&["--replays"]);
    let arguments = ["shader", "--constructor", &constructor.address, "--count"];
    let replay = ["3", "--slow-down", "2", "--replay", path.to_str().unwrap()];
    let _replays = Process::start(&[&arguments[..], &replay[..]].concat());
    let shader = Process::shader(&constructor.address);

    let mut of_pictures = connect(&constructor, false).await;
    let mut of_replays = connect(&constructor, true).await;
    let gathered = async {
        of_pictures.wait_for_shaders(1).await;
        of_replays.wait_for_shaders(3).await;
    };
    tokio::time::timeout(LONG, gathered).await.unwrap();
    let request = request(&of_pictures, 1);
    let picture = of_pictures.render_frame(&request).await.unwrap();
    let replayed = of_replays.render_frame(&request).await.unwrap();
    assert_eq!((of_pictures.shaders(), of_replays.shaders()), (1, 3));
    assert_eq!(picture.stats.shaders[0].address, shader.address);
    assert!(replayed.film != picture.film);
    // 24 tiles for each thread are more than there are: the smallest.
    assert_eq!(replayed.stats.tiles, 12);
    assert!(replayed.stats.render_ms > 0.0);
    let shares: u64 = replayed.stats.shaders.iter().map(|share| share.tiles).sum();
    assert_eq!(shares, 12);

    let mut status = lie();
    status.args(["status", "--constructor", &constructor.address]);
    let text = String::from_utf8(status.output().unwrap().stdout).unwrap();
    assert_eq!(text.matches("replays, ready").count(), 3, "{text}");
}

#[test]
fn a_constructor_that_was_not_told_of_a_simulation_refuses_replays() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path());
    let constructor = Process::constructor(&[]);
    let mut replay = lie();
    replay.args(["shader", "--constructor", &constructor.address, "--replay"]);
    let error = failure(replay.arg(&path), 1);
    assert!(error.contains("takes no replays"), "{error}");

    let text = fs::read_to_string(&path).unwrap();
    let at = text.find("\"hash\": \"").unwrap() + 9;
    let digit = if &text[at..=at] == "0" { "1" } else { "0" };
    let other = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
    fs::write(&path, other).unwrap();
    let constructor = Process::constructor(&["--replays"]);
    let mut replay = lie();
    replay.args(["shader", "--constructor", &constructor.address, "--replay"]);
    let error = failure(replay.arg(&path), 1);
    assert!(error.contains("the recording is of"), "{error}");
}

#[test]
fn broken_recordings_and_arguments_end_in_one_clear_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.json");
    let shader = |arguments: &[&str]| {
        let mut shader = lie();
        shader.args(["shader", "--constructor", "127.0.0.1:1"]);
        failure(shader.args(arguments), 2)
    };
    let name = path.to_str().unwrap();
    assert!(shader(&["--replay", name]).contains("broken.json"));
    for (text, part) in [
        ("{\n\"cuts\": 3}", "line 2 column"),
        ("", "line 1 column 0"),
        ("{\"format\": 1,\n \"side\": 2}", "unknown field `side`"),
    ] {
        fs::write(&path, text).unwrap();
        let error = shader(&["--replay", name]);
        assert!(error.contains("broken.json"), "{error}");
        assert!(error.contains(part), "{part} in {error}");
        let mut scale = bench("scale", &["--replay", name]);
        assert!(failure(&mut scale, 2).contains(part));
    }
    for wrong in [
        &["--count", "2"][..],
        &["--slow-down", "2"],
        &["--replay", name, "--threads", "2"],
        &["--replay", name, "--count", "0"],
        &["--replay", name, "--slow-down", "0"],
    ] {
        shader(wrong);
    }
    for wrong in [
        &["--slow-down", "1,2", "--shaders", "1"][..],
        &["--replay", name, "--record", name],
    ] {
        failure(&mut bench("scale", wrong), 2);
    }
}

#[tokio::test]
async fn shaders_stop_when_a_frame_is_given_up() {
    let constructor = Process::constructor(&[]);
    let _shader = Process::shader(&constructor.address);
    let mut client = connect(&constructor, false).await;
    client.wait_for_shaders(1).await;
    let quick = request(&client, 1);
    client.render_frame(&quick).await.unwrap();
    // Minutes of work in every tile.
    let long = FrameRequest {
        samples_per_pixel: 1 << 16,
        ..quick.clone()
    };
    let begun = Duration::from_millis(200);
    for _ in 0..3 {
        let ended = tokio::time::timeout(begun, client.render_frame(&long)).await;
        assert!(ended.is_err());
    }
    let clock = Instant::now();
    let frame = client.render_frame(&quick).await.unwrap();
    assert!(clock.elapsed() < Duration::from_secs(20));
    assert_eq!(frame.stats.lost_tiles, 0);

    // Nobody asks for another frame: the shader has nothing to do all the same.
    let ended = tokio::time::timeout(begun, client.render_frame(&long)).await;
    assert!(ended.is_err());
    let is_idle = || {
        let mut status = lie();
        status.args(["status", "--json", "--constructor", &constructor.address]);
        let output = status.output().unwrap().stdout;
        let status: serde_json::Value = serde_json::from_slice(&output).unwrap();
        let shader = &status["shaders"][0];
        shader["clients"] == 1 && shader["outstanding_tiles"] == 0
    };
    // The report of a shader is up to a second old: two in a row.
    tokio::time::sleep(Duration::from_millis(1500)).await;
    support::wait_until("the shader stops", is_idle);
}

#[tokio::test]
async fn of_what_is_put_in_only_the_newest_is_asked_for() {
    let constructor = Process::constructor(&[]);
    let _shader = Process::shader(&constructor.address);
    let mut client = connect(&constructor, false).await;
    client.wait_for_shaders(1).await;
    let config = SteerConfig {
        frame: request(&client, 4),
        patience: None,
    };
    let camera = config.frame.camera.clone();
    let (inputs, newest) = watch::channel(None);
    let moved = move |number: u16| {
        let mut camera = camera.clone();
        camera.eye.x += f32::from(number) * 1.0e-4;
        let at = Instant::now();
        Some(Input { camera, at })
    };
    const INPUTS: u16 = 1000;
    let last = moved(INPUTS - 1).unwrap().camera;
    let hand = tokio::spawn(async move {
        for number in 0..INPUTS {
            inputs.send_replace(moved(number));
            tokio::time::sleep(Duration::from_micros(100)).await;
        }
    });
    let mut shown = vec![];
    let steered = steer(&mut client, newest, &config, |steered| {
        shown.push(steered.input.camera.eye.x);
        if shown.len() == 1 {
            // Whoever shows a picture may take some time.
            std::thread::sleep(Duration::from_millis(50));
        }
    });
    tokio::time::timeout(LONG, steered).await.unwrap().unwrap();
    hand.await.unwrap();
    assert!(
        shown.len() < usize::from(INPUTS) / 2,
        "{} frames",
        shown.len()
    );
    assert!(shown.windows(2).all(|pair| pair[0] < pair[1]), "in order");
    assert_eq!(shown.last(), Some(&last.eye.x), "the last is shown");

    // Who has no patience at all still gets pictures: every second frame is finished.
    let (inputs, newest) = watch::channel(None);
    let config = SteerConfig {
        frame: request(&client, 64),
        patience: Some(Duration::ZERO),
    };
    let camera = config.frame.camera.clone();
    let hand = tokio::spawn(async move {
        let end = Instant::now() + Duration::from_secs(2);
        while Instant::now() < end {
            let at = Instant::now();
            let camera = camera.clone();
            inputs.send_replace(Some(Input { camera, at }));
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    });
    let mut given_up = vec![];
    let steered = steer(&mut client, newest, &config, |steered| {
        given_up.push(steered.given_up);
    });
    tokio::time::timeout(LONG, steered).await.unwrap().unwrap();
    hand.await.unwrap();
    assert!(given_up.iter().all(|&count| count <= 1));
    assert!(given_up.contains(&1), "{given_up:?}");
}

#[test]
fn scale_says_what_it_has_simulated() {
    let arguments = ["--shaders", "1,4", "--frames", "2", "--seconds", "0.1"];
    let more = ["--repeat", "1", "--samples", "2000"];
    let report = tempfile::tempdir().unwrap();
    let into = report.path().join("results.md");
    let mut scale = bench("scale", &[&arguments[..], &more[..]].concat());
    scale.arg("--into").arg(&into);
    let rows = json(scale);
    let keys = "shaders efficiency frame_ms constructor_bytes_per_s slow_down tiles tiles_per_s";
    check_rows(&rows["rows"], keys, &[]);
    for row in rows["rows"].as_array().unwrap() {
        assert_eq!(row["simulated"], true);
        assert!(row["efficiency"].as_f64().unwrap() > 0.0);
        assert!(row["efficiency"].as_f64().unwrap() < 1.05, "{row}");
        assert!(row["learning"]["constructor_bytes_per_s"].as_f64().unwrap() > 0.0);
    }
    let text = fs::read_to_string(into).unwrap();
    assert!(text.contains("Simulated"), "{text}");
    let mut two = lie();
    two.args(["bench", "scale"]).arg(cornell()).arg(cornell());
    failure(&mut two, 2);
}

#[test]
fn latency_has_every_stage_with_and_without_delay() {
    let arguments = ["--delay", "0,5", "--pictures", "8", "--stops", "3"];
    let more = ["--samples", "2000", "--patience", "20"];
    let rows = json(bench("latency", &[&arguments[..], &more[..]].concat()));
    let of = |stage: &str, delay: f64| {
        let rows = rows["rows"].as_array().unwrap();
        let mut found = rows
            .iter()
            .filter(|row| row["stage"] == stage && row["delay_ms"] == delay);
        let row = found.next().unwrap_or_else(|| panic!("{stage}"));
        let at = ["p50_ms", "p95_ms", "p99_ms"].map(|key| row[key].as_f64().unwrap());
        assert!(at[0] <= at[1] && at[1] <= at[2], "{row}");
        at[0]
    };
    for delay in [0.0, 5.0] {
        let stages = [
            "camera out",
            "first tile",
            "last tile",
            "assembled",
            "shown",
        ];
        let times = stages.map(|stage| of(stage, delay));
        assert!(times.windows(2).all(|pair| pair[0] <= pair[1]), "{times:?}");
        of("stale work stopped", delay);
    }
    // There and back.
    assert!(of("first tile", 5.0) - of("camera out", 5.0) >= 10.0);
}
