//! Every process ends in order, soon, and leaves none behind.

use std::{
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use crate::support::{
    self, Process, children_of, patience::stood_still, proc, runs, signal, wait_until,
};

/// What an end may take. Asserted with room for a machine that is busy with other things.
const PROMISE: Duration = Duration::from_secs(2);
const ROOM: u32 = 4;
/// A frame that takes minutes.
const HEAVY: [&str; 8] = [
    "--integrator",
    "standard",
    "--spp",
    "4096",
    "--size",
    "512x512",
    "--frames",
    "1000",
];

/// Sends a signal and waits for the end, which must come soon, with this code.
fn ends(who: &str, name: &str, child: &mut Child, code: i32) {
    let (clock, still) = (Instant::now(), stood_still());
    signal(name, child.id());
    let mut status = None;
    wait_until("the process has ended", || {
        status = child.try_wait().unwrap();
        status.is_some()
    });
    let took = passed(clock, still);
    println!("{who}, {name}: ended in {took:.0?}");
    assert_eq!(status.unwrap().code(), Some(code), "{who}, {name}");
    assert!(took < ROOM * PROMISE, "{who}, {name}: {took:?}");
}

/// Time since then, without that in which the test stood still.
fn passed(since: Instant, still: Duration) -> Duration {
    let took = since.elapsed();
    // That is only known a moment later.
    std::thread::sleep(Duration::from_millis(100));
    took.saturating_sub(stood_still() - still)
}

fn quiet(command: &mut Command) -> Child {
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::null());
    let child = quiet.stderr(Stdio::null()).spawn().unwrap();
    let ready = || proc::minds_its_end(child.id());
    wait_until("the process minds its end", ready);
    child
}

/// A client whose first frame takes minutes.
fn viewer(constructor: &Process) -> Child {
    let mut view = support::lie();
    view.args(["view", "--constructor", &constructor.address])
        .args(HEAVY);
    quiet(&mut view)
}

#[test]
fn every_process_ends_soon_while_it_is_busy() {
    for name in ["-INT", "-TERM"] {
        let home = tempfile::tempdir().unwrap();
        let lies = home.path().join("a.lies");
        let mut constructor = Process::constructor(&["--lies", lies.to_str().unwrap()]);
        let mut shader = Process::shader(&constructor.address);
        let mut view = viewer(&constructor);
        wait_until("the shader renders, the constructor learns", || {
            let told = constructor.log().contains("client");
            told && shader.log().contains("the constructor's shader")
        });
        std::thread::sleep(Duration::from_millis(500));
        ends("a client within a frame", name, &mut view, 1);
        let mut view = viewer(&constructor);
        std::thread::sleep(Duration::from_millis(500));
        ends("a shader that renders", name, shader.child(), 0);
        ends(
            "a constructor that learns and saves",
            name,
            constructor.child(),
            0,
        );
        assert!(lies.exists(), "what it had learnt is saved");
        view.kill().unwrap();
        view.wait().unwrap();
    }
}

#[test]
fn a_constructor_that_prepares_ends_soon_even_if_it_is_to_save() {
    let home = tempfile::tempdir().unwrap();
    let mut constructor = support::lie();
    constructor.arg("constructor").arg(support::cornell());
    constructor.args([
        "--freeze",
        "--samples",
        "1000000000",
        "--listen",
        "127.0.0.1:0",
    ]);
    constructor.arg("--lies").arg(home.path().join("a.lies"));
    let mut constructor = quiet(&mut constructor);
    std::thread::sleep(Duration::from_secs(1));
    ends("a constructor that prepares", "-TERM", &mut constructor, 0);
}

/// A run whose constructor learns, with LIEs to save, and whose shaders are in the middle of a
/// frame that takes minutes; and its children.
fn busy_run(home: &std::path::Path) -> (Child, Vec<u32>) {
    let mut run = support::lie();
    run.arg("run").arg(support::cornell()).args(HEAVY);
    run.args(["--shaders", "2", "--lies"])
        .arg(home.join("a.lies"));
    run.arg("--cache").arg(home.join("cache"));
    let run = quiet(&mut run);
    let mut children = Vec::new();
    wait_until("three children run", || {
        children = children_of(run.id());
        children.len() == 3
    });
    std::thread::sleep(Duration::from_secs(1));
    (run, children)
}

#[test]
fn a_busy_run_ends_soon_and_takes_its_children_along() {
    for name in ["-INT", "-TERM"] {
        let home = tempfile::tempdir().unwrap();
        let (mut run, children) = busy_run(home.path());
        ends("a run", name, &mut run, 1);
        wait_until("the children have ended", || {
            !children.iter().any(|&child| runs(child))
        });
    }
}

#[test]
fn a_child_that_hangs_does_not_hold_up_the_end() {
    let home = tempfile::tempdir().unwrap();
    let (mut run, mut children) = busy_run(home.path());
    children.sort_unstable();
    // A shader: the constructor was started first.
    signal("-STOP", children[1]);
    ends("a run with a shader that hangs", "-TERM", &mut run, 1);
    wait_until("the children have ended", || {
        !children.iter().any(|&child| runs(child))
    });
}

#[test]
fn busy_children_end_when_their_parent_is_killed() {
    let home = tempfile::tempdir().unwrap();
    let (mut run, children) = busy_run(home.path());
    let (clock, still) = (Instant::now(), stood_still());
    run.kill().unwrap();
    run.wait().unwrap();
    wait_until("the children have ended", || {
        !children.iter().any(|&child| runs(child))
    });
    let took = passed(clock, still);
    println!("children of a run that was killed: ended in {took:.0?}");
    assert!(took < ROOM * PROMISE, "{took:?}");
}
