use std::{ffi::OsString, io::Write, sync::Arc};

use anyhow::Context;
use clap::Args;
use lie_bench::{
    Stage,
    farm::{self, FarmConfig, FarmRow, SeveralRow},
};
use lie_farm::{
    PublishedLies, View,
    client::{Client, ClientConfig, FrameRequest},
    constructor::{self, ConstructorConfig, Freeze, Prepared},
    launch::{self, ConstructorSource, LaunchConfig},
    network::{self, Exposure},
};
use lie_protocol::WireIntegrator;
use tokio::runtime::Runtime;
use tokio_util::sync::CancellationToken;

use super::{
    construct_settings,
    output::{Output, progress_bar, teller},
    subject::Subject,
    threads::Threads,
};
use crate::{
    args::{Precision, compression, say},
    cmd::render::Construction,
    process,
};

/// What a farm costs: frames of one shader process in turn with those of this process, on as many
/// threads.
///
/// LIEs of the view are constructed once, for both, and are frozen; the shader does not audit. The
/// constructor and the client are in this process, and all connections are TCP on this machine.
#[derive(Args)]
pub(crate) struct Farm {
    #[command(flatten)]
    subject: Subject,
    /// Frames of each, in turn; times and ratios are medians.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    repeat: u32,
    /// Measure so many shaders in turn with one as well, each on as many threads as is said.
    #[arg(long, value_parser = clap::value_parser!(u8).range(2..=64), value_name = "N")]
    shaders: Option<u8>,
    #[command(flatten)]
    threads: Threads,
    /// Bits per channel on the way.
    #[arg(long, value_enum, default_value = "half")]
    precision: Precision,
    /// Compress pixels on their way.
    #[arg(long)]
    compress: bool,
    #[command(flatten)]
    construction: Construction,
    #[command(flatten)]
    output: Output,
}

/// A constructor in this process that has learnt what it will, and its LIEs.
struct Learnt {
    address: String,
    lies: PublishedLies,
    shutdown: CancellationToken,
}

