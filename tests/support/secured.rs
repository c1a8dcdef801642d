//! A farm that is protected by a bundle.

use std::path::Path;

use glam::UVec2;
use lie_farm::{
    client::{Client, ClientConfig, Frame, FrameRequest},
    convert,
    network::Exposure,
    secure::{Bundle, Cluster},
};
use lie_protocol::{Compression, PixelFormat, WireIntegrator};

use super::Process;

/// A constructor, a shader and a client of one cluster.
pub(crate) struct Farm {
    pub(crate) constructor: Process,
    pub(crate) shader: Process,
    pub(crate) client: Client,
}

impl Farm {
    pub(crate) async fn start(bundle: &Path) -> Self {
        let bundle = bundle.to_str().unwrap();
        let constructor = Process::constructor(&["--bundle", bundle]);
        let shader = shader(&constructor.address, &["--bundle", bundle]);
        let client = connect(&constructor, cluster(bundle.as_ref())).await;
        client.wait_for_shaders(1).await;
        Self {
            constructor,
            shader,
            client,
        }
    }
}

/// A shader with a thread of its own.
pub(crate) fn shader(constructor: &str, more: &[&str]) -> Process {
    let arguments = ["shader", "--constructor", constructor, "--threads", "1"];
    Process::start(
        &[
            &arguments[..],
            &["--no-cache", "--listen", "127.0.0.1:0"],
            more,
        ]
        .concat(),
    )
}

/// How connections are protected by a bundle.
pub(crate) fn cluster(bundle: &Path) -> Exposure {
    Exposure::Cluster(Cluster::new(&Bundle::read(bundle).unwrap()).unwrap())
}

pub(crate) async fn connect(constructor: &Process, exposure: Exposure) -> Client {
    let config = ClientConfig::new(&constructor.address, exposure);
    Client::connect(config).await.unwrap()
}

pub(crate) async fn render(client: &mut Client, samples_per_pixel: u32) -> Frame {
    let request = FrameRequest {
        camera: convert::camera(&client.scene().cameras[0]).unwrap(),
        size: UVec2::new(96, 64),
        samples_per_pixel,
        light_samples: 16,
        integrator: WireIntegrator::Standard,
        seed: 7,
        format: PixelFormat::F32,
        compression: Compression::None,
    };
    client.render_frame(&request).await.unwrap()
}

/// A new bundle of a cluster of its own.
pub(crate) fn new_bundle(home: &Path, name: &str) -> String {
    let path = home.join(name);
    super::succeeds(super::lie().args(["key", "new", "--out"]).arg(&path));
    path.to_str().unwrap().to_owned()
}
