//! A constructor, shaders and a client on this machine.

use std::{ffi::OsString, io::Write, path::PathBuf, sync::Arc};

use anyhow::Context;
use clap::Args;
use indicatif::ProgressBar;
use lie_farm::{
    client::ClientConfig,
    launch::{self, ConstructorSource, Farm, LaunchConfig},
    network::Exposure,
    secure::{Bundle, Cluster},
    snapshot::SnapshotFile,
};
use lie_render::AccelKind;

use super::{render::Construction, walk::WalkOptions};
use crate::{
    args::{self, Accel, Audit},
    failure::{OrUsage, usage},
    logging::Logging,
    process::{self, Network, Trust},
};

/// Renders a walkthrough on this machine: a constructor, shaders and a client, each a
/// process of its own, as on a cluster.
///
/// Without a window: there is none yet. Frames go to `--out`, times and counts to `--stats`.
///
/// They talk to nobody else: a bundle is made for them that nobody else has, unless `--bundle` names
/// another. With `--insecure` connections within this machine are as they are.
#[derive(Args)]
pub(crate) struct Run {
    /// A scene: .toml, .glb, .gltf or .obj, or a folder with a scene.toml.
    #[arg(default_value = "scenes/gallery")]
    scene: PathBuf,
    /// Shader processes.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=256), value_name = "N")]
    shaders: u32,
    /// Render threads of each shader; 0 shares the cores out among the shaders.
    #[arg(long, default_value_t = 0, value_name = "N")]
    threads: usize,
    /// What finds hits in the scene, in all processes.
    #[arg(long, value_enum, default_value = "bvh")]
    accel: Accel,
    #[command(flatten)]
    walk: WalkOptions,
    /// Construct before the first frame and never again, from what that frame sees: until
    /// converged, or `--samples` samples. Every run then gives the same frames.
    #[arg(long)]
    freeze: bool,
    /// Threads that construct; 0 is one for each core.
    #[arg(long, default_value_t = 0, value_name = "N")]
    construct_threads: usize,
    /// Where shaders keep scenes; their usual place by default.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    #[command(flatten)]
    construction: Construction,
    #[command(flatten)]
    audit: Audit,
    #[command(flatten)]
    lies: args::Lies,
    #[command(flatten)]
    network: Network,
}

/// A bundle that is made for one run holds for longer than any.
const RUN_DAYS: u32 = 365;

pub(crate) fn execute(arguments: &Run, logging: &Logging) -> anyhow::Result<()> {
    if !arguments.scene.exists() {
        let scene = arguments.scene.display();
        return Err(usage(format!("{scene}: there is no such scene")).into());
    }
    let lies = arguments.lies.file()?;
    arguments.walk.prepare()?;
    let runtime = process::runtime()?;
    let shutdown = process::shutdown(&runtime, None, || process::PATIENCE);
    let bar = arguments.walk.progress_bar();
    let bundle = bundle(&arguments.network)?;
    let exposure = match &bundle {
        Some(bundle) => Exposure::Cluster(Cluster::new(bundle).or_usage()?),
        None => Exposure::Loopback,
    };
    let mut launch = launch_config(arguments, lies, logging, bar.clone())?;
    launch.bundle = bundle.map(|bundle| bundle.to_pem());
    let result = runtime.block_on(async {
        let farm = tokio::select! {
            started = Farm::start(launch) => started?,
            () = shutdown.cancelled() => anyhow::bail!("interrupted"),
        };
        let config = ClientConfig::new(farm.address(), exposure);
        let walked = tokio::select! {
            walked = arguments.walk.take(config, arguments.shaders, farm.living_shaders(), &bar) => walked,
            () = shutdown.cancelled() => Err(anyhow::anyhow!("interrupted")),
        };
        farm.shutdown().await;
        walked
    });
    runtime.shutdown_background();
    bar.finish_and_clear();
    arguments.walk.conclude(&result?)
}

/// What protects the connections of this run; nothing with `--insecure`.
fn bundle(network: &Network) -> anyhow::Result<Option<Bundle>> {
    Ok(match network.trust()? {
        Trust::Bundle(bundle) => Some(bundle),
        Trust::Unsaid => Some(Bundle::issue(RUN_DAYS)?),
        Trust::Insecure => None,
    })
}

/// A child logs as we do.
fn log_arguments(logging: &Logging) -> [OsString; 4] {
    [
        "--log".into(),
        logging.log.clone().into(),
        "--log-format".into(),
        logging.log_format.name().into(),
    ]
}

fn launch_config(
    arguments: &Run,
    lies: Option<SnapshotFile>,
    logging: &Logging,
    bar: ProgressBar,
) -> anyhow::Result<LaunchConfig> {
    let mut constructor: Vec<OsString> = vec!["constructor".into(), arguments.scene.clone().into()];
    constructor.extend(log_arguments(logging));
    constructor.extend(["--listen".into(), "127.0.0.1:0".into()]);
    let threads = process::threads(arguments.construct_threads)?;
    constructor.extend(["--threads".into(), threads.to_string().into()]);
    constructor.extend(["--seed".into(), arguments.walk.seed.to_string().into()]);
    let accel = AccelKind::from(arguments.accel).name();
    constructor.extend(["--accel".into(), accel.into()]);
    constructor.extend(arguments.construction.to_arguments());
    if let Some(file) = &lies {
        constructor.extend(["--lies".into(), file.path().into()]);
    }
    if arguments.freeze {
        constructor.push("--freeze".into());
        if let Some(walk) = &arguments.walk.walk {
            constructor.extend(["--freeze-walk".into(), walk.into()]);
        }
        if let Some(size) = arguments.walk.size {
            let size = format!("{}x{}", size.x, size.y);
            constructor.extend(["--freeze-size".into(), size.into()]);
        }
    }
    let shared_out = (process::cores() / arguments.shaders as usize).max(1);
    let threads = match arguments.threads {
        0 => shared_out,
        threads => process::threads(threads)?,
    };
    let mut shader: Vec<OsString> = vec!["shader".into()];
    shader.extend(log_arguments(logging));
    // Nobody else is to come.
    shader.extend(["--listen".into(), "127.0.0.1:0".into()]);
    shader.extend(["--threads".into(), threads.to_string().into()]);
    shader.extend(["--accel".into(), accel.into()]);
    shader.extend(["--audit".into(), arguments.audit.audit.to_string().into()]);
    if let Some(cache) = &arguments.cache {
        shader.extend(["--cache".into(), cache.into()]);
    }
    let format = logging.log_format;
    Ok(LaunchConfig {
        program: std::env::current_exe().context("cannot find this program")?,
        constructor: ConstructorSource::Started(constructor),
        shader,
        shaders: arguments.shaders as usize,
        bundle: None,
        constructor_grace: match lies {
            Some(_) => process::PATIENCE_TO_SAVE,
            None => launch::GRACE,
        },
        log: Arc::new(move |who, line| {
            // Nothing is left to do if standard error is closed.
            let line = format.passed_on(who, line);
            bar.suspend(|| drop(writeln!(std::io::stderr(), "{line}")));
        }),
    })
}
