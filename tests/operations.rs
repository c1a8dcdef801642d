//! What operators see of a running farm: the status, metrics and logs of real processes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "operations/logs.rs"]
mod logs;
#[path = "operations/metrics.rs"]
mod metrics;
#[path = "operations/scrape.rs"]
mod scrape;
mod support;

use std::process::{Command, Output};

use serde_json::Value;
use support::{Process, wait_until};

/// A status of this farm, as it is printed.
fn status(constructor: &Process, more: &[&str]) -> String {
    let mut command = support::lie();
    command.args(["status", "--constructor", &constructor.address]);
    let Output { status, stdout, .. } = command.args(more).output().unwrap();
    assert!(status.success());
    String::from_utf8(stdout).unwrap()
}

fn json_status(constructor: &Process) -> Value {
    serde_json::from_str(&status(constructor, &["--json"])).unwrap()
}

/// Renders some frames.
fn view(constructor: &Process, frames: &str, shaders: &str) -> Command {
    let mut view = support::lie();
    view.args(["view", "--constructor", &constructor.address]);
    view.args(["--frames", frames, "--wait-shaders", shaders]);
    view.args(["--size", "96x64"]);
    view
}

/// Waits until so many shaders are ready and have reported.
fn wait_for_shaders(constructor: &Process, count: usize) {
    wait_until("the shaders are ready", || {
        let farm = json_status(constructor);
        let shaders = farm["shaders"].as_array().unwrap();
        shaders.len() == count
            && shaders
                .iter()
                .all(|shader| shader["health"] == "ready" && shader["tiles"].is_number())
    });
}

#[test]
fn a_status_shows_who_is_there_and_what_they_do() {
    let constructor = Process::constructor(&[]);
    let lonely = status(&constructor, &[]);
    assert!(lonely.contains("no shader is connected"), "{lonely}");
    assert!(lonely.contains("no client is connected"), "{lonely}");

    let mut first = Process::shader(&constructor.address);
    let second = Process::shader(&constructor.address);
    wait_for_shaders(&constructor, 2);
    let mut looker = view(&constructor, "100000", "2").spawn().unwrap();
    wait_until("both shaders' tiles are told", || {
        let farm = json_status(&constructor);
        let shaders = farm["shaders"].as_array().unwrap();
        let busy = |shader: &Value| shader["tiles"].as_u64() > Some(0);
        let frames = farm["clients"][0]["frames"].as_u64();
        shaders.iter().all(busy) && frames > Some(1)
    });

    let farm = json_status(&constructor);
    let at_the_top = &farm["constructor"];
    assert_eq!(at_the_top["scene"]["lights"], 1);
    let count = |farm: &Value, key: &str| farm["constructor"][key].as_u64().unwrap();
    let lost = count(&farm, "shaders_lost");
    assert_eq!(count(&farm, "shaders_joined") - lost, 2);
    assert!(at_the_top["lie"]["version"].as_u64() > Some(0));
    assert!(at_the_top["lie"]["cells"].as_u64() > Some(0));
    assert!(at_the_top["uptime_s"].as_f64() > Some(0.0));
    for shader in farm["shaders"].as_array().unwrap() {
        for key in ["tile_ms", "camera_rays", "since_s", "ping_ms", "lie_lag"] {
            assert!(shader[key].is_number(), "{key} in {shader}");
        }
        assert!(shader["sent_bytes"].as_u64() > Some(1000), "{shader}");
        assert_eq!(shader["threads"], 1);
    }
    let client = &farm["clients"][0];
    assert!(client["frame_ms"].as_f64() > Some(0.0), "{client}");
    assert!(client["cameras"].as_u64() > Some(0), "{client}");

    let table = status(&constructor, &[]);
    for piece in ["construction", "ms/tile", "last frame", "ready", "version"] {
        assert!(table.contains(piece), "no {piece} in\n{table}");
    }
    for address in [&first.address, &second.address, &constructor.address] {
        assert!(table.contains(address.as_str()), "no {address} in\n{table}");
    }

    first.kill();
    wait_until("one is lost", || {
        let farm = json_status(&constructor);
        let left = farm["shaders"].as_array().unwrap();
        count(&farm, "shaders_lost") > lost
            && left.len() == 1
            && left[0]["address"] == second.address.as_str()
    });
    second.stop();
    wait_until("silence shows", || {
        let shader = &json_status(&constructor)["shaders"][0];
        shader["health"] == "silent" && shader["heard_s"].as_f64() > Some(1.0)
    });
    looker.kill().unwrap();
    looker.wait().unwrap();
}

#[test]
fn a_watch_goes_on_until_it_is_interrupted() {
    use std::io::{BufRead, BufReader};
    let constructor = Process::constructor(&[]);
    let mut watch = support::lie();
    watch.args(["status", "--constructor", &constructor.address]);
    watch.args(["--watch", "0.2", "--json"]);
    let mut watch = watch.stdout(std::process::Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(watch.stdout.take().unwrap()).lines();
    for _ in 0..3 {
        let farm: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
        assert_eq!(farm["constructor"]["address"], constructor.address.as_str());
    }
    support::signal("-INT", watch.id());
    assert!(watch.wait().unwrap().success());

    // Or until nobody reads any more.
    let mut unread = support::lie();
    unread.args(["status", "--constructor", &constructor.address]);
    unread
        .args(["--watch", "0.2"])
        .stdout(std::process::Stdio::piped());
    let mut unread = unread.spawn().unwrap();
    drop(unread.stdout.take());
    assert!(unread.wait().unwrap().success());
}

#[test]
fn a_status_that_cannot_be_had_says_why() {
    let gone = Process::constructor(&[]);
    let address = gone.address.clone();
    gone.end();
    let ask = |arguments: &[&str], code| {
        let mut command = support::lie();
        support::failure(command.arg("status").args(arguments), code)
    };
    let nobody = ask(&["--constructor", &address], 1);
    let expected = format!("error: cannot reach {address}: ");
    assert!(nobody.starts_with(&expected), "{nobody}");
    let nobody = ask(&["--constructor", &address, "--watch"], 1);
    assert!(nobody.starts_with(&expected), "{nobody}");
    for (wrong, piece) in [
        (&["--constructor", "here"][..], "HOST:PORT"),
        (&["--constructor", &address, "--watch", "0"], "0.1 to 3600"),
        (&["--constructor", "192.0.2.1:1"], "--insecure"),
        (&[], "--constructor"),
    ] {
        let message = ask(wrong, 2);
        assert!(message.contains(piece), "{message}");
    }
    let shader_is_no_constructor = Process::shader("127.0.0.1:9");
    let refused = ask(&["--constructor", &shader_is_no_constructor.address], 1);
    assert!(
        refused.contains("a shader takes clients alone"),
        "{refused}"
    );
}
