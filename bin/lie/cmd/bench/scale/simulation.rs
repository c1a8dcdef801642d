use std::{ffi::OsString, io::Write, path::PathBuf, sync::Arc, time::Duration};

use anyhow::Context;
use lie_bench::scale::{self, Length, Phase, Usage, cpu_of};
use lie_farm::{
    client::{Client, ClientConfig, FrameRequest},
    launch::{self, ConstructorSource, LaunchConfig},
    network::Exposure,
    replay::Recording,
    status,
};
use lie_protocol::{Compression, PixelFormat, WireIntegrator};
use lie_scene::{Camera, Scene};
use tokio::{runtime::Runtime, time::timeout};

use crate::cmd::bench::subject::LoadedScene;

/// How long all shaders may take to come, beside the constructor's start.
const GATHERING: Duration = Duration::from_secs(120);

/// Views of a walk, one for each frame, after which it begins anew.
const VIEWS: u32 = 120;

/// A farm of this machine whose shaders are simulated.
pub(super) struct Simulation<'a> {
    pub(super) scene: &'a LoadedScene,
    pub(super) recording: &'a Recording,
    /// Where the recording is.
    pub(super) path: PathBuf,
    /// How the constructor learns.
    pub(super) construction: Vec<OsString>,
    pub(super) length: Length,
}

impl Simulation<'_> {
    /// Starts a farm, measures it and ends it.
    pub(super) fn phase(
        &self,
        runtime: &Runtime,
        (shaders, slow_down): (usize, f64),
        learns: bool,
    ) -> anyhow::Result<Phase> {
        let config = self.launch(shaders, slow_down, learns)?;
        let farm = runtime.block_on(launch::Farm::start(config))?;
        let phase = self.measure(runtime, &farm, (shaders, slow_down), learns);
        runtime.block_on(farm.shutdown());
        phase
    }

    fn measure(
        &self,
        runtime: &Runtime,
        farm: &launch::Farm,
        (shaders, slow_down): (usize, f64),
        learns: bool,
    ) -> anyhow::Result<Phase> {
        let config = ClientConfig {
            replays: true,
            ..ClientConfig::new(farm.address(), Exposure::Loopback)
        };
        let mut client = runtime.block_on(async {
            let client = Client::connect(config).await?;
            let gathered = timeout(GATHERING, client.wait_for_shaders(shaders)).await;
            gathered.with_context(|| {
                let there = client.shaders();
                format!("of {shaders} simulated shaders {there} have come in {GATHERING:?}")
            })?;
            Ok::<_, anyhow::Error>(client)
        })?;
        let mut frame = |number: u32| {
            let camera = self.camera(number);
            if learns {
                client.set_camera(&camera, self.recording.size());
            }
            let rendered = runtime.block_on(client.render_frame(&self.request(camera)));
            rendered.map(|frame| frame.stats)
        };
        let mut usage = || usage(runtime, farm);
        let row = (shaders, slow_down);
        Ok(scale::measure(
            self.recording,
            row,
            self.length,
            &mut frame,
            &mut usage,
        )?)
    }

    /// Where a frame is seen from. Replays take no notice, and the constructor does.
    fn camera(&self, number: u32) -> Camera {
        let scene: &Scene = self.scene.scene();
        let Some(walk) = scene.walkthroughs.first() else {
            return scene.cameras[0].clone();
        };
        let share = f64::from(number % VIEWS) / f64::from(VIEWS);
        walk.camera_at((f64::from(walk.duration_s()) * share) as f32)
    }

    fn request(&self, camera: Camera) -> FrameRequest {
        FrameRequest {
            camera,
            size: self.recording.size(),
            samples_per_pixel: 1,
            light_samples: 1,
            integrator: WireIntegrator::Lie,
            seed: 0,
            format: PixelFormat::F16,
            compression: Compression::None,
        }
    }

    fn launch(&self, shaders: usize, slow_down: f64, learns: bool) -> anyhow::Result<LaunchConfig> {
        let words = |words: &[&str]| words.iter().map(OsString::from).collect::<Vec<_>>();
        let mut constructor = words(&["constructor", self.scene.path(), "--replays"]);
        constructor.extend(words(&["--listen", "127.0.0.1:0", "--threads", "1"]));
        if learns {
            constructor.extend(self.construction.clone());
        } else {
            constructor.extend(words(&[
                "--freeze",
                "--freeze-size",
                "8x8",
                "--samples",
                "1",
            ]));
        }
        let mut shader = words(&["shader", "--count", &shaders.to_string()]);
        shader.extend(words(&["--slow-down", &slow_down.to_string(), "--replay"]));
        shader.push(self.path.clone().into());
        Ok(LaunchConfig {
            program: std::env::current_exe().context("cannot find this program")?,
            constructor: ConstructorSource::Started(constructor),
            shader,
            shaders: 1,
            bundle: None,
            constructor_grace: launch::GRACE,
            log: Arc::new(|who, line| {
                if line.contains("ERROR") || line.contains("WARN") {
                    // Nothing is left to do if standard error is closed.
                    drop(writeln!(std::io::stderr(), "{who:>11} | {line}"));
                }
            }),
        })
    }
}

/// What has been used so far.
fn usage(runtime: &Runtime, farm: &launch::Farm) -> Usage {
    let asked = runtime.block_on(status::ask(farm.address(), &Exposure::Loopback));
    if let Err(error) = &asked {
        tracing::warn!("{error}");
    }
    let cpu = |ids: &[u32]| ids.iter().map(|&id| cpu_of(id)).sum::<Option<f64>>();
    Usage {
        client_cpu_s: cpu_of(std::process::id()),
        constructor_cpu_s: cpu(farm.constructor_ids()),
        shaders_cpu_s: cpu(farm.shader_ids()),
        status: asked.ok(),
    }
}
