mod aovs;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant},
};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use lie_farm::{
    BatchReport, Builder, ConstructSettings, LieReplica, Order, Snapshot, View,
    snapshot::{self, SnapshotFile},
};
use lie_octree::LieTree;
use lie_protocol::SceneHash;
use lie_render::{AccelKind, Film, FrameSettings, LieLookup, RenderStats, ToneMap, World};
use lie_scene::Camera;

use super::view_options::ViewOptions;
use crate::{
    args::{self, Integrator, Precision, ToneCurve, say, write_json},
    failure::{OrUsage, usage},
    process,
};

/// Renders one frame in this process, without a network.
///
/// With `--integrator lie`, local illumination environments are constructed first, until
/// the view has converged (or for `--samples` samples), or taken from `--lies FILE`; then the
/// frame alone is timed.
#[derive(Args)]
pub(crate) struct Render {
    /// A scene: .toml, .glb, .gltf or .obj, or a folder with a scene.toml.
    scene: PathBuf,
    /// How visibility of lights is found.
    #[arg(long, value_enum, default_value = "lie")]
    integrator: Integrator,
    /// Share of a point's light below which `--integrator ward` estimates the lights that
    /// would give least together, instead of testing them; 0 tests all.
    #[arg(long, value_parser = args::share, default_value_t = 0.05, allow_negative_numbers = true, value_name = "SHARE")]
    ward_threshold: f32,
    #[command(flatten)]
    view: ViewOptions,
    /// Camera rays per pixel; the scene's setting by default.
    #[arg(long, value_name = "N")]
    spp: Option<u32>,
    /// Where to write the picture: linear radiance as .exr, or a tone-mapped .png.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write the picture and its AOVs to this .exr as well, one layer for each: albedo,
    /// normal, cost (nanoseconds by a model, not by a clock), the work that it counts, and
    /// with LIEs each pixel's cell, its lights by class and the error to be expected. Not part
    /// of the frame's time.
    #[arg(long, value_name = "FILE.exr")]
    aovs: Option<PathBuf>,
    /// Bits per channel of an EXR. `half` are the pixels that a farm sends by default.
    #[arg(long, value_enum, default_value = "float")]
    precision: Precision,
    /// Exposure of a PNG in stops; the scene's setting by default.
    #[arg(long, allow_negative_numbers = true, value_name = "STOPS")]
    exposure: Option<f32>,
    /// Tone curve of a PNG.
    #[arg(long, value_enum, default_value = "aces")]
    tone: ToneCurve,
    /// Render the frame this often and report the median time.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    repeat: u32,
    #[command(flatten)]
    construction: Construction,
    /// Write times and counts to this file as JSON.
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
    #[command(flatten)]
    lies: args::Lies,
}

/// How local illumination environments are constructed.
#[derive(Args)]
#[command(next_help_heading = "Construction")]
pub(crate) struct Construction {
    /// Construct exactly this many samples (in whole batches) instead of until converged.
    #[arg(long, value_name = "N")]
    pub(crate) samples: Option<u64>,
    /// Samples that must agree on a light in a cell before it is relied on, if it gives all
    /// of a pixel's light; in proportion fewer if it gives less. Until then its shadow rays
    /// are traced through the scene. Where geometry was asked and could not settle a light it
    /// takes four times as many. 0 is the paper, which has no --crowd, --split-samples 1 and
    /// --from-scratch besides.
    #[arg(long, value_name = "N")]
    trust: Option<u32>,
    /// Levels below the root that the octree may reach, 1 to 20; the scene's by default.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=20), value_name = "N")]
    max_depth: Option<u32>,
    /// Occluders in a cell above which it splits. By default the scene's setting, or 24 divided
    /// by the rays that a point sends to a light, in the mean: sample points on an area light
    /// each need one.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    split: Option<u32>,
    /// Samples that must come from a cell at once for it to split: cells of a few pixels
    /// would never see enough of their lights. With --trust 0 twice as many, less one, if
    /// lights have an extent. 1 is the paper.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    split_samples: Option<u32>,
    /// Occluders of one light in one cell above which its shadow rays go through the scene,
    /// which is cheaper then; the paper has no such limit.
    #[arg(long, value_name = "N")]
    crowd: Option<u32>,
    /// Leave out shadows that nobody sees: in each cell those of lights that others outshine,
    /// as long as all that is wrong by it is at most this share of its darkest point's light.
    /// 0.02 is the paper's; 0, the default, leaves out none.
    #[arg(long, value_parser = args::share, allow_negative_numbers = true, value_name = "FRACTION")]
    masking: Option<f32>,
    /// Let the parts of a cell that splits start from nothing, as in the paper, instead of
    /// with what is known of the whole.
    #[arg(long)]
    from_scratch: bool,
    /// Do not settle lights by geometry: know of them by samples alone. So it is with --trust
    /// 0 and with --masking.
    #[arg(long)]
    no_proofs: bool,
    /// Sample every point that a view shows, in the order of space, in each pass, instead of
    /// those where most of a pixel's light is in doubt.
    #[arg(long)]
    in_order: bool,
}

