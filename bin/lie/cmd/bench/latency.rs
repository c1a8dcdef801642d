use std::{
    ffi::OsString,
    io::Write,
    net::{IpAddr, SocketAddr},
    path::PathBuf,
    sync::Arc,
    time::Duration,
};

use anyhow::Context;
use clap::Args;
use lie_bench::{
    latency::{self, LatencyConfig, LatencyRun},
    proxy::{Proxy, Weather},
};
use lie_farm::{
    client::{Client, ClientConfig, FrameRequest},
    launch::{self, ConstructorSource, Farm, LaunchConfig},
    network::Exposure,
};
use lie_protocol::WireIntegrator;
use lie_render::{ToneCurve, ToneMap};
use lie_scene::Walkthrough;
use tokio::runtime::Runtime;

use super::{
    output::{self, Output, progress_bar},
    subject::{LoadedScene, Subject},
};
use crate::{
    args::{Precision, compression, find_walkthrough, say},
    cmd::render::Construction,
    failure::usage,
    process,
};

/// From input to picture: what the time goes to while somebody moves the camera, and how soon stale
/// work stops.
///
/// Constructor and shaders are processes of this machine, on one thread each; LIEs of the walk's
/// first view are frozen. --delay puts proxies between all of them, for which the shaders come from addresses
/// 127.0.2.1 and on, as Linux allows.
#[derive(Args)]
pub(crate) struct Latency {
    #[command(flatten)]
    subject: Subject,
    /// Shaders, of one thread each.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=64), value_name = "N")]
    shaders: u8,
    /// Delays between two processes, in each direction, in milliseconds; a measurement for each.
    #[arg(long, value_delimiter = ',', default_value = "0,10,40", value_parser = clap::value_parser!(u16).range(0..=2000), value_name = "MS,MS,…")]
    delay: Vec<u16>,
    /// Give up a frame that has been in work for so many milliseconds when there is a newer input,
    /// never two in a row. Without, every frame is finished.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..), value_name = "MS")]
    patience: Option<u16>,
    /// Inputs per second.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u16).range(1..=10_000), value_name = "N")]
    rate: u16,
    /// Pictures of each measurement.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000), value_name = "N")]
    pictures: u32,
    /// How often a stale frame is given up to see when shaders stop.
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(0..=10_000), value_name = "N")]
    stops: u32,
    /// Bits per channel on the way.
    #[arg(long, value_enum, default_value = "half")]
    precision: Precision,
    /// Put table and plot into this report, in the place of those that are there:
    /// docs/results.md, say. `lie bench report` leaves them there.
    #[arg(long, value_name = "FILE.md")]
    into: Option<PathBuf>,
    #[command(flatten)]
    construction: Construction,
    #[command(flatten)]
    output: Output,
}

/// Processes, and what is between them.
struct Running {
    farms: Vec<Farm>,
    proxies: Vec<Proxy>,
    /// Where a client finds the constructor.
    address: String,
}

