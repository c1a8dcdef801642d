//! Constructors, shaders and clients as real processes over real sockets, and what becomes
//! of a frame when they die, hang, come late or talk nonsense.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::{
    io::{Read, Write},
    net::{TcpListener, TcpStream},
    path::Path,
    sync::Arc,
    time::Duration,
};

use glam::UVec2;
use lie_farm::{
    Builder, ConstructSettings, LieReplica, View,
    client::{Client, ClientConfig, Frame, FrameRequest},
    convert,
    network::Exposure,
};
use lie_protocol::{Compression, Decoder, Header, Opening, PixelFormat, WireIntegrator};
use lie_render::{FrameSettings, World, render_frame};
use support::{LONG, Process};
use tokio::time::sleep;

async fn connect(constructor: &Process) -> Client {
    let config = ClientConfig::new(&constructor.address, Exposure::Loopback);
    Client::connect(config).await.unwrap()
}

/// A frame of the first camera; with more samples it takes longer.
fn request(client: &Client, samples_per_pixel: u32) -> FrameRequest {
    FrameRequest {
        camera: convert::camera(&client.scene().cameras[0]).unwrap(),
        size: UVec2::new(160, 120),
        samples_per_pixel,
        light_samples: 16,
        integrator: WireIntegrator::Standard,
        seed: 7,
        format: PixelFormat::F32,
        compression: Compression::Lz4,
    }
}

/// Renders a frame of a second or more, and does something when it is under way.
async fn render_while(client: &mut Client, during: impl AsyncFnOnce()) -> Frame {
    let request = request(client, 160);
    let meanwhile = async {
        sleep(Duration::from_millis(200)).await;
        during().await;
    };
    let (frame, ()) = tokio::join!(client.render_frame(&request), meanwhile);
    frame.unwrap()
}

#[tokio::test]
async fn a_shader_killed_within_a_frame_costs_time_and_nothing_else() {
    let constructor = Process::constructor(&[]);
    let mut first = Process::shader(&constructor.address);
    let _second = Process::shader(&constructor.address);
    let mut client = connect(&constructor).await;
    client.wait_for_shaders(2).await;
    let disturbed = render_while(&mut client, async || first.kill()).await;
    assert!(disturbed.stats.lost_tiles > 0, "{:?}", disturbed.stats);
    let quiet = render_while(&mut client, async || ()).await;
    assert!(disturbed.film == quiet.film, "the pictures differ");
    assert_eq!(quiet.stats.lost_tiles, 0);
    assert_eq!(client.shaders(), 1);
}

#[tokio::test]
async fn a_shader_that_hangs_is_worked_around() {
    let constructor = Process::constructor(&[]);
    let first = Process::shader(&constructor.address);
    let _second = Process::shader(&constructor.address);
    let mut client = connect(&constructor).await;
    client.wait_for_shaders(2).await;
    let disturbed = render_while(&mut client, async || first.stop()).await;
    let rescued = disturbed.stats.reissued_tiles + disturbed.stats.lost_tiles;
    assert!(rescued > 0, "{:?}", disturbed.stats);
    let quiet = render_while(&mut client, async || ()).await;
    assert!(disturbed.film == quiet.film, "the pictures differ");
}

#[tokio::test]
async fn shaders_that_come_late_are_used_within_the_frame() {
    let constructor = Process::constructor(&[]);
    let mut client = connect(&constructor).await;
    // The frame is begun before there is anybody; then one comes, then another.
    let mut shaders = Vec::new();
    let frame = render_while(&mut client, async || {
        shaders.push(Process::shader(&constructor.address));
        sleep(Duration::from_millis(300)).await;
        shaders.push(Process::shader(&constructor.address));
    })
    .await;
    let tiles: Vec<u64> = frame.stats.shaders.iter().map(|s| s.tiles).collect();
    assert!(
        tiles.len() == 2 && tiles.iter().all(|&tiles| tiles > 0),
        "{tiles:?}"
    );
}

