//! A farm whose processes are each on a host of their own, with real cables between them that are pulled
//! out, slow or lossy: silence, where a killed process closes its sockets. Wants root, for namespaces.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(clippy::print_stdout, reason = "figures are what these tests are for")]

#[path = "namespaces/lan.rs"]
mod lan;
mod support;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use lan::{Lan, skip};
use serde_json::Value;
use support::{Process, cornell, failure, lie, secured::new_bundle, succeeds, wait_until};

/// The hosts.
const CONSTRUCTOR: usize = 0;
const SHADERS: [usize; 2] = [1, 2];
const CLIENT: usize = 3;
const FRAMES: usize = 60;
const WALK: [&str; 6] = [
    "--frames",
    "60",
    "--size",
    "256x192",
    "--precision",
    "float",
];
const FROZEN: [&str; 3] = ["--freeze", "--samples", "30000"];

/// A farm of a cluster on a network of its own. Its processes end before their hosts.
struct Farm {
    constructor: Process,
    shaders: Vec<Process>,
    bundle: String,
    lan: Lan,
    home: tempfile::TempDir,
    /// The walk's pictures on this machine alone.
    plain: Vec<Vec<u8>>,
}

impl Farm {
    fn start(lan: Lan) -> Self {
        let home = tempfile::tempdir().unwrap();
        let bundle = new_bundle(home.path(), "cluster.pem");
        let plain = plain_run(home.path());
        let mut constructor = lan.lie(CONSTRUCTOR);
        constructor.arg("constructor").arg(cornell()).args(FROZEN);
        constructor.args(["--freeze-size", "256x192", "--bundle", &bundle]);
        let listen = format!("{}:0", lan.address(CONSTRUCTOR));
        constructor.args(["--listen", &listen, "--threads", "1"]);
        let constructor = Process::spawn(constructor);
        let shaders = SHADERS.map(|host| {
            let mut shader = lan.lie(host);
            shader.args(["shader", "--constructor", &constructor.address]);
            shader.args(["--bundle", &bundle, "--no-cache", "--threads", "1"]);
            Process::spawn(shader)
        });
        Self {
            constructor,
            shaders: shaders.into(),
            bundle,
            lan,
            home,
            plain,
        }
    }

    /// Starts a client that takes the walk once both shaders are there.
    fn walk(&self, name: &str) -> Walk {
        let out = self.home.path().join(name);
        let mut view = self.lan.lie(CLIENT);
        view.args(["view", "--constructor", &self.constructor.address]);
        view.args(["--wait-shaders", "2", "--bundle", &self.bundle]);
        view.args(WALK).arg("--out").arg(&out);
        view.arg("--stats").arg(out.with_extension("json"));
        let log = fs::File::create(out.with_extension("log")).unwrap();
        view.stdin(Stdio::null()).stdout(Stdio::null()).stderr(log);
        Walk {
            client: view.spawn().unwrap(),
            out,
        }
    }

    /// A whole walk in which nothing happens.
    fn quiet_walk(&self, name: &str) -> Taken {
        self.walk(name).finish(self)
    }
}

/// The pictures without any network but loopback.
fn plain_run(home: &Path) -> Vec<Vec<u8>> {
    let out = home.join("plain");
    let mut run = lie();
    run.arg("run").arg(cornell()).args(FROZEN).args(WALK);
    run.args(["--shaders", "1", "--cache"])
        .arg(home.join("cache"));
    succeeds(run.arg("--out").arg(&out));
    frames_in(&out)
}

/// The frames that a client has written, in order.
fn frames_in(out: &Path) -> Vec<Vec<u8>> {
    let frames: Vec<_> = (0..)
        .map_while(|index| fs::read(frame(out, index)).ok())
        .collect();
    assert_eq!(frames.len(), FRAMES);
    frames
}

fn frame(out: &Path, index: usize) -> PathBuf {
    out.join(format!("frame-{index:04}.exr"))
}

/// A client on its way.
struct Walk {
    client: Child,
    out: PathBuf,
}

/// What its frames took and met.
struct Taken {
    frames: Vec<Value>,
}

impl Walk {
    /// Waits until it is in the middle of its frames.
    fn is_under_way(&self) {
        wait_until("the second frame is there", || frame(&self.out, 1).exists());
        assert!(!frame(&self.out, FRAMES - 1).exists(), "too late");
    }

