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
    client::{Client, ClientConfig, FrameRequest},
    convert,
    network::Exposure,
};
use lie_protocol::{Compression, PixelFormat, WireIntegrator};
use serde_json::Value;
use support::{Process, cornell, failure, lie, wait_until};

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
        let stats: Value =
            serde_json::from_slice(&fs::read(self.path("a.json")).unwrap()).unwrap();
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
    for key in ["converged", "samples", "version", "cells", "bytes", "estimated_error"] {
        assert_eq!(warm[key], cold[key], "{key}");
    }
    assert!(fs::read(home.lies()).unwrap() == saved, "nothing was to be saved");

    // Exactly so many samples more, whatever had converged.
    let (_, more, _) = home.render(&["--samples", "3072"]);
    assert!(more["taken"].as_u64().unwrap() >= 3072, "{more}");
    assert!(more["samples"].as_u64() > warm["samples"].as_u64());
    let (_, none, _) = home.render(&["--samples", "0"]);
    assert_eq!((&none["taken"], &none["samples"]), (&0.into(), &more["samples"]));
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
        assert!(fs::read(home.lies()).unwrap() == saved, "it was not replaced");
    }
    let (_, stats, log) = home.render(&["--trust", "64"]);
    assert!(log.contains("trust of 512, not 64"), "{log}");
    assert!(stats["taken"].as_u64().unwrap() > 0, "{stats}");
    // The same room, under another name.
    let scene = home.path("other.toml");
    fs::write(&scene, "name = \"other\"\n[[geometry]]\ngenerator = \"cornell-box\"\n").unwrap();
    let output = home.command(&scene, &[]).output().unwrap();
    let log = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && log.contains("another scene"), "{log}");
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
        assert!(message.contains("a.lies") && message.contains("no snapshot"), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    assert_eq!(fs::read_to_string(home.lies()).unwrap(), "precious");
    assert!(!home.path("a.exr").exists());
}

/// A frame of the first camera, once that has converged.
async fn converged_frame(constructor: &Process) -> lie_farm::client::Frame {
    let config = ClientConfig::new(&constructor.address, Exposure::Loopback);
    let mut client = Client::connect(config).await.unwrap();
    client.wait_for_shaders(1).await;
    let request = FrameRequest {
        camera: convert::camera(&client.scene().cameras[0]).unwrap(),
        size: UVec2::new(64, 48),
        samples_per_pixel: 1,
        light_samples: 4,
        integrator: WireIntegrator::Lie,
        seed: 7,
        format: PixelFormat::F32,
        compression: Compression::None,
    };
    client.render_frame(&request).await.unwrap();
    client.settle(support::LONG).await;
    client.render_frame(&request).await.unwrap()
}