#[tokio::test]
async fn pictures_go_on_without_the_constructor_and_it_may_come_back() {
    let mut constructor = Process::constructor(&[]);
    let address = constructor.address.clone();
    let shader = Process::shader(&address);
    let mut client = connect(&constructor).await;
    client.wait_for_shaders(1).await;
    constructor.kill();
    let request = FrameRequest {
        integrator: WireIntegrator::Lie,
        ..request(&client, 1)
    };
    let frame = client.render_frame(&request).await.unwrap();
    assert_eq!(frame.stats.lost_tiles, 0);

    let _constructor = Process::constructor(&["--listen", &address]);
    let serial = client.set_camera(&request.camera, request.size);
    assert!(client.settled(serial, LONG).await);
    support::wait_until("the shader is back", || {
        shader.log().matches("the constructor's shader").count() == 2
    });
    let mut version = 0;
    for _ in 0..200 {
        let frame = client.render_frame(&request).await.unwrap();
        version = frame.stats.lie_version;
        if version > 0 {
            break;
        }
        sleep(Duration::from_millis(50)).await;
    }
    assert!(version > 0, "the new constructor's LIEs are not used");
}

#[tokio::test]
async fn another_version_and_garbage_are_refused_and_disturb_nobody() {
    let constructor = Process::constructor(&[]);
    let _shader = Process::shader(&constructor.address);

    let mut future = TcpStream::connect(&constructor.address).unwrap();
    let body = [99, 0, 1, 1, 0, 0, 0, 0, 0, 3, 0, b'v', b'9', b'9'];
    let header = Header {
        version: 99,
        kind: 1,
        length: body.len() as u32,
    };
    future.write_all(&header.to_bytes()).unwrap();
    future.write_all(&body).unwrap();
    let mut answer = Vec::new();
    future.read_to_end(&mut answer).unwrap();
    let mut decoder = Decoder::default();
    decoder.push(&answer);
    let Some(Opening::Refuse(refusal)) = decoder.next().unwrap() else {
        panic!("{answer:?}");
    };
    let ours = format!("version {}", lie_protocol::PROTOCOL_VERSION);
    for part in ["version 99", "v99", &ours] {
        assert!(refusal.reason.as_str().contains(part), "{refusal:?}");
    }

    let mut nonsense = TcpStream::connect(&constructor.address).unwrap();
    let from = nonsense.local_addr().unwrap().to_string();
    nonsense.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
    let mut end = Vec::new();
    // It may also be reset, since the rest of what we sent was never read.
    let _ = nonsense.read_to_end(&mut end);
    assert!(end.is_empty());
    support::wait_until("the log names the peer", || {
        constructor.log().lines().any(|line| line.contains(&from))
    });

    // One that says nothing keeps nobody from work.
    let _silent = TcpStream::connect(&constructor.address).unwrap();
    let mut client = connect(&constructor).await;
    let request = request(&client, 1);
    client.render_frame(&request).await.unwrap();
    assert!(constructor.end().success());
}

#[test]
fn wrong_addresses_end_in_one_clear_line() {
    let scene = support::cornell();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    let mut constructor = support::lie();
    let in_use = constructor
        .arg("constructor")
        .arg(&scene)
        .args(["--listen", &address]);
    let in_use = support::failure(in_use, 1);
    assert!(
        in_use.starts_with(&format!("error: cannot listen on {address}: ")),
        "{in_use}"
    );
    assert_eq!(in_use.lines().count(), 1, "{in_use}");

    let mut constructor = support::lie();
    let outside = constructor
        .arg("constructor")
        .arg(&scene)
        .args(["--listen", "0.0.0.0:0"]);
    let outside = support::failure(outside, 2);
    assert!(outside.contains("--insecure"), "{outside}");

    for wrong in ["nowhere", "127.0.0.1:", "127.0.0.1:70000"] {
        let message = support::failure(support::lie().args(["shader", "--constructor", wrong]), 2);
        assert!(message.contains("HOST:PORT"), "{message}");
    }
    let missing = support::failure(support::lie().args(["run", "no/such/scene"]), 2);
    assert!(missing.contains("no/such/scene"), "{missing}");
}

#[test]
fn no_child_outlives_its_parent() {
    let mut parent = support::lie();
    parent.arg("run").arg(support::cornell());
    parent.args(["--shaders", "2", "--frames", "1000000", "--size", "64x64"]);
    let mut parent = parent.spawn().unwrap();
    let mut children = Vec::new();
    support::wait_until("three children run", || {
        children = support::children_of(parent.id());
        children.len() == 3
    });
    parent.kill().unwrap();
    parent.wait().unwrap();
    support::wait_until("the children have ended", || {
        !children.iter().any(|&child| support::runs(child))
    });
}

