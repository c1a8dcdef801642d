use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use clap::Args;
use glam::UVec2;
use lie_farm::{
    ConstructSettings, View,
    constructor::{self, ConstructorConfig, Freeze, Prepared},
    discovery::{Announcement, Name},
    network::{Exposure, Ports},
};
use lie_scene::Scene;
use tokio::net::TcpListener;

use super::render::Construction;
use crate::{
    args::{self, Accel},
    process::{self, Monitoring, Network, Supervision},
};

/// Holds the scene, learns which lights reach where, and tells the shaders.
///
/// Prints `listening ADDR` when shaders and clients can connect, and nothing else; logs go
/// to standard error. Shaders get the scene from here: they need no files.
#[derive(Args)]
pub(crate) struct Constructor {
    /// A scene: .toml, .glb, .gltf or .obj, or a folder with a scene.toml.
    scene: PathBuf,
    /// Where to take shaders and clients; port 0 is any free one.
    #[arg(long, default_value = "127.0.0.1:7400", value_parser = process::address, env = "LIE_LISTEN", value_name = "ADDR")]
    listen: String,
    /// Say on the local network, by multicast DNS, that a constructor of this name is here, so that
    /// `--constructor mdns:NAME` finds it; the machine's name by default. Who connects has to have the bundle all the same.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "", value_name = "NAME")]
    announce: Option<String>,
    /// Threads that construct; 0 is one for each core.
    #[arg(long, default_value_t = 0, value_name = "N")]
    threads: usize,
    /// What finds hits in the scene. Each process may choose for itself.
    #[arg(long, value_enum, default_value = "bvh")]
    accel: Accel,
    /// Seed of the construction samples.
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// Take shaders that replay recorded costs (`lie shader --replay`) as well: for simulations.
    /// Without this they are refused.
    #[arg(long)]
    replays: bool,
    #[command(flatten)]
    frozen: Frozen,
    #[command(flatten)]
    construction: Construction,
    #[command(flatten)]
    lies: args::Lies,
    #[command(flatten)]
    network: Network,
    #[command(flatten)]
    monitoring: Monitoring,
    #[command(flatten)]
    supervision: Supervision,
}

/// Construction before anybody connects.
#[derive(Args)]
#[command(next_help_heading = "Frozen construction")]
pub(crate) struct Frozen {
    /// Construct before anybody connects, and never again: every start gives the same
    /// LIEs, and so the same pictures. Constructs `--samples` samples of one view, or until
    /// that view has converged.
    #[arg(long)]
    pub(crate) freeze: bool,
    /// Freeze what the first frame of this walkthrough sees; the scene's first walkthrough
    /// by default, or its first camera if it has none.
    #[arg(long, requires = "freeze", value_name = "NAME")]
    freeze_walk: Option<String>,
    /// Size of the frozen view in pixels; the scene's setting by default.
    #[arg(long, requires = "freeze", value_parser = args::size, value_name = "WxH")]
    freeze_size: Option<UVec2>,
}

impl Frozen {
    fn view(&self, scene: &Scene) -> anyhow::Result<View> {
        let camera = if scene.walkthroughs.is_empty() && self.freeze_walk.is_none() {
            args::find_camera(scene, None)?.clone()
        } else {
            args::find_walkthrough(scene, self.freeze_walk.as_deref())?.camera_at(0.0)
        };
        Ok(View {
            camera,
            size: self.freeze_size.unwrap_or(scene.settings.size),
        })
    }
}

/// What is to be said on the local network, if anything.
fn announcement(
    arguments: &Constructor,
    listener: &TcpListener,
    exposure: &Exposure,
) -> anyhow::Result<Option<Announcement>> {
    let Some(name) = &arguments.announce else {
        return Ok(None);
    };
    let name = match name.as_str() {
        "" => Ok(Name::of_this_machine()),
        name => Name::new(name),
    };
    let at = listener.local_addr()?;
    let announcement = name.and_then(|name| Announcement::new(&name, at, exposure));
    announcement.map(Some).map_err(process::discovery_failure)
}

pub(crate) fn execute(arguments: &Constructor) -> anyhow::Result<()> {
    let lies = arguments.lies.file()?;
    let exposure = arguments.network.exposure()?;
    let runtime = process::runtime()?;
    // What is learnt before anybody connects is nothing to wait for: another start learns the same.
    let has_to_save = Arc::new(AtomicBool::new(false));
    let saves = has_to_save.clone();
    let patience = move || match saves.load(Ordering::Relaxed) {
        true => process::PATIENCE_TO_SAVE,
        false => process::PATIENCE,
    };
    let shutdown = process::shutdown(&runtime, Some(arguments.supervision), patience);
    let ports = Ports {
        farm: process::listen(&runtime, &arguments.listen, &exposure)?,
        metrics: arguments.monitoring.listen(&runtime)?,
    };
    let announcement = announcement(arguments, &ports.farm, &exposure)?;

    let scene = args::load_scene(&arguments.scene)?;
    let freeze = arguments.frozen.freeze.then(|| {
        Ok::<_, anyhow::Error>(Freeze {
            samples: arguments.construction.samples,
            view: arguments.frozen.view(&scene)?,
        })
    });
    let config = ConstructorConfig {
        exposure,
        accel: arguments.accel.into(),
        construct: ConstructSettings {
            threads: process::threads(arguments.threads)?,
            seed: arguments.seed,
            ..arguments.construction.settings(&scene)
        },
        freeze: freeze.transpose()?,
        lies,
        takes_replays: arguments.replays,
    };
    let prepared = Prepared::new(scene, &config)?;
    has_to_save.store(config.lies.is_some(), Ordering::Relaxed);

    process::announce(&ports.farm)?;
    let _announced = announcement.map(Announcement::start).transpose()?;
    runtime.block_on(constructor::run(config, prepared, ports, shutdown))?;
    runtime.shutdown_background();
    Ok(())
}
