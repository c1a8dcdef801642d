//! A constructor, shaders and a client on this machine.

mod report;

use std::{
    ffi::OsString,
    io::Write,
    path::PathBuf,
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::Context;
use clap::{Args, ValueEnum};
use glam::UVec2;
use indicatif::{ProgressBar, ProgressStyle};
use lie_farm::{
    client::{Client, ClientConfig, FrameRequest},
    convert,
    launch::{Farm, LaunchConfig},
    network::Exposure,
    walk::{WalkConfig, walk},
};
use lie_protocol::{Compression, PixelFormat, SceneSummary, WireIntegrator};
use lie_scene::{KeyFrame, RenderSettings, Walkthrough};

use super::render::Construction;
use crate::{
    args::{self, Integrator, Precision, say, write_json},
    failure::{OrUsage, usage},
    process,
};
use report::Report;

/// Renders a walkthrough on this machine: a constructor, shaders and a client, each a
/// process of its own, as on a cluster.
///
/// Without a window: frames go to `--out`, times and counts to `--stats`.
#[derive(Args)]
pub(crate) struct Run {
    /// A scene: .toml, .glb, .gltf or .obj, or a folder with a scene.toml.
    #[arg(default_value = "scenes/gallery")]
    scene: PathBuf,
    /// Shader processes.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256), value_name = "N")]
    shaders: u32,
    /// Render threads of each shader; 0 shares the cores out among the shaders.
    #[arg(long, default_value_t = 0, value_name = "N")]
    threads: usize,
    /// Walkthrough by name; the scene's first by default. A scene without one is looked at
    /// from its first camera.
    #[arg(long, value_name = "NAME")]
    walk: Option<String>,
    /// Without a window. There is none yet, so this is always so.
    #[arg(long)]
    headless: bool,
    /// Frames, evenly spread over the walkthrough.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=1_000_000), value_name = "N")]
    frames: u32,
    /// Where to write the frames, as frame-0000.exr and so on.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the frames.
    #[arg(long, value_enum, default_value = "exr", value_name = "FORMAT")]
    format: Format,
    /// Bits per channel, on the way from the shaders and in the file.
    #[arg(long, value_enum, default_value = "half")]
    precision: Precision,
    /// Compress pixels on their way; worth it on slow networks only.
    #[arg(long)]
    compress: bool,
    /// Write times and counts of every frame to this file as JSON.
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
    /// Size of the frames in pixels; the scene's setting by default.
    #[arg(long, value_parser = args::size, value_name = "WxH")]
    size: Option<UVec2>,
    /// Camera rays per pixel; the scene's setting by default.
    #[arg(long, value_name = "N")]
    spp: Option<u32>,
    /// Sample points on each area light per camera ray; the scene's setting by default.
    #[arg(long, value_name = "N")]
    light_samples: Option<u32>,
    /// How visibility of lights is found.
    #[arg(long, value_enum, default_value = "lie")]
    integrator: Integrator,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// Before each frame wait until its view has converged, at most this many seconds.
    #[arg(long, num_args = 0..=1, default_missing_value = "60", value_name = "SECONDS")]
    settle: Option<f32>,
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
}

/// Formats of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Linear radiance.
    Exr,
    /// Tone-mapped.
    Png,
    /// Both files for each frame.
    Both,
}

pub(crate) fn execute(arguments: &Run, log: &str) -> anyhow::Result<()> {
    if arguments
        .settle
        .is_some_and(|seconds| !(0.0..1.0e6).contains(&seconds))
    {
        return Err(usage("--settle takes a number of seconds").into());
    }
    if !arguments.scene.exists() {
        return Err(usage(format!(
            "{}: there is no such scene",
            arguments.scene.display()
        ))
        .into());
    }
    if let Some(directory) = &arguments.out {
        std::fs::create_dir_all(directory)
            .with_context(|| format!("cannot make {}", directory.display()))?;
    }
    let runtime = process::runtime()?;
    let shutdown = process::shutdown(&runtime, None);
    let bar = progress_bar(arguments.frames);
    let launch = launch_config(arguments, log, bar.clone())?;
    let result = runtime.block_on(async {
        let farm = tokio::select! {
            started = Farm::start(launch) => started?,
            () = shutdown.cancelled() => anyhow::bail!("interrupted"),
        };
        let walked = tokio::select! {
            walked = take_walk(arguments, farm.address(), &bar) => walked,
            () = shutdown.cancelled() => Err(anyhow::anyhow!("interrupted")),
        };
        farm.shutdown().await;
        walked
    });
    runtime.shutdown_background();
    bar.finish_and_clear();
    let report = result?;
    if let Some(path) = &arguments.stats {
        write_json(path, &report.json())?;
    }
    say(report.summary())
}

