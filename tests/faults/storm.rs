//! Faults from a schedule on a farm that renders all the while.

use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use crate::{
    rig::{Rig, VIEWS, walk},
    schedule::{Fault, Kind},
    support::{
        LONG,
        patience::{patiently, stood_still},
        proc,
    },
};
use lie_bench::proxy::Weather;
use lie_render::Film;

/// One megabit in a second.
pub(crate) const MEGABIT: f64 = 1.0e6 / 8.0;
/// A slowed shader works for so long of [`CYCLE`].
const WORKS: Duration = Duration::from_millis(10);
const CYCLE: Duration = Duration::from_millis(100);

/// What happened.
pub(crate) struct Told {
    pub(crate) frames: Vec<FrameTime>,
    pub(crate) records: Vec<Record>,
}

/// One frame.
#[derive(Clone, Copy)]
pub(crate) struct FrameTime {
    from: Instant,
    pub(crate) took: Duration,
    lost: u64,
    reissued: u64,
    set_aside: u64,
}

/// One fault.
#[derive(Clone, Copy)]
pub(crate) struct Record {
    fault: Fault,
    from: Instant,
    to: Instant,
    /// From its end until the shader rendered again.
    back: Duration,
}

struct Storm {
    rig: Rig,
    /// The farm's pictures before anything was broken, as a client has them in its files.
    files: Vec<Vec<u8>>,
    /// When each shader's last tile came, by its address.
    seen: Mutex<BTreeMap<String, Instant>>,
    broken: Vec<AtomicBool>,
    /// Clients do not begin while there is no constructor.
    constructor: Mutex<()>,
    clients: AtomicUsize,
    records: Mutex<Vec<Record>>,
}

/// Renders until all faults have come and gone. Every frame must be there and as it was before.
pub(crate) async fn weather(rig: Rig, faults: Vec<Fault>) -> (Rig, Told) {
    let mut client = rig.client().await;
    let requests = walk(&client);
    let mut films: Vec<Film> = Vec::new();
    for request in &requests {
        films.push(client.render_frame(request).await.unwrap().film);
    }
    let nodes = rig.nodes.len();
    let storm = Arc::new(Storm {
        files: whole_walk(&rig, "quiet"),
        rig,
        seen: Mutex::default(),
        broken: (0..nodes).map(|_| AtomicBool::new(false)).collect(),
        constructor: Mutex::default(),
        clients: AtomicUsize::new(0),
        records: Mutex::default(),
    });
    let injected = storm.clone();
    let injector = thread::spawn(move || inject(&injected, &faults));
    let mut frames = Vec::new();
    let mut last_round = 0;
    // One more round when all is over.
    while last_round < VIEWS {
        last_round += usize::from(injector.is_finished());
        let view = frames.len() % VIEWS;
        let (from, still) = (Instant::now(), stood_still());
        let frame = patiently(client.render_frame(&requests[view])).await;
        let frame = frame.expect("a frame hangs").expect("a frame fails");
        assert!(frame.film == films[view], "frame {} differs", frames.len());
        frames.push(FrameTime {
            from,
            took: from.elapsed().saturating_sub(stood_still() - still),
            lost: frame.stats.lost_tiles,
            reissued: frame.stats.reissued_tiles,
            set_aside: frame.stats.set_aside,
        });
        let mut seen = storm.seen.lock().unwrap();
        for share in frame
            .stats
            .shaders
            .into_iter()
            .filter(|share| share.tiles > 0)
        {
            seen.insert(share.address, Instant::now());
        }
    }
    injector.join().expect("every fault passes");
    let storm = Arc::into_inner(storm).expect("nobody else has it");
    let records = storm.records.into_inner().unwrap();
    (storm.rig, Told { frames, records })
}

