//! `--lies FILE`, as the real binary: a warm start goes on where the last run was.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use glam::UVec2;
use lie_farm::{
    client::{Client, ClientConfig},
    convert,
    network::Exposure,
};
use lie_protocol::LieStatus;
use serde_json::Value;
use support::{LONG, Process, cornell, failure, lie, succeeds};

/// A folder with a snapshot, pictures and statistics in it.
struct Home(tempfile::TempDir);

impl Home {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn lies(&self) -> PathBuf {
        self.path("a.lies")
    }

    fn command(&self, scene: &Path, more: &[&str]) -> Command {
        let mut command = lie();
        command.arg("render").arg(scene).args(["--size", "64x48"]);
        command.arg("--lies").arg(self.lies());
        command.arg("--out").arg(self.path("a.exr"));
        command.arg("--stats").arg(self.path("a.json")).args(more);
        command
    }

    /// Renders; gives the picture, what is told of the LIEs and what is logged.
    fn render(&self, more: &[&str]) -> (Vec<u8>, Value, String) {
        let output = self.command(&cornell(), more).output().unwrap();
        let log = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{log}");
        let stats: Value = serde_json::from_slice(&fs::read(self.path("a.json")).unwrap()).unwrap();
        let picture = fs::read(self.path("a.exr")).unwrap();
        (picture, stats["lie"].clone(), log)
    }
}

#[test]
fn a_warm_start_takes_no_samples_and_gives_the_same_picture() {
    let home = Home::new();
    let (cold_picture, cold, log) = home.render(&[]);
    assert_eq!((&cold["converged"], log.as_str()), (&true.into(), ""));
    assert!(cold["taken"].as_u64().unwrap() > 0, "{cold}");
    let saved = fs::read(home.lies()).unwrap();
    let (picture, warm, log) = home.render(&[]);
    assert_eq!((warm["taken"].as_u64(), log.as_str()), (Some(0), ""));
    assert!(picture == cold_picture, "the pictures differ");
    for key in [
        "converged",
        "samples",
        "version",
        "cells",
        "bytes",
        "estimated_error",
    ] {
        assert_eq!(warm[key], cold[key], "{key}");
    }
    assert!(
        fs::read(home.lies()).unwrap() == saved,
        "nothing was to be saved"
    );

    // Exactly so many samples more, whatever had converged.
    let (_, more, _) = home.render(&["--samples", "3072"]);
    assert!(more["taken"].as_u64().unwrap() >= 3072, "{more}");
    assert!(more["samples"].as_u64() > warm["samples"].as_u64());
    let (_, none, _) = home.render(&["--samples", "0"]);
    assert_eq!(
        (&none["taken"], &none["samples"]),
        (&0.into(), &more["samples"])
    );
}

#[test]
fn a_snapshot_that_cannot_be_used_is_one_line_and_a_cold_start() {
    let home = Home::new();
    let (cold, _, _) = home.render(&[]);
    let saved = fs::read(home.lies()).unwrap();
    let mut flipped = saved.clone();
    flipped[saved.len() / 2] ^= 4;
    let mut newer = saved.clone();
    newer[8] += 1;
    for (bytes, reason) in [
        (&saved[..saved.len() / 2], "bytes and has"),
        (&saved[..20], "bytes and has"),
        (&flipped, "damaged"),
        (&newer, "format"),
    ] {
        fs::write(home.lies(), bytes).unwrap();
        let (picture, stats, log) = home.render(&[]);
        assert!(log.contains(reason) && log.contains("a.lies"), "{log}");
        assert_eq!(log.lines().count(), 1, "{log}");
        assert!(stats["taken"].as_u64().unwrap() > 0, "{stats}");
        assert!(picture == cold, "the pictures differ");
        assert!(
            fs::read(home.lies()).unwrap() == saved,
            "it was not replaced"
        );
    }
    let (_, stats, log) = home.render(&["--trust", "64"]);
    assert!(log.contains("trust of 512, not 64"), "{log}");
    assert!(stats["taken"].as_u64().unwrap() > 0, "{stats}");
    // The same room, under another name.
    let scene = home.path("other.toml");
    fs::write(
        &scene,
        "name = \"other\"\n[[geometry]]\ngenerator = \"cornell-box\"\n",
    )
    .unwrap();
    let output = home.command(&scene, &[]).output().unwrap();
    let log = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.success() && log.contains("another scene"),
        "{log}"
    );
}

#[test]
fn what_is_no_snapshot_is_left_as_it_is() {
    let home = Home::new();
    fs::write(home.lies(), "precious").unwrap();
    let scene = cornell();
    for command in ["render", "constructor", "run"] {
        let mut command = match command {
            "render" => home.command(&scene, &[]),
            name => {
                let mut command = lie();
                command.arg(name).arg(&scene).arg("--lies").arg(home.lies());
                command
            }
        };
        let message = failure(&mut command, 2);
        assert!(
            message.contains("a.lies") && message.contains("no snapshot"),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    assert_eq!(fs::read_to_string(home.lies()).unwrap(), "precious");
    assert!(!home.path("a.exr").exists());
}

/// Looks through the first camera until that has converged; tells what the constructor then says.
async fn settle(constructor: &Process) -> LieStatus {
    let config = ClientConfig::new(&constructor.address, Exposure::Loopback);
    let client = Client::connect(config).await.unwrap();
    let camera = convert::camera(&client.scene().cameras[0]).unwrap();
    let serial = client.set_camera(&camera, UVec2::new(64, 48));
    assert!(client.settled(serial, LONG).await, "it has not converged");
    *client.status().borrow()
}

#[tokio::test]
async fn a_constructor_saves_at_its_end_and_starts_warm() {
    let home = Home::new();
    let lies = home.lies().to_str().unwrap().to_owned();
    let first = Process::constructor(&["--lies", &lies]);
    let cold = settle(&first).await;
    assert!(cold.samples > 0, "{cold:?}");
    assert!(first.end().success());
    let saved = fs::read(home.lies()).unwrap();

    let mut second = Process::constructor(&["--lies", &lies]);
    let warm = settle(&second).await;
    assert_eq!((warm.samples, warm.version), (cold.samples, cold.version));
    assert_eq!(warm.estimated_error, cold.estimated_error);
    // Killed, it leaves what was there.
    second.kill();
    assert!(fs::read(home.lies()).unwrap() == saved);

    // Frozen LIEs come from the same file; there the view is another one, of another size.
    let frozen = ["--freeze", "--freeze-size", "32x32", "--lies", &lies];
    let third = Process::constructor(&frozen);
    assert!(!third.log().contains("WARN"), "{}", third.log());
    assert!(
        fs::read(home.lies()).unwrap() != saved,
        "it was saved at once"
    );
}

#[test]
fn a_whole_farm_starts_warm() {
    let home = Home::new();
    let run = || {
        let mut run = lie();
        run.arg("run").arg(cornell()).arg("--lies").arg(home.lies());
        run.args([
            "--shaders",
            "1",
            "--frames",
            "2",
            "--size",
            "64x48",
            "--settle",
        ]);
        run.arg("--stats").arg(home.path("run.json"));
        succeeds(&mut run);
        let stats = fs::read(home.path("run.json")).unwrap();
        let stats: Value = serde_json::from_slice(&stats).unwrap();
        let version = stats["frames"][1]["lie_version"].as_u64().unwrap();
        (version, fs::read(home.lies()).unwrap())
    };
    let (cold_version, saved) = run();
    let (warm_version, again) = run();
    assert_eq!(warm_version, cold_version);
    assert!(again == saved, "nothing was to be saved");
}
