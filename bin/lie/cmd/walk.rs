//! A walk through a scene that a farm holds, without a window: what `lie run` and
//! `lie view` have in common.

mod report;

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use anyhow::Context;
use clap::{Args, ValueEnum};
use glam::UVec2;
use indicatif::{ProgressBar, ProgressStyle};
use lie_farm::{
    client::{Client, ClientConfig, FrameRequest},
    convert,
    walk::{WalkConfig, walk},
};
use lie_protocol::{SceneSummary, WireIntegrator};
use lie_scene::{KeyFrame, RenderSettings, Walkthrough};
use tokio::sync::watch;

use crate::{
    args::{self, Precision, compression, say, write_json},
    failure::{OrUsage, usage},
    process,
};
pub(crate) use report::Report;

/// Which frames to ask a farm for, and what becomes of them.
#[derive(Args)]
pub(crate) struct WalkOptions {
    /// Walkthrough by name; the scene's first by default. A scene without one is looked at
    /// from its first camera.
    #[arg(long, value_name = "NAME")]
    pub(crate) walk: Option<String>,
    /// Without a window. There is none yet, so this is always so.
    #[arg(long)]
    headless: bool,
    /// Frames, evenly spread over the walkthrough.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=1_000_000), value_name = "N")]
    frames: u32,
    /// Begin with this frame, counted from 0, and leave out those before it: to go on with a
    /// walkthrough that was cut off.
    #[arg(long, default_value_t = 0, value_name = "N")]
    first: u32,
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
    pub(crate) size: Option<UVec2>,
    /// Camera rays per pixel; the scene's setting by default.
    #[arg(long, value_name = "N")]
    spp: Option<u32>,
    /// Sample points on each area light per camera ray; the scene's setting by default.
    #[arg(long, value_name = "N")]
    light_samples: Option<u32>,
    /// How visibility of lights is found.
    #[arg(long, value_enum, default_value = "lie")]
    integrator: FarmIntegrator,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub(crate) seed: u64,
    /// Before each frame wait until its view has converged, at most this many seconds.
    #[arg(long, num_args = 0..=1, default_missing_value = "60", value_name = "SECONDS")]
    settle: Option<f32>,
}

/// How a farm finds the visibility of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FarmIntegrator {
    /// A full shadow ray for every light and sample: the reference.
    Standard,
    /// Local illumination environments.
    Lie,
}

impl FarmIntegrator {
    /// Its name on the command line and in statistics.
    fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Lie => "lie",
        }
    }
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

impl WalkOptions {
    /// What can be checked and made before anything is started.
    pub(crate) fn prepare(&self) -> anyhow::Result<()> {
        let possible = |seconds: &f32| (0.0..1.0e6).contains(seconds);
        if !self.settle.as_ref().is_none_or(possible) {
            return Err(usage("--settle takes a number of seconds").into());
        }
        if self.first >= self.frames {
            let (first, frames) = (self.first, self.frames);
            let complaint = format!("--first {first}: there are {frames} frames, counted from 0");
            return Err(usage(complaint).into());
        }
        if let Some(directory) = &self.out {
            std::fs::create_dir_all(directory)
                .with_context(|| format!("cannot make {}", directory.display()))?;
        }
        Ok(())
    }

    /// Connects to a constructor, waits for as many shaders as are `living`, and walks.
    /// `shaders` is how many were asked for.
    pub(crate) async fn take(
        &self,
        config: ClientConfig,
        shaders: u32,
        mut living: watch::Receiver<usize>,
        bar: &ProgressBar,
    ) -> anyhow::Result<Report> {
        let mut client = Client::connect(config)
            .await
            .map_err(process::client_failure)?;
        let settings = self.render_settings(client.scene())?;
        let path = path(self.walk.as_deref(), client.scene())?;
        let config = WalkConfig {
            frames: self.frames,
            first: self.first,
            settle: self.settle.map(Duration::from_secs_f32),
            frame: FrameRequest {
                camera: path.camera_at(0.0),
                size: settings.size,
                samples_per_pixel: settings.samples_per_pixel,
                light_samples: settings.light_samples,
                integrator: match self.integrator {
                    FarmIntegrator::Standard => WireIntegrator::Standard,
                    FarmIntegrator::Lie => WireIntegrator::Lie,
                },
                seed: self.seed,
                format: self.precision.into(),
                compression: compression(self.compress),
            },
            path,
        };
        let clock = Instant::now();
        loop {
            let expected = *living.borrow_and_update();
            tokio::select! {
                () = client.wait_for_shaders(expected) => break,
                // One that ended is not waited for.
                Ok(()) = living.changed() => {}
            }
        }
        let mut report = Report::new(
            self,
            (client.scene().name.as_str(), shaders),
            settings,
            client.status(),
            bar.clone(),
        );
        report.joined_ms = clock.elapsed().as_secs_f64() * 1.0e3;
        walk(&mut client, &config, &mut report).await?;
        Ok(report)
    }

    /// Writes the statistics and the closing line.
    pub(crate) fn conclude(&self, report: &Report) -> anyhow::Result<()> {
        if let Some(path) = &self.stats {
            write_json(path, &report.json())?;
        }
        say(report.summary())
    }

    /// The scene's settings with what the command line says.
    fn render_settings(&self, scene: &SceneSummary) -> anyhow::Result<RenderSettings> {
        let mut settings = convert::settings(&scene.settings);
        settings.size = self.size.unwrap_or(settings.size);
        settings.samples_per_pixel = self.spp.unwrap_or(settings.samples_per_pixel);
        settings.light_samples = self.light_samples.unwrap_or(settings.light_samples);
        settings.validate().or_usage()?;
        Ok(settings)
    }

    /// A bar on standard error; nothing where that is not a terminal.
    pub(crate) fn progress_bar(&self) -> ProgressBar {
        let template = "{prefix:>9} [{wide_bar}] {pos}/{len} {msg}";
        let style =
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        ProgressBar::new(u64::from(self.frames))
            .with_style(style.progress_chars("=> "))
            .with_prefix("walk")
    }
}

/// The walkthrough of that name, the first, or the first camera held still.
fn path(name: Option<&str>, scene: &SceneSummary) -> anyhow::Result<Walkthrough> {
    let mut walks = scene.walkthroughs.iter();
    let found = match name {
        None => walks.next(),
        Some(name) => walks.find(|walk| walk.name.as_str() == name),
    };
    if let Some(found) = found {
        return Ok(convert::walkthrough(found)?);
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
