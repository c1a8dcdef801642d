//! A farm of real processes whose every connection goes through a proxy, and a walk through it.

use std::{
    net::{IpAddr, SocketAddr},
    path::Path,
    process::{Command, Stdio},
    sync::Mutex,
};

use glam::UVec2;
use lie_bench::proxy::{Proxy, Weather};
use lie_farm::{
    client::{Client, ClientConfig, FrameRequest},
    convert,
    network::Exposure,
};
use lie_protocol::{Compression, PixelFormat, WireIntegrator};

use crate::support::{
    self, Process,
    secured::{cluster, new_bundle},
};

/// Views of the walk.
pub(crate) const VIEWS: usize = 6;
/// Size of a frame: twelve tiles.
pub(crate) const SIZE: UVec2 = UVec2::new(256, 192);

/// A shader behind a way of its own to everybody else.
///
/// To the constructor it comes from an address of its own on the loopback network, so that this is
/// the address which the roster has; there another proxy takes the clients.
pub(crate) struct Node {
    ip: IpAddr,
    /// What its shader is told besides where the constructor is.
    settings: Vec<String>,
    up: Proxy,
    down: Proxy,
    pub(crate) shader: Process,
}

impl Node {
    /// A shader that keeps scenes in this folder, and belongs to the cluster if there is a bundle.
    pub(crate) fn start(
        number: usize,
        constructor: SocketAddr,
        cache: &Path,
        bundle: Option<&str>,
    ) -> Self {
        let ip = IpAddr::from([127, 0, 1, number as u8 + 1]);
        let up = Proxy::start(([127, 0, 0, 1], 0).into(), ip, constructor).unwrap();
        let mut settings = vec!["--cache".to_owned(), cache.to_str().unwrap().to_owned()];
        settings.extend(["--listen", "127.0.0.1:0"].map(str::to_owned));
        settings.extend(protected(bundle).map(str::to_owned));
        let (shader, down) = start_shader(ip, &up, &settings);
        Self {
            ip,
            settings,
            up,
            down,
            shader,
        }
    }

    /// Where clients find it.
    pub(crate) fn address(&self) -> String {
        self.down.address().to_string()
    }

    pub(crate) fn set(&self, weather: Weather) {
        self.up.set(weather);
        self.down.set(weather);
    }

    /// Starts the shader that was killed anew.
    pub(crate) fn restart(&mut self) {
        (self.shader, self.down) = start_shader(self.ip, &self.up, &self.settings);
    }
}

fn start_shader(ip: IpAddr, up: &Proxy, settings: &[String]) -> (Process, Proxy) {
    let up = up.address().to_string();
    let mut arguments = vec!["shader", "--constructor", &up, "--threads", "1"];
    arguments.extend(settings.iter().map(String::as_str));
    let shader = Process::start(&arguments);
    let at: SocketAddr = shader.address.parse().unwrap();
    let down = Proxy::start((ip, at.port()).into(), [127, 0, 0, 1].into(), at).unwrap();
    (shader, down)
}

/// How a process is told of a bundle.
fn protected(bundle: Option<&str>) -> impl Iterator<Item = &str> {
    bundle.into_iter().flat_map(|bundle| ["--bundle", bundle])
}

/// A constructor whose LIEs are frozen, and its shaders. Who breaks something holds its lock.
pub(crate) struct Rig {
    home: tempfile::TempDir,
    pub(crate) address: SocketAddr,
    pub(crate) constructor: Mutex<Process>,
    pub(crate) nodes: Vec<Mutex<Node>>,
    bundle: Option<String>,
}

impl Rig {
    /// Every connection is protected by mutual TLS, or none is.
    pub(crate) fn start(nodes: usize, is_protected: bool) -> Self {
        let home = tempfile::tempdir().unwrap();
        let bundle = is_protected.then(|| new_bundle(home.path(), "cluster.pem"));
        let protection = bundle.as_deref();
        let constructor = constructor(home.path(), protection, "127.0.0.1:0", "30000");
        let address = constructor.address.parse().unwrap();
        let cache = home.path().join("cache");
        let node = |number| Mutex::new(Node::start(number, address, &cache, protection));
        Self {
            address,
            constructor: Mutex::new(constructor),
            nodes: (0..nodes).map(node).collect(),
            home,
            bundle,
        }
    }

    /// A constructor at the same address that goes on with the LIEs that were saved.
    pub(crate) fn constructor_again(&self) -> Process {
        let address = self.address.to_string();
        constructor(self.home.path(), self.bundle.as_deref(), &address, "0")
    }

    pub(crate) async fn client(&self) -> Client {
        let exposure = match &self.bundle {
            Some(bundle) => cluster(bundle.as_ref()),
            None => Exposure::Loopback,
        };
        let config = ClientConfig::new(self.address.to_string(), exposure);
        let client = Client::connect(config).await.unwrap();
        client.wait_for_shaders(self.nodes.len()).await;
        client
    }

    /// A client as a process, which writes the whole walk into a folder of that name.
    pub(crate) fn viewer(&self, name: &str) -> (Command, std::path::PathBuf) {
        let out = self.home.path().join(name);
        let mut view = support::lie();
        view.args(["view", "--constructor", &self.address.to_string()]);
        view.args(["--frames", &VIEWS.to_string()]);
        view.args(["--size", &format!("{}x{}", SIZE.x, SIZE.y)]);
        view.args(protected(self.bundle.as_deref()));
        view.arg("--out").arg(&out);
        view.stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        (view, out)
    }
}

fn constructor(home: &Path, bundle: Option<&str>, listen: &str, samples: &str) -> Process {
    let lies = home.join("a.lies");
    let size = format!("{}x{}", SIZE.x, SIZE.y);
    let mut arguments = vec!["--listen", listen, "--freeze", "--freeze-size", &size];
    arguments.extend(["--samples", samples, "--lies", lies.to_str().unwrap()]);
    arguments.extend(protected(bundle));
    Process::constructor(&arguments)
}

/// What the client asks for at each view of the walk, pixels exact.
pub(crate) fn walk(client: &Client) -> Vec<FrameRequest> {
    let path = convert::walkthrough(&client.scene().walkthroughs[0]).unwrap();
    let views = (0..VIEWS).map(|view| {
        let share = view as f64 / (VIEWS - 1) as f64;
        FrameRequest {
            camera: path.camera_at((f64::from(path.duration_s()) * share) as f32),
            size: SIZE,
            samples_per_pixel: 2,
            light_samples: 16,
            integrator: WireIntegrator::Lie,
            seed: 0,
            format: PixelFormat::F32,
            compression: Compression::None,
        }
    });
    views.collect()
}
