//! Everything that reads bytes from outside, fed with spoilt messages and files: nothing panics,
//! hangs, or takes more memory than it says. See `docs/security.md`.
//!
//! A case follows from a seed and its number alone. What fails says how to run it again:
//!
//!     LIE_MUTATIONS_SEED=1 LIE_MUTATIONS_CASE=4711 cargo test -p lie-trial --test mutations messages

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "figures are what these tests are for"
)]

mod dense;
mod drive;
mod watch;

use drive::{Course, drive, target};
use lie_trial::{Form, Memory, Target};
use peak_alloc::PeakAlloc;

/// Counts what all threads have, now and at most.
#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

fn number(variable: &str, default: u64) -> u64 {
    let value = std::env::var(variable).ok();
    value.map_or(default, |value| value.parse().expect("a number"))
}

/// Runs so many cases, or the one that is asked for, and asserts that all went well.
fn survive(name: &str, count: u64) {
    let seed = number("LIE_MUTATIONS_SEED", 1);
    let course = match std::env::var("LIE_MUTATIONS_CASE") {
        Ok(case) => Course::one(seed, case.parse().expect("a number")),
        Err(_) => Course::new(seed, count),
    };
    let report = drive(&target(name), &course);
    println!("{report}");
    assert!(report.failures.is_empty(), "{:#?}", report.failures);
    // Mutations that all are refused at once would show nothing, nor would those that do no harm.
    let hundredth = report.cases / 100;
    let (taken, refused) = (report.taken, report.cases - report.taken);
    assert!(
        taken >= hundredth && refused >= hundredth,
        "{taken} of {count} are taken"
    );
}

#[test]
fn messages() {
    survive("messages", 20_000);
}

#[test]
fn scenes_on_the_wire() {
    survive("scene_blob", 2000);
}

#[test]
fn trees() {
    survive("tree", 2000);
}

#[test]
fn snapshots() {
    survive("snapshot", 300);
}

#[test]
fn bundles() {
    survive("bundle", 1000);
}

#[test]
fn scene_files() {
    for name in SCENE_FILES {
        survive(name, 300);
    }
}

const SCENE_FILES: [&str; 3] = ["scene_obj", "scene_gltf", "scene_toml"];

/// `LIE_MUTATIONS=10000000 cargo test --release -p lie-trial --test mutations -- --ignored --nocapture many_messages`
#[test]
#[ignore = "takes some seconds; LIE_MUTATIONS=10000000 takes minutes"]
fn many_messages() {
    survive("messages", number("LIE_MUTATIONS", 200_000));
}

/// `LIE_MUTATIONS=100000 cargo test --release -p lie-trial --test mutations -- --ignored --nocapture many_scene_files`
#[test]
#[ignore = "takes some seconds; LIE_MUTATIONS=100000 takes minutes"]
fn many_scene_files() {
    let count = number("LIE_MUTATIONS", 6000);
    for name in SCENE_FILES {
        survive(name, count.div_ceil(3));
    }
}

/// `LIE_MUTATIONS=100000 cargo test --release -p lie-trial --test mutations -- --ignored --nocapture many_other_files`
#[test]
#[ignore = "takes some seconds; LIE_MUTATIONS=100000 takes minutes"]
fn many_other_files() {
    for name in ["scene_blob", "tree", "snapshot", "bundle"] {
        survive(name, number("LIE_MUTATIONS", 6000));
    }
}

/// Whoever finds nothing must be able to find something.
#[test]
fn what_is_planted_is_found() {
    let planted = |open| Target {
        name: "planted",
        seeds: || vec![vec![7; 40]],
        open,
        memory: Memory {
            fixed: 1 << 20,
            for_each: 1,
        },
        form: Form::Bytes,
    };
    let course = Course::new(1, 2000);
    let harmless = planted(|| Box::new(|bytes| bytes.len() > 30));
    assert_eq!(drive(&harmless, &course).failures, []);
    let panics = planted(|| {
        Box::new(|bytes| {
            assert!(bytes.first() != Some(&0xff), "planted");
            true
        })
    });
    let found = drive(&panics, &course).failures;
    assert!(found[0].what.contains("planted"), "{found:?}");
    let greedy = planted(|| {
        Box::new(|bytes| {
            let is_marked = bytes.windows(2).any(|pair| pair == [0xff, 0xff]);
            drop(vec![1u8; if is_marked { 2 << 20 } else { 10 }]);
            true
        })
    });
    let found = drive(&greedy, &course).failures;
    assert!(found[0].what.contains("bytes of memory"), "{found:?}");
    // The case alone fails as it did among the others.
    let again = drive(&greedy, &Course::one(1, found[0].case)).failures;
    assert_eq!(again[..1], found[..1]);
}