impl Latency {
    pub(super) fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        output::prepare(None, self.into.as_ref().and_then(|path| path.parent()))?;
        let mut scenes = self.subject.load()?;
        let (Some(scene), true) = (scenes.pop(), scenes.is_empty()) else {
            return Err(usage("name the one scene that is looked at").into());
        };
        let path = find_walkthrough(scene.scene(), None)?.clone();
        let runtime = process::runtime()?;
        let about = self.about(&scene, &path);
        let mut runs = vec![];
        for &delay in &self.delay {
            let delay = Duration::from_millis(delay.into());
            runs.push(self.run(&runtime, &scene, &path, delay)?);
            let rows = [("rows", latency::json(&runs))];
            self.output.write_json(&rows)?;
            self.output.write_report("latency", "Latency", || {
                Ok(vec![latency::section(&runs, about.clone())?])
            })?;
        }
        runtime.shutdown_background();
        say(latency::table(&runs).text())?;
        self.output.announce("latency")?;
        let Some(path) = &self.into else {
            return Ok(());
        };
        output::put_into_report(path, latency::section(&runs, about)?)?;
        output::announce(path)
    }

    fn about(&self, scene: &LoadedScene, path: &Walkthrough) -> String {
        let (size, shaders) = (self.subject.size(), self.shaders);
        format!(
            "{}, walk {}, {}x{}, with {shaders} shaders of one thread each, all on this machine.",
            scene.scene().name,
            path.name,
            size.x,
            size.y
        )
    }

    fn run(
        &self,
        runtime: &Runtime,
        scene: &LoadedScene,
        path: &Walkthrough,
        delay: Duration,
    ) -> anyhow::Result<LatencyRun> {
        let bar = progress_bar();
        bar.set_message(format!("{} ms of delay", delay.as_millis()));
        bar.tick();
        let running = runtime.block_on(self.start(scene, delay))?;
        let config = ClientConfig::new(&running.address, Exposure::Loopback);
        let measured = runtime.block_on(async {
            let mut client = Client::connect(config).await?;
            client.wait_for_shaders(self.shaders.into()).await;
            latency::measure(&mut client, &self.config(scene, path), delay).await
        });
        runtime.block_on(running.end());
        bar.finish_and_clear();
        Ok(measured?)
    }

    fn config(&self, scene: &LoadedScene, path: &Walkthrough) -> LatencyConfig {
        let settings = &scene.scene().settings;
        LatencyConfig {
            frame: FrameRequest {
                camera: path.camera_at(0.0),
                size: self.subject.size(),
                samples_per_pixel: settings.samples_per_pixel,
                light_samples: settings.light_samples,
                integrator: WireIntegrator::Lie,
                seed: 0,
                format: self.precision.into(),
                compression: compression(false),
            },
            path: path.clone(),
            rate: self.rate.into(),
            pictures: self.pictures as usize,
            patience: self.patience.map(|ms| Duration::from_millis(ms.into())),
            stops: self.stops as usize,
            tone_map: ToneMap {
                exposure_stops: settings.exposure_stops,
                curve: ToneCurve::Aces,
            },
        }
    }

    /// A constructor, shaders, and a delay between all that talk to each other.
    async fn start(&self, scene: &LoadedScene, delay: Duration) -> anyhow::Result<Running> {
        let size = self.subject.size();
        let mut constructor = words(&["constructor", scene.path(), "--listen", "127.0.0.1:0"]);
        constructor.extend(words(&["--freeze", "--freeze-size"]));
        constructor.push(format!("{}x{}", size.x, size.y).into());
        constructor.extend(self.construction.to_arguments());
        let source = ConstructorSource::Started(constructor);
        let farm = Farm::start(launch_config(source, 0)?).await?;
        let address = farm.address().to_owned();
        let mut running = Running {
            farms: vec![farm],
            proxies: vec![],
            address: address.clone(),
        };
        let home = IpAddr::from([127, 0, 0, 1]);
        if !delay.is_zero() {
            let proxy = running.delayed((home, 0).into(), home, &address, delay)?;
            running.address = proxy;
        }
        for number in 1..=self.shaders {
            // The constructor takes a shader's address from its connection: clients look for it there.
            let own = IpAddr::from([127, 0, 2, number]);
            let dialled = match delay.is_zero() {
                true => address.clone(),
                false => running.delayed((home, 0).into(), own, &address, delay)?,
            };
            let farm = Farm::start(launch_config(ConstructorSource::Found(dialled), 1)?).await?;
            let listens = farm.shader_addresses().first().cloned();
            running.farms.push(farm);
            let listens = listens.context("the shader does not say where it listens")?;
            if !delay.is_zero() {
                let port = listens.parse::<SocketAddr>()?.port();
                running.delayed((own, port).into(), home, &listens, delay)?;
            }
        }
        Ok(running)
    }
}

impl Running {
    /// A way to that address that takes longer; where it begins.
    fn delayed(
        &mut self,
        listen: SocketAddr,
        from: IpAddr,
        to: &str,
        delay: Duration,
    ) -> anyhow::Result<String> {
        let proxy = Proxy::start(listen, from, to.parse()?);
        let proxy = proxy.with_context(|| format!("cannot put a delay before {to}"))?;
        proxy.set(Weather::Late { delay });
        let address = proxy.address().to_string();
        self.proxies.push(proxy);
        Ok(address)
    }

    async fn end(mut self) {
        // The constructor was the first.
        while let Some(farm) = self.farms.pop() {
            farm.shutdown().await;
        }
    }
}

fn words(words: &[&str]) -> Vec<OsString> {
    words.iter().map(OsString::from).collect()
}

fn launch_config(constructor: ConstructorSource, shaders: usize) -> anyhow::Result<LaunchConfig> {
    Ok(LaunchConfig {
        program: std::env::current_exe().context("cannot find this program")?,
        constructor,
        shader: words(&["shader", "--threads", "1", "--no-cache", "--audit", "0"]),
        shaders,
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