impl Construction {
    /// The same again, for another process.
    pub(crate) fn to_arguments(&self) -> Vec<std::ffi::OsString> {
        let given = [
            ("--samples", self.samples.map(|count| count.to_string())),
            ("--trust", self.trust.map(|count| count.to_string())),
            ("--max-depth", self.max_depth.map(|count| count.to_string())),
            ("--split", self.split.map(|count| count.to_string())),
            (
                "--split-samples",
                self.split_samples.map(|count| count.to_string()),
            ),
            ("--crowd", self.crowd.map(|count| count.to_string())),
            ("--masking", self.masking.map(|share| share.to_string())),
        ];
        let flags = [
            self.from_scratch.then(|| "--from-scratch".into()),
            self.no_proofs.then(|| "--no-proofs".into()),
            self.in_order.then(|| "--in-order".into()),
        ];
        given
            .into_iter()
            .filter_map(|(name, value)| Some([name.into(), value?.into()]))
            .flatten()
            .chain(flags.into_iter().flatten())
            .collect()
    }

    /// Settings for a scene, with what the command line says.
    pub(crate) fn settings(&self, scene: &lie_scene::Scene) -> ConstructSettings {
        let mut settings = ConstructSettings::new(scene);
        settings.lie.trust = self.trust.unwrap_or(settings.lie.trust);
        settings.lie.split_samples = self.split_samples.unwrap_or(settings.lie.split_samples);
        settings.lie.crowd = self.crowd.unwrap_or(settings.lie.crowd);
        settings.lie.masking = self.masking.unwrap_or(settings.lie.masking);
        settings.lie.inherit = !self.from_scratch;
        settings.proofs = !self.no_proofs;
        if self.in_order {
            settings.order = Order::Space;
        }
        settings.lie.max_depth = self.max_depth.unwrap_or(settings.lie.max_depth);
        settings.lie.split_threshold = self.split.unwrap_or(settings.lie.split_threshold);
        settings
    }
}

pub(crate) fn execute(arguments: &Render) -> anyhow::Result<()> {
    if !is_picture(&arguments.out) {
        return Err(usage(format!(
            "{}: expected a name that ends in .exr or .png",
            arguments.out.display()
        ))
        .into());
    }
    // Now, and not after minutes of work.
    if let Some(path) = &arguments.aovs {
        aovs::check(path, &arguments.out)?;
    }
    for path in std::iter::once(&arguments.out).chain(&arguments.aovs) {
        check_folder(path)?;
    }
    let lies = arguments.lies.file()?;
    let scene = Arc::new(args::load_scene(&arguments.scene)?);
    let camera = arguments.view.camera(&scene)?;
    let settings = frame_settings(arguments, &scene)?;
    let threads = process::threads(arguments.view.threads)?;
    if scene.lights.is_empty() {
        tracing::warn!("the scene has no lights: the picture will be black but for what emits");
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;

    let clock = Instant::now();
    let accel = arguments.view.accel.into();
    let world = pool.install(|| Arc::new(World::with_accel(scene.clone(), accel)));
    let build_ms = milliseconds(clock.elapsed());

    let construction = (arguments.integrator == Integrator::Lie)
        .then(|| {
            let construction = &arguments.construction;
            construct(construction, &world, &camera, &settings, threads, lies)
        })
        .transpose()?;
    let frame =
        pool.install(|| render(arguments, &world, &camera, &settings, construction.as_ref()));
    write_picture(arguments, &scene, &frame.film)?;
    let constructed = construction.as_ref();
    // What is expected of a frame with LIEs takes the same pass.
    let is_asked = arguments.aovs.is_some() || (arguments.stats.is_some() && constructed.is_some());
    let find = || aovs::find(&world, &camera, &settings, constructed);
    let aovs = is_asked.then(|| pool.install(find));
    if let (Some(path), Some(aovs)) = (&arguments.aovs, &aovs) {
        lie_render::write_aovs(path, &frame.film, arguments.precision.into(), aovs)?;
    }
    let expected_error = aovs
        .filter(|_| constructed.is_some())
        .map(|aovs| aovs::expected_error(&aovs, &frame.film));

    if let Some(path) = &arguments.stats {
        let stats = statistics(
            arguments,
            &settings,
            threads,
            (&world, build_ms),
            &frame,
            constructed.zip(expected_error),
        );
        write_json(path, &stats)?;
    }
    if let Some(construction) = &construction {
        construction.save()?;
    }
    let size = settings.size;
    say(format_args!(
        "{}: {} x {} pixels in {:.1} ms on {threads} threads ({})",
        arguments.out.display(),
        size.x,
        size.y,
        frame.median_ms,
        arguments.integrator.name(),
    ))?;
    expected_error.map_or(Ok(()), |error| {
        say(format_args!("expected error {:.4} %", 100.0 * error))
    })
}

fn check_folder(path: &Path) -> anyhow::Result<()> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    match folder.filter(|folder| !folder.is_dir()) {
        Some(folder) => anyhow::bail!(
            "{}: there is no folder {}",
            path.display(),
            folder.display()
        ),
        None => Ok(()),
    }
}

