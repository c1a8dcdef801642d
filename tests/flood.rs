//! Many connections at once, and slow ones, while pictures are rendered.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::{
    collections::VecDeque,
    io::{Read, Write},
    net::TcpStream,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use lie_farm::network::Exposure;
use lie_protocol::{Header, MAGIC};
use support::{
    Process,
    secured::{Farm, cluster, connect, new_bundle, render},
};
use tokio::time::sleep;

/// How long a connection may take until its hello.
const DEADLINE: Duration = lie_farm::connection::HANDSHAKE_DEADLINE;
/// Longer than anything here takes, and shorter than anybody likes to wait.
const SOON: Duration = Duration::from_secs(20);

/// Connects over and over from threads of its own, until it is dropped.
#[derive(Clone, Default)]
struct Flood {
    over: Arc<AtomicBool>,
    connections: Arc<AtomicU64>,
}

impl Flood {
    /// Every other connection sends these bytes; all of them stay for a while.
    fn start(&self, address: &str, bytes: &'static [u8]) {
        let (flood, address) = (self.clone(), address.to_owned());
        thread::spawn(move || {
            let mut held = VecDeque::new();
            while !flood.over.load(Ordering::Relaxed) {
                let Ok(mut stream) = TcpStream::connect(&address) else {
                    continue;
                };
                if flood
                    .connections
                    .fetch_add(1, Ordering::Relaxed)
                    .is_multiple_of(2)
                {
                    let _ = stream.write_all(bytes);
                }
                held.push_back(stream);
                if held.len() > 150 {
                    held.pop_front();
                }
                thread::sleep(Duration::from_micros(500));
            }
        });
    }
}

impl Drop for Flood {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
    }
}

#[tokio::test]
async fn a_flood_disturbs_no_picture_and_fills_no_log() {
    let home = tempfile::tempdir().unwrap();
    let bundle = new_bundle(home.path(), "bundle.pem");
    let mut farm = Farm::start(bundle.as_ref()).await;
    let quiet = render(&mut farm.client, 4).await;
    let garbage = &b"GET / HTTP/1.1\r\n\r\n"[..];
    for bytes in [garbage, &[0x16, 3, 1, 2, 0, 1], &MAGIC] {
        let flood = Flood::default();
        flood.start(&farm.constructor.address, bytes);
        flood.start(&farm.shader.address, bytes);
        while flood.connections.load(Ordering::Relaxed) < 1000 {
            let frame = render(&mut farm.client, 4).await;
            assert!(frame.film == quiet.film && frame.stats.lost_tiles == 0);
        }
        // Whoever belongs to us comes in meanwhile, and gets a picture.
        let mut late = connect(&farm.constructor, cluster(bundle.as_ref())).await;
        let came = tokio::time::timeout(SOON, late.wait_for_shaders(1)).await;
        assert!(came.is_ok(), "{}", farm.constructor.log());
        assert!(render(&mut late, 4).await.film == quiet.film);
    }
    let log = farm.constructor.log();
    assert!(log.matches("WARN").count() < 20, "{log}");
}

#[tokio::test]
async fn silence_keeps_nobody_out_of_a_cluster() {
    let home = tempfile::tempdir().unwrap();
    let path = new_bundle(home.path(), "bundle.pem");
    let constructor = Process::constructor(&["--bundle", &path]);
    // The beginning of a handshake that is never sent to its end.
    let first = [0x16, 3, 1, 2, 0, 1, 0, 1, 0xfc, 3, 3, 0];
    silence(&constructor, cluster(path.as_ref()), &first).await;
}

#[tokio::test]
async fn silence_keeps_nobody_out_without_a_bundle() {
    let header = Header {
        version: lie_protocol::PROTOCOL_VERSION,
        kind: 1,
        length: 1000,
    };
    let constructor = Process::constructor(&[]);
    silence(&constructor, Exposure::Loopback, &header.to_bytes()).await;
}

/// More connections than there is room for, of which one says its word byte by byte.
async fn silence(constructor: &Process, exposure: Exposure, word: &[u8]) {
    let clock = Instant::now();
    let mut silent: Vec<_> = (0..400)
        .map(|_| TcpStream::connect(&constructor.address).unwrap())
        .collect();
    let _client = connect(constructor, exposure).await;
    assert!(clock.elapsed() < DEADLINE, "{:?}", clock.elapsed());
    // Every byte is a sign of life, but none buys time.
    let mut slow = silent.pop().unwrap();
    for byte in word {
        if slow.write_all(&[*byte]).is_err() {
            break;
        }
        sleep(Duration::from_millis(500)).await;
    }
    slow.set_read_timeout(Some(DEADLINE)).unwrap();
    let mut ignored = [0; 64];
    while matches!(slow.read(&mut ignored), Ok(count) if count > 0) {}
    assert!(clock.elapsed() < 2 * DEADLINE, "{:?}", clock.elapsed());
    let told = || constructor.log().contains("nothing was heard for 5 s");
    support::wait_until("the log says so", told);
    let crowded = constructor.log().matches("it said no hello").count();
    assert_eq!(crowded, 1, "{}", constructor.log());
}
