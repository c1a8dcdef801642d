mod table;

use std::{path::PathBuf, sync::Arc};

use clap::Args;
use glam::UVec2;
use lie_farm::inspect::{OutsidePicture, inspect};
use lie_render::{FrameSettings, World};

use super::{
    render::{Construction, construct},
    view_options::ViewOptions,
};
use crate::{
    args::{self, say, write_json},
    failure::OrUsage,
    process,
};

/// Says of one pixel why it is as bright as it is: its cell, and what is known of each light
/// there, what it gives, what shaders make of it and at which cost.
///
/// Local illumination environments are constructed first, as `lie render` does, until the view
/// has converged or for `--samples` samples. The pixel is looked at through its centre.
#[derive(Args)]
pub(crate) struct Inspect {
    /// A scene: .toml, .glb, .gltf or .obj, or a folder with a scene.toml.
    scene: PathBuf,
    /// The pixel, by column and row from 0,0 at the top left.
    #[arg(long, value_parser = args::pixel, value_name = "X,Y")]
    pixel: UVec2,
    /// List all lights, not only those that give something or are in doubt.
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    view: ViewOptions,
    #[command(flatten)]
    construction: Construction,
    #[command(flatten)]
    lies: args::Lies,
    /// Write everything to this file as JSON, always with all lights.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) fn execute(arguments: &Inspect) -> anyhow::Result<()> {
    let file = arguments.lies.file()?;
    let scene = Arc::new(args::load_scene(&arguments.scene)?);
    let camera = arguments.view.camera(&scene)?;
    let wanted = arguments.view.settings(&scene);
    wanted.validate().or_usage()?;
    let settings = FrameSettings {
        samples_per_pixel: 1,
        seed: arguments.view.seed,
        ..FrameSettings::new(&wanted)
    };
    let (pixel, size) = (arguments.pixel, settings.size);
    // Now, and not after minutes of work.
    if pixel.cmpge(size).any() {
        Err::<(), _>(OutsidePicture { pixel, size }).or_usage()?;
    }
    let threads = process::threads(arguments.view.threads)?;
    let accel = arguments.view.accel.into();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    let world = pool.install(|| Arc::new(World::with_accel(scene, accel)));
    let lies = construct(
        &arguments.construction,
        &world,
        &camera,
        &settings,
        threads,
        file,
    )?;
    let shown = lies.replica.publish();
    let report = inspect(&world, &lies.tree, &shown, &camera, &settings, pixel).or_usage()?;
    if let Some(path) = &arguments.json {
        write_json(path, &serde_json::to_value(&report)?)?;
    }
    table::lines(&report, arguments.all)
        .iter()
        .try_for_each(say)?;
    lies.save()
}