fn is_picture(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    ending.is_some_and(|ending| ending == "exr" || ending == "png")
}

fn frame_settings(arguments: &Render, scene: &lie_scene::Scene) -> anyhow::Result<FrameSettings> {
    let mut wanted = arguments.view.settings(scene);
    wanted.samples_per_pixel = arguments.spp.unwrap_or(wanted.samples_per_pixel);
    wanted.exposure_stops = arguments.exposure.unwrap_or(wanted.exposure_stops);
    wanted.validate().or_usage()?;
    let settings = FrameSettings::new(&wanted);
    Ok(FrameSettings {
        seed: arguments.view.seed,
        ward: (arguments.integrator == Integrator::Ward).then_some(arguments.ward_threshold),
        ..settings
    })
}

/// LIEs for the view, and what they took.
pub(crate) struct Constructed {
    pub(crate) tree: LieTree,
    pub(crate) replica: LieReplica,
    report: BatchReport,
    stats: lie_octree::LieStats,
    milliseconds: f64,
    /// What is to be saved, where, and of which scene.
    unsaved: Option<(SnapshotFile, Snapshot, SceneHash)>,
}

impl Constructed {
    /// Saves what was learnt, if it is to be kept.
    pub(crate) fn save(&self) -> anyhow::Result<()> {
        if let Some((file, snapshot, scene)) = &self.unsaved {
            file.save(snapshot, *scene)?;
        }
        Ok(())
    }
}

/// Constructs LIEs for a frame, until the view has converged or as long as was asked for.
pub(crate) fn construct(
    construction: &Construction,
    world: &Arc<World>,
    camera: &Camera,
    frame: &FrameSettings,
    threads: usize,
    lies: Option<SnapshotFile>,
) -> anyhow::Result<Constructed> {
    /// Passes over the view after which construction gives up waiting for convergence.
    const MAX_PASSES: u64 = 64;
    let settings = ConstructSettings {
        threads,
        seed: frame.seed,
        ..construction.settings(world.scene())
    };
    let clock = Instant::now();
    let mut builder = Builder::new(world.clone(), settings)?;
    let lies = lies.map(|file| {
        let hash = snapshot::scene_hash(world.scene())?;
        file.restore(&mut builder, hash)?;
        Ok::<_, anyhow::Error>((file, hash))
    });
    let lies = lies.transpose()?;
    let size = frame.size;
    let views = [View {
        camera: camera.clone(),
        size,
    }];
    let pixels = u64::from(size.x) * u64::from(size.y);
    let bar = progress_bar("construct", construction.samples.unwrap_or(pixels));
    let tell = |report: &BatchReport| {
        bar.set_length(bar.length().unwrap_or(0).max(report.taken));
        bar.set_position(report.taken);
        let error = report
            .estimated_error
            .map_or("…".into(), |error| format!("{:.3} %", 100.0 * error));
        bar.set_message(format!("error {error}"));
    };
    let report = match construction.samples {
        Some(samples) => builder.sample(&views, samples, tell),
        None => builder.converge(&views, pixels * MAX_PASSES, tell),
    };
    bar.finish_and_clear();
    if !report.converged && construction.samples.is_none() {
        tracing::warn!("the view has not converged after {MAX_PASSES} passes");
    }
    let replica = LieReplica::of(world.clone(), builder.tree());
    Ok(Constructed {
        tree: builder.tree().clone(),
        replica,
        report,
        stats: builder.tree().stats(),
        milliseconds: milliseconds(clock.elapsed()),
        unsaved: lies
            .filter(|_| builder.taken() > 0)
            .map(|(file, hash)| (file, builder.snapshot(), hash)),
    })
}