async fn take_walk(arguments: &Run, address: &str, bar: &ProgressBar) -> anyhow::Result<Report> {
    let config = ClientConfig::new(address, Exposure::Loopback);
    let mut client = Client::connect(config).await?;
    let settings = render_settings(arguments, client.scene())?;
    let path = path(arguments.walk.as_deref(), client.scene())?;
    let config = WalkConfig {
        frames: arguments.frames,
        settle: arguments.settle.map(Duration::from_secs_f32),
        frame: FrameRequest {
            camera: path.camera_at(0.0),
            size: settings.size,
            samples_per_pixel: settings.samples_per_pixel,
            light_samples: settings.light_samples,
            integrator: match arguments.integrator {
                Integrator::Standard => WireIntegrator::Standard,
                Integrator::Lie => WireIntegrator::Lie,
            },
            seed: arguments.seed,
            format: match arguments.precision {
                Precision::Half => PixelFormat::F16,
                Precision::Float => PixelFormat::F32,
            },
            compression: if arguments.compress {
                Compression::Lz4
            } else {
                Compression::None
            },
        },
        path,
    };
    let clock = Instant::now();
    client.wait_for_shaders(arguments.shaders as usize).await;
    let mut report = Report::new(arguments, settings, client.status(), bar.clone());
    report.joined_ms = clock.elapsed().as_secs_f64() * 1.0e3;
    walk(&mut client, &config, &mut report).await?;
    Ok(report)
}

/// The scene's settings with what the command line says.
fn render_settings(arguments: &Run, scene: &SceneSummary) -> anyhow::Result<RenderSettings> {
    let mut settings = convert::settings(&scene.settings);
    settings.size = arguments.size.unwrap_or(settings.size);
    settings.samples_per_pixel = arguments.spp.unwrap_or(settings.samples_per_pixel);
    settings.light_samples = arguments.light_samples.unwrap_or(settings.light_samples);
    settings.validate().or_usage()?;
    Ok(settings)
}

/// The walkthrough of that name, the first, or the first camera held still.
fn path(name: Option<&str>, scene: &SceneSummary) -> anyhow::Result<Walkthrough> {
    let mut walks = scene.walkthroughs.iter();
    let found = match name {
        None => walks.next(),
        Some(name) => walks.find(|walk| walk.name.as_str() == name),
    };
    if let Some(found) = found {
        return Ok(convert::walkthrough(found));
    }
    if let Some(name) = name {
        let known: Vec<_> = scene
            .walkthroughs
            .iter()
            .map(|walk| walk.name.as_str())
            .collect();
        return Err(usage(format!(
            "the scene has no walkthrough '{name}'; it has: {}",
            if known.is_empty() {
                "none".to_owned()
            } else {
                known.join(", ")
            }
        ))
        .into());
    }
    let camera = scene.cameras.first().context("the scene has no camera")?;
    let camera = convert::camera(camera)?;
    Ok(Walkthrough {
        name: camera.name.clone(),
        key_frames: vec![KeyFrame {
            time_s: 0.0,
            eye: camera.eye,
            orientation: camera.orientation,
            vertical_fov: camera.vertical_fov,
        }],
    })
}

fn launch_config(arguments: &Run, log: &str, bar: ProgressBar) -> anyhow::Result<LaunchConfig> {
    let mut constructor: Vec<OsString> = vec!["constructor".into(), arguments.scene.clone().into()];
    constructor.extend(["--log".into(), log.into()]);
    constructor.extend(["--listen".into(), "127.0.0.1:0".into()]);
    let threads = process::threads(arguments.construct_threads)?;
    constructor.extend(["--threads".into(), threads.to_string().into()]);
    constructor.extend(["--seed".into(), arguments.seed.to_string().into()]);
    constructor.extend(arguments.construction.to_arguments());
    if arguments.freeze {
        constructor.push("--freeze".into());
        if let Some(walk) = &arguments.walk {
            constructor.extend(["--freeze-walk".into(), walk.into()]);
        }
        if let Some(size) = arguments.size {
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
    shader.extend(["--log".into(), log.into()]);
    shader.extend(["--threads".into(), threads.to_string().into()]);
    if let Some(cache) = &arguments.cache {
        shader.extend(["--cache".into(), cache.into()]);
    }
    Ok(LaunchConfig {
        program: std::env::current_exe().context("cannot find this program")?,
        constructor,
        shader,
        shaders: arguments.shaders as usize,
        log: Arc::new(move |who, line| {
            // Nothing is left to do if standard error is closed.
            bar.suspend(|| drop(writeln!(std::io::stderr(), "{who:>11} | {line}")));
        }),
    })
}

/// A bar on standard error; nothing where that is not a terminal.
fn progress_bar(frames: u32) -> ProgressBar {
    let template = "{prefix:>9} [{wide_bar}] {pos}/{len} {msg}";
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(u64::from(frames))
        .with_style(style.progress_chars("=> "))
        .with_prefix("walk")
}
