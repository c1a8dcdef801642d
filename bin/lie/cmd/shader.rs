use std::path::PathBuf;

use clap::Args;
use lie_farm::{
    cache::SceneCache,
    network::{Exposure, Ports},
    shader::{self, ShaderConfig, ShaderError},
};

use crate::{
    args::{Accel, Audit},
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
    network: Network,
    #[command(flatten)]
    monitoring: Monitoring,
    #[command(flatten)]
    supervision: Supervision,
}

pub(crate) fn execute(arguments: &Shader) -> anyhow::Result<()> {
    let exposure = arguments.network.exposure()?;
    let runtime = process::runtime()?;
    let shutdown = process::shutdown(&runtime, Some(arguments.supervision), || process::PATIENCE);
    let any = match exposure {
        Exposure::Loopback => "127.0.0.1:0",
        Exposure::Insecure | Exposure::Cluster(_) => "0.0.0.0:0",
    };
    let address = arguments.listen.as_deref().unwrap_or(any);
    let ports = Ports {
        farm: process::listen(&runtime, address, &exposure)?,
        metrics: arguments.monitoring.listen(&runtime)?,
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
    runtime.shutdown_background();
    ended.map_err(|error| match error {
        ShaderError::Constructor(error) => process::network_failure(error),
        other => other.into(),
    })
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