/// A finished frame.
struct Frame {
    film: Film,
    stats: RenderStats,
    median_ms: f64,
    min_ms: f64,
    max_ms: f64,
}

fn render(
    arguments: &Render,
    world: &World,
    camera: &Camera,
    settings: &FrameSettings,
    constructed: Option<&Constructed>,
) -> Frame {
    let lies = constructed.map(|constructed| constructed.replica.publish());
    let lookup = lies.as_ref().map(|lies| lies as &dyn LieLookup);
    let bar = progress_bar("render", 1000 * u64::from(arguments.repeat));
    let mut times = vec![];
    let mut last = None;
    for repetition in 0..u64::from(arguments.repeat) {
        let clock = Instant::now();
        let progress = bar.clone();
        let mut tell =
            move |share: f32| progress.set_position(1000 * repetition + (1000.0 * share) as u64);
        last = Some(lie_render::render_frame(
            world, lookup, camera, settings, &mut tell,
        ));
        times.push(milliseconds(clock.elapsed()));
    }
    bar.finish_and_clear();
    times.sort_by(f64::total_cmp);
    let (film, stats) = last.unwrap_or_else(|| (Film::new(settings.size), RenderStats::default()));
    Frame {
        film,
        stats,
        median_ms: times[times.len() / 2],
        min_ms: times[0],
        max_ms: times[times.len() - 1],
    }
}

fn write_picture(arguments: &Render, scene: &lie_scene::Scene, film: &Film) -> anyhow::Result<()> {
    if arguments
        .out
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
    {
        let exposure_stops = arguments.exposure.unwrap_or(scene.settings.exposure_stops);
        let map = ToneMap {
            exposure_stops,
            curve: arguments.tone.into(),
        };
        lie_render::write_png(&arguments.out, film, &map)?;
    } else {
        lie_render::write_exr(&arguments.out, film, arguments.precision.into())?;
    }
    Ok(())
}

fn statistics(
    arguments: &Render,
    settings: &FrameSettings,
    threads: usize,
    (world, build_ms): (&World, f64),
    frame: &Frame,
    constructed: Option<(&Constructed, f64)>,
) -> serde_json::Value {
    let stats = &frame.stats;
    // Stage times are summed over threads; as parts of the frame they are shared out.
    let stage_ms = |nanoseconds: u64| nanoseconds as f64 * 1.0e-6 / threads as f64;
    serde_json::json!({
        "scene": arguments.scene.display().to_string(),
        "integrator": arguments.integrator.name(),
        "accel": AccelKind::from(arguments.view.accel).name(),
        "threads": threads,
        "width": settings.size.x,
        "height": settings.size.y,
        "spp": settings.samples_per_pixel,
        "light_samples": settings.light_samples,
        "repetitions": arguments.repeat,
        "frame_ms": frame.median_ms,
        "frame_ms_min": frame.min_ms,
        "frame_ms_max": frame.max_ms,
        "visibility_ms": stage_ms(stats.visibility_ns),
        "unoccluded_ms": stage_ms(stats.unoccluded_ns),
        "partial_ms": stage_ms(stats.partial_ns),
        "full_ms": stage_ms(stats.full_ns),
        "build_ms": build_ms,
        "lights": world.scene().lights.len(),
        "triangles": world.scene().geometry.len(),
        "accel_bytes": world.accel().bytes(),
        "construct_ms": constructed.map_or(0.0, |(constructed, _)| constructed.milliseconds),
        "primary_rays": stats.primary_rays,
        "shadow_rays": stats.shadow_rays,
        "list_rays": stats.list_rays,
        "occluder_tests": stats.occluder_tests,
        "trusted_fraction": stats.trusted_fraction(),
        "lie": constructed.map(|(constructed, expected_error)| serde_json::json!({
            "expected_error": expected_error,
            "cells": constructed.stats.cells,
            "entries": constructed.stats.entries,
            "masked": constructed.stats.masked,
            "occluders": constructed.stats.occluders,
            "bytes": constructed.stats.bytes,
            "shader_bytes": constructed.replica.publish().bytes(),
            "samples": constructed.report.samples,
            "taken": constructed.report.taken,
            "version": constructed.report.version,
            "estimated_error": constructed.report.estimated_error,
            "converged": constructed.report.converged,
        })),
    })
}

/// A bar on standard error; nothing where that is not a terminal.
fn progress_bar(what: &'static str, length: u64) -> ProgressBar {
    let template = "{prefix:>9} [{wide_bar}] {percent:>3} % {msg}";
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length)
        .with_style(style.progress_chars("=> "))
        .with_prefix(what)
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1000.0
}