    /// Waits for its end; its pictures must be those of the plain run.
    fn finish(mut self, farm: &Farm) -> Taken {
        let mut ended = None;
        wait_until("the walk is over", || {
            ended = self.client.try_wait().unwrap();
            ended.is_some()
        });
        let log = fs::read_to_string(self.out.with_extension("log")).unwrap();
        assert!(ended.unwrap().success(), "{log}");
        assert!(frames_in(&self.out) == farm.plain, "pictures differ: {log}");
        let stats = fs::read(self.out.with_extension("json")).unwrap();
        let stats: Value = serde_json::from_slice(&stats).unwrap();
        let taken = Taken {
            frames: stats["frames"].as_array().unwrap().clone(),
        };
        let name = self.out.file_stem().unwrap().to_string_lossy();
        println!("{name}: longest frame {:.0} ms", taken.longest_ms());
        taken
    }
}

impl Drop for Walk {
    fn drop(&mut self) {
        // It has ended, unless the test failed.
        let _ = self.client.kill();
        let _ = self.client.wait();
    }
}

impl Taken {
    fn longest_ms(&self) -> f64 {
        let times = self
            .frames
            .iter()
            .map(|row| row["frame_ms"].as_f64().unwrap());
        times.fold(0.0, f64::max)
    }

    fn sum(&self, key: &str) -> u64 {
        self.frames
            .iter()
            .map(|row| row[key].as_u64().unwrap())
            .sum()
    }

    /// Tiles from the shader at this address.
    fn tiles_of(&self, shader: &str) -> u64 {
        let host = format!("{shader}:");
        let shares = self
            .frames
            .iter()
            .flat_map(|row| row["shaders"].as_array().unwrap());
        shares
            .filter(|share| share["address"].as_str().unwrap().starts_with(&host))
            .map(|share| share["tiles"].as_u64().unwrap())
            .sum()
    }
}

#[test]
#[ignore = "takes some seconds, and wants root"]
fn constructors_are_found_by_name_or_where_there_is_one() {
    let Some(lan) = lan(3) else { return };
    let home = tempfile::tempdir().unwrap();
    let bundle = new_bundle(home.path(), "cluster.pem");
    let [first, second, asking] = [0, 1, 2];
    let constructor = |host, announce: &str, bundle: &str| {
        let mut constructor = lan.lie(host);
        constructor.arg("constructor").arg(cornell());
        constructor.args([announce, "--bundle", bundle, "--threads", "1"]);
        constructor.args(["--log", "info"]);
        constructor.args(["--listen", "0.0.0.0:7400", "--samples", "1000", "--freeze"]);
        Process::spawn(constructor)
    };
    let status = |which: &str| {
        let mut status = lan.lie(asking);
        status.args(["status", "--json", "--constructor", which]);
        status.args(["--bundle", &bundle]);
        status
    };

    // Nobody is there yet; a shader waits, and a client does not.
    let clock = Instant::now();
    let nobody = failure(&mut status("mdns"), 1);
    assert!(nobody.contains("no constructor was found"), "{nobody}");
    assert!(clock.elapsed() < Duration::from_secs(15));
    let mut shader = lan.lie(second);
    shader.args(["shader", "--constructor", "mdns:stage", "--bundle", &bundle]);
    shader.args(["--no-cache", "--threads", "1", "--log", "info"]);
    let shader = Process::spawn(shader);
    wait_until("the shader says that it waits", || {
        shader.log().contains("no constructor called 'stage'")
    });

    let stage = constructor(first, "--announce=stage", &bundle);
    wait_until("the shader is there", || {
        shader.log().contains("the constructor's shader")
    });
    wait_until("it says so", || {
        stage.log().contains("announced as 'stage'")
    });
    for which in ["mdns", "mdns:stage", "mdns:STAGE"] {
        succeeds(&mut status(which));
    }
    let mut view = lan.lie(asking);
    view.args(["view", "--constructor", "mdns", "--bundle", &bundle]);
    succeeds(view.args(["--frames", "1", "--size", "64x48"]));
    let other = failure(&mut status("mdns:elsewhere"), 1);
    assert!(other.contains("called 'elsewhere'"), "{other}");

    // A stranger that says it is there as well: it is an address, and TLS sends it away.
    let foreign = new_bundle(home.path(), "foreign.pem");
    let stranger = constructor(second, "--announce=stranger", &foreign);
    wait_until("it is announced", || {
        stranger.log().contains("announced as")
    });
    let several = failure(&mut status("mdns"), 2);
    for piece in ["'stage' at 10.77.0.1:7400", "'stranger' at 10.77.0.2:7400"] {
        assert!(several.contains(piece), "no {piece} in: {several}");
    }
    let strange = failure(&mut status("mdns:stranger"), 1);
    assert!(strange.contains("another cluster"), "{strange}");
    succeeds(&mut status("mdns:stage"));

    // It has said farewell, so that there is one again.
    assert!(stranger.end().success());
    succeeds(&mut status("mdns"));
}

