use std::{path::PathBuf, sync::Arc};

use clap::Args;
use lie_farm::{
    cache::SceneCache,
    network::{Exposure, Ports},
    replay::{self, Recording, ReplayConfig, ReplayError},
    shader::{self, ShaderConfig, ShaderError},
};

use tokio::runtime::Runtime;
use tokio_util::sync::CancellationToken;

use crate::{
    args::{Accel, Audit},
    failure::OrUsage,
    process::{self, Monitoring, Network, Supervision},
};

/// Renders tiles for clients with what the constructor has learnt.
///
/// Prints `listening ADDR` when clients can connect, and nothing else; logs go to standard
/// error. The constructor may come later than the shader, go, and come back.
#[derive(Args)]
pub(crate) struct Shader {
    /// Where the constructor is: HOST:PORT; or `mdns:NAME`, or `mdns` for the only one, to find
    /// one on the local network that was started with `--announce`.
    #[arg(long, value_parser = process::constructor_address, env = "LIE_CONSTRUCTOR", value_name = "ADDR")]
    constructor: String,
    /// Where to take clients; by default any free port, on this machine alone, or on all
    /// networks with `--bundle` or `--insecure`.
    #[arg(long, value_parser = process::address, value_name = "ADDR")]
    listen: Option<String>,
    /// Threads that render; 0 is one for each core.
    #[arg(long, default_value_t = 0, env = "LIE_THREADS", value_name = "N")]
    threads: usize,
    /// What finds hits in the scene. Each process may choose for itself.
    #[arg(long, value_enum, default_value = "bvh")]
    accel: Accel,
    #[command(flatten)]
    audit: Audit,
    /// Where scenes are kept [default: $XDG_CACHE_HOME/lie or ~/.cache/lie]
    #[arg(long, env = "LIE_CACHE", value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Keep no scenes.
    #[arg(long, conflicts_with = "cache")]
    no_cache: bool,
    #[command(flatten)]
    replay: Replay,
    #[command(flatten)]
    network: Network,
    #[command(flatten)]
    monitoring: Monitoring,
    #[command(flatten)]
    supervision: Supervision,
}

/// Standing in for shaders.
#[derive(Args)]
#[command(next_help_heading = "Simulation")]
struct Replay {
    /// Render nothing, but take for each tile the time that this recording of `lie bench scale
    /// --record` says, and answer with a chequerboard. The constructor must have been started with
    /// `--replays`.
    #[arg(long, conflicts_with_all = ["threads", "accel", "audit", "cache", "no_cache", "metrics"], value_name = "FILE")]
    replay: Option<PathBuf>,
    /// Stand in for so many shaders on one thread each. The first listens where `--listen` says, the
    /// others at any free port of the same host.
    #[arg(long, requires = "replay", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=MOST_REPLAYS), value_name = "N")]
    count: u16,
    /// Take so many times as long for each tile as was recorded.
    #[arg(long, requires = "replay", default_value_t = 1.0, value_parser = slow_down, value_name = "K")]
    slow_down: f64,
}

/// As many as a constructor takes.
const MOST_REPLAYS: i64 = lie_protocol::limit::SHADERS as i64;

/// Parses how many times as long something takes.
pub(crate) fn slow_down(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok();
    factor
        .filter(|factor| (0.001..=1.0e6).contains(factor))
        .ok_or_else(|| "expected a number from 0.001 to 1000000, such as 10".to_owned())
}

pub(crate) fn execute(arguments: &Shader) -> anyhow::Result<()> {
    let recording = arguments.replay.replay.as_deref().map(Recording::read);
    let recording = recording.transpose().or_usage()?;
    let exposure = arguments.network.exposure()?;
    let runtime = process::runtime()?;
    let shutdown = process::shutdown(&runtime, Some(arguments.supervision), || process::PATIENCE);
    let ended = match recording {
        Some(recording) => replay(arguments, recording, exposure, &runtime, shutdown),
        None => render(arguments, exposure, &runtime, shutdown),
    };
    runtime.shutdown_background();
    ended
}

fn render(
    arguments: &Shader,
    exposure: Exposure,
    runtime: &Runtime,
    shutdown: CancellationToken,
) -> anyhow::Result<()> {
    let ports = Ports {
        farm: process::listen(runtime, arguments.address(&exposure), &exposure)?,
        metrics: arguments.monitoring.listen(runtime)?,
    };
    let config = ShaderConfig {
        constructor: arguments.constructor.clone(),
        exposure,
        threads: process::threads(arguments.threads)?,
        accel: arguments.accel.into(),
        audit: arguments.audit.audit,
        cache: open_cache(arguments),
    };
    process::announce(&ports.farm)?;
    let ended = runtime.block_on(shader::run(config, ports, shutdown));
    ended.map_err(|error| match error {
        ShaderError::Constructor(error) => process::network_failure(error),
        other => other.into(),
    })
}

fn replay(
    arguments: &Shader,
    recording: Recording,
    exposure: Exposure,
    runtime: &Runtime,
    shutdown: CancellationToken,
) -> anyhow::Result<()> {
    let address = arguments.address(&exposure);
    let mut listeners = vec![process::listen(runtime, address, &exposure)?];
    let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
    for _ in 1..arguments.replay.count {
        let any = format!("{host}:0");
        listeners.push(process::listen(runtime, &any, &exposure)?);
    }
    process::announce(&listeners[0])?;
    let config = ReplayConfig {
        constructor: arguments.constructor.clone(),
        exposure,
        recording: Arc::new(recording),
        slow_down: arguments.replay.slow_down,
    };
    let ended = runtime.block_on(replay::run(config, listeners, shutdown));
    ended.map_err(|error| match error {
        ReplayError::Network(error) => process::network_failure(error),
        other => other.into(),
    })
}

impl Shader {
    /// Where it listens, as was said or as is usual.
    fn address(&self, exposure: &Exposure) -> &str {
        let any = match exposure {
            Exposure::Loopback => "127.0.0.1:0",
            Exposure::Insecure | Exposure::Cluster(_) => "0.0.0.0:0",
        };
        self.listen.as_deref().unwrap_or(any)
    }
}

/// The cache, or a warning: a shader works without.
fn open_cache(arguments: &Shader) -> Option<SceneCache> {
    if arguments.no_cache {
        return None;
    }
    let chosen = arguments.cache.clone();
    let directory = chosen.or_else(SceneCache::default_directory)?;
    match SceneCache::open(&directory) {
        Ok(cache) => Some(cache),
        Err(error) => {
            tracing::warn!("no scenes are kept, {}: {error}", directory.display());
            None
        }
    }
}