impl Farm {
    pub(super) fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        let threads = self.threads.counts()?;
        let runtime = process::runtime()?;
        let (mut rows, mut several) = (vec![], vec![]);
        for scene in self.subject.load()? {
            let stage = scene.stage();
            let learnt = self.learn(&runtime, &stage)?;
            for &threads in &threads {
                rows.push(self.measure(&runtime, &stage, &learnt, threads)?);
                if let Some(shaders) = self.shaders {
                    let row = self.compare(&runtime, &stage, &learnt, (shaders.into(), threads));
                    several.push(row?);
                }
                let parts = [
                    ("rows", farm::json(&rows)),
                    ("several", farm::several_json(&several)),
                ];
                self.output.write_json(&parts)?;
                self.output
                    .write_report("farm", "Farm", || Ok(vec![farm::section(&rows)]))?;
            }
            learnt.shutdown.cancel();
        }
        runtime.shutdown_background();
        say(farm::table(&rows).text())?;
        if !several.is_empty() {
            say(farm::several_table(&several).text())?;
        }
        self.output.announce("farm")
    }

    /// Constructs until the view has converged, and serves that.
    fn learn(&self, runtime: &Runtime, stage: &Stage) -> anyhow::Result<Learnt> {
        let bar = progress_bar();
        bar.set_message(format!("{}: construct", stage.name()));
        bar.tick();
        let config = ConstructorConfig {
            exposure: Exposure::Loopback,
            accel: stage.accel(),
            construct: construct_settings(&self.construction, stage),
            freeze: Some(Freeze {
                samples: self.construction.samples,
                view: View {
                    camera: stage.camera().clone(),
                    size: stage.settings().size,
                },
            }),
            lies: None,
            takes_replays: false,
        };
        let prepared = Prepared::new(stage.world().scene().clone(), &config)?;
        bar.finish_and_clear();
        let lies = prepared.lies(stage.world().clone());
        let listener = runtime.block_on(network::bind("127.0.0.1:0", &Exposure::Loopback))?;
        let address = listener.local_addr()?.to_string();
        let shutdown = CancellationToken::new();
        // If it ends early, the frames say so: no shader comes.
        runtime.spawn(constructor::run(
            config,
            prepared,
            listener,
            shutdown.clone(),
        ));
        Ok(Learnt {
            address,
            lies,
            shutdown,
        })
    }

    fn measure(
        &self,
        runtime: &Runtime,
        stage: &Stage,
        learnt: &Learnt,
        threads: usize,
    ) -> anyhow::Result<FarmRow> {
        let launch = launch_config(&learnt.address, stage, (1, threads))?;
        let shaders = runtime.block_on(launch::Farm::start(launch))?;
        let client_config = ClientConfig::new(&learnt.address, Exposure::Loopback);
        let mut client = runtime.block_on(Client::connect(client_config))?;
        let request = self.request(stage);
        let config = FarmConfig {
            threads,
            repeat: self.repeat,
            precision: self.precision.into(),
        };
        let bar = progress_bar();
        let mut frame = || runtime.block_on(client.render_frame(&request));
        let row = farm::measure(stage, &learnt.lies, &config, &mut frame, &teller(&bar));
        bar.finish_and_clear();
        drop(client);
        runtime.block_on(shaders.shutdown());
        Ok(row?)
    }

    /// One shader, and several, each farm with a constructor of its own that has learnt the same.
    fn compare(
        &self,
        runtime: &Runtime,
        stage: &Stage,
        learnt: &Learnt,
        (shaders, threads): (usize, usize),
    ) -> anyhow::Result<SeveralRow> {
        let other = self.learn(runtime, stage)?;
        let start = |address: &str, shaders| {
            let launch = launch_config(address, stage, (shaders, threads))?;
            let farm = runtime.block_on(launch::Farm::start(launch))?;
            let config = ClientConfig::new(address, Exposure::Loopback);
            let client = runtime.block_on(async {
                let client = Client::connect(config).await?;
                client.wait_for_shaders(shaders).await;
                Ok::<_, anyhow::Error>(client)
            })?;
            Ok::<_, anyhow::Error>((farm, client))
        };
        let (one, mut of_one) = start(&learnt.address, 1)?;
        let (several, mut of_several) = start(&other.address, shaders)?;
        let request = self.request(stage);
        let bar = progress_bar();
        let row = farm::measure_several(
            stage,
            (shaders, threads),
            self.repeat,
            &mut || runtime.block_on(of_one.render_frame(&request)),
            &mut || runtime.block_on(of_several.render_frame(&request)),
            &teller(&bar),
        );
        bar.finish_and_clear();
        drop((of_one, of_several));
        runtime.block_on(async { tokio::join!(one.shutdown(), several.shutdown()) });
        other.shutdown.cancel();
        Ok(row?)
    }

    fn request(&self, stage: &Stage) -> FrameRequest {
        let settings = stage.settings();
        FrameRequest {
            camera: stage.camera().clone(),
            size: settings.size,
            samples_per_pixel: settings.samples_per_pixel,
            light_samples: settings.light_samples,
            integrator: WireIntegrator::Lie,
            seed: settings.seed,
            format: self.precision.into(),
            compression: compression(self.compress),
        }
    }
}

/// Shaders that do nothing but render.
fn launch_config(
    constructor: &str,
    stage: &Stage,
    (shaders, threads): (usize, usize),
) -> anyhow::Result<LaunchConfig> {
    let mut shader: Vec<OsString> = vec!["shader".into(), "--no-cache".into()];
    shader.extend(["--threads".into(), threads.to_string().into()]);
    shader.extend(["--accel".into(), stage.accel().name().into()]);
    shader.extend(["--audit".into(), "0".into()]);
    Ok(LaunchConfig {
        program: std::env::current_exe().context("cannot find this program")?,
        constructor: ConstructorSource::Found(constructor.to_owned()),
        shader,
        shaders,
        bundle: None,
        constructor_grace: launch::GRACE,
        log: Arc::new(|who, line| {
            // Nothing is left to do if standard error is closed.
            drop(writeln!(std::io::stderr(), "{who:>11} | {line}"));
        }),
    })
}
