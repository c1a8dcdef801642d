//! A shader behind a slow link, while the constructor learns.

use std::{
    net::SocketAddr,
    time::{Duration, Instant},
};

use crate::{
    rig::{Node, walk},
    storm::MEGABIT,
    support::{
        Process,
        patience::patiently,
        proc::{self, mib},
    },
};
use glam::UVec2;
use lie_bench::proxy::Weather;
use lie_farm::{
    client::{Client, ClientConfig, FrameRequest},
    network::Exposure,
};

/// How long is looked.
const WATCHED: Duration = Duration::from_secs(12);
/// What a slow shader may cost the constructor: the tree that it is being sent is kept until it
/// has gone out, and a socket's buffers.
const BOUND: u64 = 64 << 20;

/// What was seen in [`WATCHED`].
struct Seen {
    frames: usize,
    median: Duration,
    longest: Duration,
    /// Most memory of the constructor.
    memory: u64,
}

/// Walks while the constructor learns, with two shaders and perhaps a third that is slow.
async fn watch(with_a_slow_one: bool) -> Seen {
    let home = tempfile::tempdir().unwrap();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/gallery");
    let arguments = [
        "constructor",
        scene,
        "--threads",
        "1",
        "--listen",
        "127.0.0.1:0",
    ];
    let constructor = Process::start(&arguments);
    let address: SocketAddr = constructor.address.parse().unwrap();
    // They share a cache: the scene is not what goes over the slow link.
    let nodes: Vec<Node> = (0..2 + usize::from(with_a_slow_one))
        .map(|number| Node::start(number, address, home.path(), None))
        .collect();
    let config = ClientConfig::new(&constructor.address, Exposure::Loopback);
    let mut client = Client::connect(config).await.unwrap();
    client.wait_for_shaders(nodes.len()).await;
    if let Some(slow) = nodes.get(2) {
        slow.set(Weather::Slow {
            bytes_per_s: MEGABIT,
            delay: Duration::from_millis(5),
        });
    }
    let requests = walk(&client);
    let (clock, mut times, mut memory) = (Instant::now(), Vec::new(), 0);
    while clock.elapsed() < WATCHED {
        let request = FrameRequest {
            samples_per_pixel: 1,
            light_samples: 1,
            ..requests[times.len() / 20 % requests.len()].clone()
        };
        client.set_camera(&request.camera, UVec2::new(128, 96));
        let frame = patiently(client.render_frame(&request)).await;
        let frame = frame.expect("a frame hangs").unwrap();
        times.push(Duration::from_secs_f64(1.0e-3 * frame.stats.frame_ms));
        memory = memory.max(proc::memory(constructor.id()));
    }
    times.sort_unstable();
    Seen {
        frames: times.len(),
        median: times[times.len() / 2],
        longest: times[times.len() - 1],
        memory,
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes half a minute"]
async fn a_shader_behind_a_slow_link_costs_others_nothing() {
    let without = watch(false).await;
    let with = watch(true).await;
    for (name, seen) in [("without", &without), ("with", &with)] {
        println!(
            "{name} a shader at 1 Mbit/s: {} frames, median {:.0?}, longest {:.0?}; \
             constructor at most {:.0} MiB",
            seen.frames,
            seen.median,
            seen.longest,
            mib(seen.memory)
        );
    }
    assert!(with.memory < without.memory + BOUND);
    // The machine may be busy in one half and not in the other.
    assert!(with.median < 3 * without.median + Duration::from_millis(100));
}