#[test]
fn a_shader_that_dies_before_the_first_frame_is_not_waited_for() {
    let mut parent = support::lie();
    parent.arg("run").arg(support::cornell());
    parent.args(["--shaders", "2", "--frames", "100", "--size", "64x64"]);
    let mut parent = parent
        .stderr(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let mut children = Vec::new();
    support::wait_until("three children run", || {
        children = support::children_of(parent.id());
        children.len() == 3
    });
    // The second is only started when the first has said where it listens.
    children.sort_unstable();
    support::signal("-KILL", children[1]);
    let mut status = None;
    support::wait_until("the run has ended", || {
        status = parent.try_wait().unwrap();
        status.is_some()
    });
    assert!(status.unwrap().success());
}

#[test]
fn an_interrupted_run_ends_its_children() {
    let mut parent = support::lie();
    parent.arg("run").arg(support::cornell());
    parent.args(["--shaders", "2", "--frames", "1000000", "--size", "64x64"]);
    let mut parent = parent.stderr(std::process::Stdio::null()).spawn().unwrap();
    let mut children = Vec::new();
    support::wait_until("three children run", || {
        children = support::children_of(parent.id());
        children.len() == 3
    });
    support::signal("-INT", parent.id());
    assert_eq!(parent.wait().unwrap().code(), Some(1));
    // Interrupted while they start, the parent does not see each of them end.
    support::wait_until("the children have ended", || {
        !children.iter().any(|&child| support::runs(child))
    });
}

/// The files of two frames of the Cornell box, rendered by so many shaders from LIEs that
/// were constructed before.
fn frozen_frames(home: &Path, shaders: &str) -> [Vec<u8>; 2] {
    let out = home.join(shaders);
    let stats = home.join("stats.json");
    let mut run = support::lie();
    run.arg("run").arg(support::cornell());
    run.args(["--shaders", shaders, "--frames", "2"]);
    run.args(FROZEN).arg("--freeze");
    run.arg("--cache").arg(home.join("cache"));
    run.arg("--out").arg(&out).arg("--stats").arg(&stats);
    support::succeeds(&mut run);
    let stats: serde_json::Value = serde_json::from_slice(&std::fs::read(&stats).unwrap()).unwrap();
    assert_eq!(stats["frames"].as_array().unwrap().len(), 2);
    assert!(stats["lie"]["frozen"].as_bool().unwrap());
    for frame in stats["frames"].as_array().unwrap() {
        assert!(frame["lie_version"].as_u64().unwrap() > 0, "{frame}");
        assert_eq!(frame["lie_version"], frame["lie_version_max"]);
    }
    ["frame-0000.exr", "frame-0001.exr"].map(|name| std::fs::read(out.join(name)).unwrap())
}

const FROZEN: [&str; 6] = [
    "--size",
    "96x80",
    "--precision",
    "half",
    "--samples",
    "30000",
];

/// The same frames from the library, in this process.
fn frames_of_this_process(home: &Path) -> [Vec<u8>; 2] {
    let scene = Arc::new(lie_scene::load(&support::cornell()).unwrap().scene);
    let world = Arc::new(World::new(scene.clone()));
    let settings = FrameSettings {
        size: UVec2::new(96, 80),
        ..FrameSettings::new(&scene.settings)
    };
    let walk = &scene.walkthroughs[0];
    let cameras = [0.0, walk.duration_s()].map(|time_s| walk.camera_at(time_s));
    let mut builder = Builder::new(world.clone(), ConstructSettings::new(&scene)).unwrap();
    let view = View {
        camera: cameras[0].clone(),
        size: settings.size,
    };
    builder.sample(&[view], 30_000, |_| {});
    let lies = LieReplica::of(world.clone(), builder.tree()).publish();
    cameras.map(|camera| {
        let (film, _) = render_frame(&world, Some(&lies), &camera, &settings, &mut |_| {});
        let path = home.join("frame.exr");
        lie_render::write_exr(&path, &film, lie_render::Precision::Half).unwrap();
        std::fs::read(&path).unwrap()
    })
}

#[test]
fn frozen_frames_are_the_same_bytes_wherever_they_are_rendered() {
    let home = tempfile::tempdir().unwrap();
    let one = frozen_frames(home.path(), "1");
    assert!(
        one == frozen_frames(home.path(), "2"),
        "one and two shaders differ"
    );
    assert!(
        one == frozen_frames(home.path(), "3"),
        "one and three shaders differ"
    );
    assert!(
        one == frames_of_this_process(home.path()),
        "a farm and one process differ"
    );
    // And so does the command that renders one frame without a farm.
    let picture = home.path().join("render.exr");
    let mut render = support::lie();
    render.arg("render").arg(support::cornell()).args(FROZEN);
    let scene = lie_scene::load(&support::cornell()).unwrap().scene;
    render
        .args(["--walk", &scene.walkthroughs[0].name, "--out"])
        .arg(&picture);
    support::succeeds(&mut render);
    assert!(
        one[0] == std::fs::read(&picture).unwrap(),
        "a farm and lie render differ"
    );
}

#[test]
fn a_client_looks_at_a_running_farm() {
    let home = tempfile::tempdir().unwrap();
    let constructor = Process::constructor(&[]);
    let _shaders = [
        Process::shader(&constructor.address),
        Process::shader(&constructor.address),
    ];
    let mut view = support::lie();
    view.args([
        "view",
        "--constructor",
        &constructor.address,
        "--wait-shaders",
        "2",
    ]);
    view.args([
        "--frames", "3", "--size", "64x48", "--format", "both", "--out",
    ])
    .arg(home.path());
    let stats = home.path().join("stats.json");
    view.arg("--stats").arg(&stats);
    support::succeeds(&mut view);
    for index in 0..3 {
        for ending in ["png", "exr"] {
            let picture =
                lie_render::read_image(&home.path().join(format!("frame-000{index}.{ending}")))
                    .unwrap();
            assert_eq!(picture.size(), UVec2::new(64, 48));
            assert!(
                picture
                    .radiance()
                    .iter()
                    .any(|value| value.max_element() > 0.1)
            );
        }
    }
    let stats: serde_json::Value = serde_json::from_slice(&std::fs::read(&stats).unwrap()).unwrap();
    assert_eq!(stats["shaders"], 2);
    for key in [
        "index",
        "frame_ms",
        "latency_ms",
        "lie_version",
        "trusted_fraction",
        "lost_tiles",
    ] {
        assert!(stats["frames"][2][key].is_number(), "{key}");
    }
}

#[test]
fn a_walkthrough_goes_on_where_it_was_cut_off() {
    let home = tempfile::tempdir().unwrap();
    let constructor = Process::constructor(&[]);
    let _shader = Process::shader(&constructor.address);
    let view = |first: &str| {
        let mut view = support::lie();
        view.args(["view", "--constructor", &constructor.address]);
        view.args(["--frames", "3", "--first", first, "--size", "16x16"]);
        view.args(["--integrator", "standard", "--out"]);
        view.arg(home.path().join(first));
        view
    };
    support::succeeds(&mut view("0"));
    support::succeeds(&mut view("2"));
    let frame = |first: &str, name: &str| std::fs::read(home.path().join(first).join(name));
    let last = frame("2", "frame-0002.exr").unwrap();
    assert!(last == frame("0", "frame-0002.exr").unwrap());
    assert!(frame("2", "frame-0001.exr").is_err());
    let beyond = view("3").output().unwrap();
    assert_eq!(beyond.status.code(), Some(2));
    let complaint = String::from_utf8_lossy(&beyond.stderr);
    assert!(
        complaint.contains("--first 3: there are 3 frames"),
        "{complaint}"
    );
}

/// Relative RMSE of a frame against another.
fn error(frame: &Frame, standard: &Frame) -> f64 {
    lie_render::compare(&frame.film, &standard.film, 0.0)
        .unwrap()
        .relative_rmse
}

#[tokio::test]
async fn what_shaders_find_wrong_is_mended() {
    // In the paper's mode cells are relied on after the few samples of a tiny view.
    let constructor = Process::constructor(&["--trust", "0"]);
    let _shader = Process::start(&[
        "shader",
        "--constructor",
        &constructor.address,
        "--no-cache",
        "--audit",
        "1",
    ]);
    let mut client = connect(&constructor).await;
    client.wait_for_shaders(1).await;
    let mut request = request(&client, 1);
    let standard = client.render_frame(&request).await.unwrap();
    request.integrator = WireIntegrator::Lie;
    let serial = client.set_camera(&request.camera, UVec2::splat(8));
    assert!(client.settled(serial, LONG).await);
    let first = client.render_frame(&request).await.unwrap();
    let before = error(&first, &standard);
    assert!(before > 0.001, "there is something to mend: {before}");
    let mended = tokio::time::timeout(LONG, async {
        loop {
            let frame = client.render_frame(&request).await.unwrap();
            if error(&frame, &standard) < 0.5 * before {
                return;
            }
            sleep(Duration::from_millis(100)).await;
        }
    });
    mended.await.expect("pictures get better");
    let status = *client.status().borrow();
    assert!(status.audit_wrong > 0 && status.audit_wrong < status.audit_rays);
}