/// Namespaces, or a line that says why there are none.
fn lan(hosts: usize) -> Option<Lan> {
    Lan::new(hosts)
        .inspect_err(|why| skip("network namespaces", why))
        .ok()
}

#[test]
#[ignore = "takes twenty seconds, and wants root"]
fn pictures_are_the_same_whatever_becomes_of_the_cables() {
    let Some(lan) = lan(4) else { return };
    let farm = Farm::start(lan);
    let taken = farm.quiet_walk("quiet");
    for host in SHADERS {
        let tiles = taken.tiles_of(&farm.lan.address(host));
        assert!(tiles > 0, "both shaders render");
    }
    a_shader_is_silent(&farm);
    the_client_is_silent(&farm);
    the_constructor_is_silent(&farm);
    slow_and_lossy_cables(&farm);
}

/// Its tiles go to the other one; back on the network, it renders again.
fn a_shader_is_silent(farm: &Farm) {
    let walk = farm.walk("shader-silent");
    walk.is_under_way();
    farm.lan.cut(SHADERS[0]);
    let taken = walk.finish(farm);
    farm.lan.mend(SHADERS[0]);
    let missed = taken.sum("reissued_tiles") + taken.sum("lost_tiles");
    assert!(missed > 0, "nobody noticed that it was gone");
    let again = farm.quiet_walk("shader-back");
    assert!(again.tiles_of(&farm.lan.address(SHADERS[0])) > 0);
}

/// For less than what makes a peer dead: its frame waits, and nothing is lost for good.
fn the_client_is_silent(farm: &Farm) {
    const SILENCE: Duration = Duration::from_millis(1500);
    let walk = farm.walk("client-silent");
    walk.is_under_way();
    farm.lan.cut(CLIENT);
    sleep(SILENCE);
    farm.lan.mend(CLIENT);
    let taken = walk.finish(farm);
    assert!(taken.longest_ms() > 1000.0, "no frame had to wait");
}

/// For longer than what makes a peer dead: pictures go on, and then shaders and clients find it again.
fn the_constructor_is_silent(farm: &Farm) {
    const DEAD: Duration = Duration::from_secs(6);
    let walk = farm.walk("constructor-silent");
    walk.is_under_way();
    farm.lan.cut(CONSTRUCTOR);
    let since = Instant::now();
    walk.finish(farm);
    sleep(DEAD.saturating_sub(since.elapsed()));
    let gone = |shader: &Process| shader.log().contains("the constructor is gone");
    wait_until("shaders miss it", || farm.shaders.iter().all(gone));
    farm.lan.mend(CONSTRUCTOR);
    farm.quiet_walk("constructor-back");
}

/// What the kernel offers of these.
fn slow_and_lossy_cables(farm: &Farm) {
    for (name, queue) in [
        ("rate", "tbf rate 5mbit burst 32kb latency 400ms"),
        ("delay", "netem delay 10ms 4ms"),
        ("loss", "netem delay 2ms loss 2%"),
    ] {
        let host = SHADERS[1];
        if let Err(why) = farm.lan.shape(host, queue) {
            skip(&format!("a link with {queue}"), &why);
            continue;
        }
        let taken = farm.quiet_walk(name);
        farm.lan.unshape(host);
        let [other, slow] = SHADERS.map(|host| taken.tiles_of(&farm.lan.address(host)));
        println!("{name}: {slow} tiles came that way, and {other} from the other shader");
        if name == "rate" {
            assert!(slow < other, "the link was no slower");
        }
    }
}