/// Lets the faults come, each on a thread of its own, and never to the last whole shader.
fn inject(storm: &Arc<Storm>, faults: &[Fault]) {
    let mut running: Vec<thread::JoinHandle<()>> = Vec::new();
    for &fault in faults {
        thread::sleep(fault.pause);
        let storm = storm.clone();
        if !fault.kind.is_of_a_shader() {
            // One at a time.
            let thread = thread::spawn(move || {
                let _alone = storm.constructor.lock().unwrap();
                storm.suffer(fault, None);
            });
            thread.join().expect("the fault passes");
            continue;
        }
        let node = loop {
            let whole: Vec<usize> = (0..storm.broken.len())
                .filter(|&node| !storm.broken[node].load(Ordering::SeqCst))
                .collect();
            if whole.len() > 1 {
                break whole[fault.choice % whole.len()];
            }
            thread::sleep(Duration::from_millis(20));
            let finished = running.iter().position(thread::JoinHandle::is_finished);
            if let Some(thread) = finished.map(|index| running.swap_remove(index)) {
                thread.join().expect("the fault passes");
            }
        };
        storm.broken[node].store(true, Ordering::SeqCst);
        running.push(thread::spawn(move || storm.suffer(fault, Some(node))));
    }
    for thread in running {
        thread.join().expect("the fault passes");
    }
}

impl Storm {
    fn suffer(&self, fault: Fault, node: Option<usize>) {
        let from = Instant::now();
        match node {
            Some(node) => self.break_shader(fault, node),
            None => self.break_another(fault),
        }
        let to = Instant::now();
        if let Some(node) = node {
            self.wait_for(node, to);
            self.broken[node].store(false, Ordering::SeqCst);
        }
        self.records.lock().unwrap().push(Record {
            fault,
            from,
            to,
            back: to.elapsed(),
        });
    }

    fn break_shader(&self, fault: Fault, node: usize) {
        let mut node = self.rig.nodes[node].lock().unwrap();
        let weather = match fault.kind {
            Kind::ShaderKilled => {
                node.shader.kill();
                thread::sleep(fault.lasts);
                return node.restart();
            }
            Kind::ShaderStopped => {
                node.shader.stop();
                thread::sleep(fault.lasts);
                return node.shader.resume();
            }
            Kind::ShaderSlowed => {
                let end = Instant::now() + fault.lasts;
                while Instant::now() < end {
                    node.shader.stop();
                    thread::sleep(CYCLE - WORKS);
                    node.shader.resume();
                    thread::sleep(WORKS);
                }
                return;
            }
            Kind::ShaderCutOff => Weather::Cut,
            Kind::ShaderSilent => Weather::Silent,
            _ => Weather::Slow {
                bytes_per_s: MEGABIT,
                delay: Duration::from_millis(5),
            },
        };
        node.set(weather);
        thread::sleep(fault.lasts);
        node.set(Weather::Fair);
    }

    fn break_another(&self, fault: Fault) {
        match fault.kind {
            Kind::ConstructorKilled => {
                let mut constructor = self.rig.constructor.lock().unwrap();
                constructor.kill();
                thread::sleep(fault.lasts);
                *constructor = self.rig.constructor_again();
            }
            Kind::ConstructorStopped => {
                let constructor = self.rig.constructor.lock().unwrap();
                constructor.stop();
                thread::sleep(fault.lasts);
                constructor.resume();
            }
            _ => self.replace_a_client(fault.lasts),
        }
    }

    /// Kills a client, whose frames must be right as far as they are there, and starts another.
    fn replace_a_client(&self, lives: Duration) {
        let number = self.clients.fetch_add(1, Ordering::Relaxed);
        let (mut view, out) = self.rig.viewer(&format!("killed-{number}"));
        let mut view = view.spawn().unwrap();
        thread::sleep(lives / 2);
        // It may have finished.
        let _ = view.kill();
        view.wait().unwrap();
        let written = frames_in(&out);
        // It may have died while it wrote the last.
        for (index, bytes) in written.iter().enumerate().rev().skip(1) {
            assert!(
                *bytes == self.files[index],
                "a killed client's frame {index} differs"
            );
        }
        let whole = whole_walk(&self.rig, &format!("after-{number}"));
        assert!(whole == self.files, "a new client's frames differ");
        let _ = fs::remove_dir_all(out);
    }

