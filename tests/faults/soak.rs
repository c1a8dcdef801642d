//! A farm that learns and renders for as long as one likes, while clients and shaders come and go.

use std::time::{Duration, Instant};

use crate::{
    number,
    rig::walk,
    support::{
        Process,
        patience::patiently,
        proc::{self, mib},
    },
};
use lie_farm::{
    client::{Client, ClientConfig},
    network::Exposure,
};

/// What a process may have grown by since a third of the time.
const GROWTH: u64 = 24 << 20;
/// And how many more files and sockets it may have then: what is just opening or closing.
const MORE_OPEN: usize = 12;
/// How often clients and shaders come and go.
const EVERY: Duration = Duration::from_secs(3);

/// The most that was seen of a process in a part of the time.
#[derive(Clone, Copy, Default)]
struct Use {
    memory: u64,
    open: usize,
}

impl Use {
    fn take_in(&mut self, id: u32) {
        self.memory = self.memory.max(proc::memory(id));
        self.open = self.open.max(proc::descriptors(id));
    }
}

/// Lines of a log that say that something is wrong, but for who left because we let it.
fn complaints(process: &Process) -> Vec<String> {
    let log = process.log();
    let wrong = log
        .lines()
        .filter(|line| line.contains("WARN") || line.contains("ERROR"));
    wrong.map(str::to_owned).collect()
}

async fn connect(constructor: &Process) -> Client {
    let config = ClientConfig::new(&constructor.address, Exposure::Loopback);
    Client::connect(config).await.unwrap()
}

/// `LIE_SOAK_S=1800 cargo test --release --test faults -- --ignored --nocapture soak`
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes half a minute, or LIE_SOAK_S seconds"]
async fn soak() {
    let lasts = Duration::from_secs(number("LIE_SOAK_S", 30));
    let constructor = Process::constructor(&[]);
    let steady = Process::shader(&constructor.address);
    let mut passing = Some(Process::shader(&constructor.address));
    let mut client = connect(&constructor).await;
    client.wait_for_shaders(2).await;
    let requests = walk(&client);
    let (clock, mut changed, mut frames, mut changes) = (Instant::now(), Instant::now(), 0, 0);
    let mut watched = [
        ("constructor", constructor.id()),
        ("shader", steady.id()),
        ("client", std::process::id()),
    ]
    .map(|(name, id)| (name, id, [Use::default(); 3]));
    while clock.elapsed() < lasts {
        let request = &requests[frames / 5 % requests.len()];
        client.set_camera(&request.camera, request.size);
        let frame = patiently(client.render_frame(request)).await;
        frame.expect("a frame hangs").expect("a frame fails");
        frames += 1;
        let third = (3.0 * clock.elapsed().as_secs_f64() / lasts.as_secs_f64()) as usize;
        for (_, id, thirds) in &mut watched {
            thirds[third.min(2)].take_in(*id);
        }
        if changed.elapsed() < EVERY {
            continue;
        }
        (changed, changes) = (Instant::now(), changes + 1);
        // One client more for a frame, and a shader that leaves or comes.
        let mut guest = connect(&constructor).await;
        guest.wait_for_shaders(1).await;
        let frame = patiently(guest.render_frame(request)).await;
        frame.expect("a frame hangs").expect("a frame fails");
        passing = match passing.take() {
            Some(shader) => {
                assert_eq!(complaints(&shader), Vec::<String>::new());
                assert!(shader.end().success());
                None
            }
            None => Some(Process::shader(&constructor.address)),
        };
    }
    println!(
        "{frames} frames and {changes} changes in {:.0?}",
        clock.elapsed()
    );
    for (name, _, thirds) in watched {
        println!(
            "{name:<12} MiB {:?}, open {:?}, at most in each third of the time",
            thirds.map(|third| mib(third.memory).round()),
            thirds.map(|third| third.open)
        );
        assert!(thirds[2].memory < thirds[0].memory + GROWTH, "{name} grows");
        assert!(
            thirds[2].open < thirds[0].open + MORE_OPEN,
            "{name} leaks descriptors"
        );
    }
    for process in [&constructor, &steady] {
        assert_eq!(complaints(process), Vec::<String>::new());
    }
}
