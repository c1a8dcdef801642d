use clap::Args;
use lie_farm::client::ClientConfig;
use tokio::sync::watch;

use super::walk::WalkOptions;
use crate::process::{self, Network};

/// Looks at the scene of a running farm: renders a walkthrough with its shaders.
///
/// Without a window: there is none yet. Frames go to `--out`, times and counts to `--stats`.
#[derive(Args)]
pub(crate) struct View {
    /// Where the constructor listens: HOST:PORT; or `mdns:NAME`, or `mdns` for the only one, to find
    /// one on the local network that was started with `--announce`.
    #[arg(long, value_parser = process::constructor_address, env = "LIE_CONSTRUCTOR", value_name = "ADDR")]
    constructor: String,
    /// Wait for so many shaders before the first frame; more are used as they come.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024), value_name = "N")]
    wait_shaders: u32,
    #[command(flatten)]
    walk: WalkOptions,
    #[command(flatten)]
    network: Network,
}

pub(crate) fn execute(arguments: &View) -> anyhow::Result<()> {
    arguments.walk.prepare()?;
    let exposure = arguments.network.exposure()?;
    let runtime = process::runtime()?;
    let shutdown = process::shutdown(&runtime, None, || process::PATIENCE);
    let bar = arguments.walk.progress_bar();
    let config = ClientConfig::new(&arguments.constructor, exposure);
    // Who they are is not for us to say: all are waited for.
    let (_all, living) = watch::channel(arguments.wait_shaders as usize);
    let result = runtime.block_on(async {
        tokio::select! {
            walked = arguments.walk.take(config, arguments.wait_shaders, living, &bar) => walked,
            () = shutdown.cancelled() => Err(anyhow::anyhow!("interrupted")),
        }
    });
    runtime.shutdown_background();
    bar.finish_and_clear();
    arguments.walk.conclude(&result?)
}