    /// Waits until the shader has rendered something after that moment.
    fn wait_for(&self, node: usize, after: Instant) {
        const PAUSE: Duration = Duration::from_millis(10);
        // Counted, so that standing still makes nothing late.
        for _ in 0..LONG.as_millis() / PAUSE.as_millis() {
            let address = self.rig.nodes[node].lock().unwrap().address();
            let seen = self.seen.lock().unwrap().get(&address).copied();
            if seen.is_some_and(|seen| seen > after) {
                return;
            }
            thread::sleep(PAUSE);
        }
        let node = self.rig.nodes[node].lock().unwrap();
        panic!(
            "shader {} does not come back: {}",
            node.address(),
            node.shader.log()
        );
    }
}

/// What a client writes that takes the whole walk.
fn whole_walk(rig: &Rig, name: &str) -> Vec<Vec<u8>> {
    let (mut view, out) = rig.viewer(name);
    let output = view.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let frames = frames_in(&out);
    assert_eq!(frames.len(), VIEWS);
    let _ = fs::remove_dir_all(out);
    frames
}

/// The frames that a client has written, in order.
fn frames_in(out: &Path) -> Vec<Vec<u8>> {
    let read = |index| fs::read(out.join(format!("frame-{index:04}.exr"))).ok();
    (0..).map_while(read).collect()
}

/// Memory of the constructor, the most of a shader, and ours, which has the client.
pub(crate) fn memory(rig: &Rig) -> [u64; 3] {
    let constructor = rig.constructor.lock().unwrap().id();
    let shaders = rig
        .nodes
        .iter()
        .map(|node| node.lock().unwrap().shader.id());
    let most = shaders.map(proc::memory).max();
    let client = proc::memory(std::process::id());
    [proc::memory(constructor), most.unwrap_or(0), client]
}

/// Prints what each kind of fault cost, and gives the longest frame of all.
pub(crate) fn report(told: &Told) -> Duration {
    let mut times: Vec<Duration> = told.frames.iter().map(|frame| frame.took).collect();
    times.sort_unstable();
    let (median, longest) = (times[times.len() / 2], times[times.len() - 1]);
    let sum = |of: fn(&FrameTime) -> u64| told.frames.iter().map(of).sum::<u64>();
    println!(
        "{} frames, all as without faults: median {median:.0?}, longest {longest:.0?}; \
         {} tiles lost, {} given to another as well, {} times a shader was left out",
        times.len(),
        sum(|frame| frame.lost),
        sum(|frame| frame.reissued),
        sum(|frame| frame.set_aside),
    );
    println!(
        "{:<20} {:>5} {:>14} {:>14}",
        "fault", "times", "longest frame", "back after"
    );
    let mut kinds: Vec<Kind> = told
        .records
        .iter()
        .map(|record| record.fault.kind)
        .collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        let of_it = || {
            told.records
                .iter()
                .filter(|record| record.fault.kind == kind)
        };
        let worst = of_it().flat_map(|record| {
            let within = |frame: &&FrameTime| {
                frame.from < record.to && frame.from + frame.took > record.from
            };
            told.frames.iter().filter(within).map(|frame| frame.took)
        });
        println!(
            "{:<20} {:>5} {:>14.0?} {:>14}",
            format!("{kind:?}"),
            of_it().count(),
            worst.max().unwrap_or_default(),
            match of_it().map(|record| record.back).max() {
                Some(back) if kind.is_of_a_shader() => format!("{back:.1?}"),
                _ => "-".to_owned(),
            }
        );
    }
    println!(
        "the longest delay that a fault caused is at most {:.0?}",
        longest.saturating_sub(median)
    );
    longest
}
