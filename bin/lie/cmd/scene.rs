use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Subcommand, ValueEnum};
use lie_scene::{Bar, Gallery, Mosque, Scene, ScienceCenter, Summary};
use serde_json::{Value, json};

use crate::{
    args::{self, say, write_json},
    failure::{Usage, usage},
};

/// Looks at scenes, converts them and makes them by rule.
#[derive(Subcommand)]
pub(crate) enum SceneCommand {
    Info(Info),
    Export(Export),
    Generate(Generate),
}

/// Prints counts, bounds, lights, cameras and walkthroughs.
#[derive(Args)]
pub(crate) struct Info {
    /// A scene: .toml, .glb, .gltf or .obj, or a folder with a scene.toml.
    scene: PathBuf,
    /// Write the figures to this file as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Writes a scene as one .glb, or as an .obj with its .mtl beside it.
///
/// What the format cannot hold is logged as a warning.
#[derive(Args)]
pub(crate) struct Export {
    /// A scene: .toml, .glb, .gltf or .obj, or a folder with a scene.toml.
    scene: PathBuf,
    /// Where to write it; the ending, .glb or .obj, is the format.
    out: PathBuf,
}

/// Makes a scene by rule and writes it as .glb, or as .obj with its .mtl beside it.
#[derive(Args)]
pub(crate) struct Generate {
    /// Which scene.
    generator: Generator,
    /// Where to write it; the ending, .glb or .obj, is the format.
    out: PathBuf,
    /// What random choices start from: paintings, stones, grain. Not for the Cornell box.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// How finely round things are divided, above 0 and at most 4; 1 is the usual. Not for the
    /// Cornell box.
    #[arg(long, value_name = "FACTOR")]
    detail: Option<f32>,
}

/// Scenes that are made by rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Generator {
    /// A room without its front, two blocks and a lamp.
    CornellBox,
    /// A museum of five rooms under some fifty lights.
    Gallery,
    /// A bar in the evening under seventy spots.
    Bar,
    /// A hall of columns under a hundred points of light; a million triangles.
    Mosque,
    /// An atrium under one glass roof, the only light; some thousand triangles.
    ScienceCenter,
}

pub(crate) fn execute(command: &SceneCommand) -> anyhow::Result<()> {
    match command {
        SceneCommand::Info(info) => print_info(info),
        SceneCommand::Export(export) => {
            let format = Format::of(&export.out)?;
            refuse_to_overwrite(&export.scene, &export.out, format)?;
            let scene = args::load_scene(&export.scene)?;
            write(&scene, &export.out, format)
        }
        SceneCommand::Generate(generate) => {
            let format = Format::of(&generate.out)?;
            write(&make(generate)?, &generate.out, format)
        }
    }
}

fn print_info(info: &Info) -> anyhow::Result<()> {
    let summary = Summary::new(&args::load_scene(&info.scene)?);
    say(summary.to_string().trim_end())?;
    info.json
        .as_ref()
        .map_or(Ok(()), |path| write_json(path, &figures(&summary)))
}

fn figures(summary: &Summary) -> Value {
    let bounds = &summary.bounds;
    json!({
        "name": summary.name,
        "triangles": summary.triangles,
        "vertices": summary.vertices,
        "parts": summary.parts,
        // Without triangles there are no bounds.
        "bounds": (!bounds.is_empty()).then(|| json!({
            "min": bounds.min.to_array(),
            "max": bounds.max.to_array(),
        })),
        "materials": {
            "all": summary.materials.all,
            "masked": summary.materials.masked,
            "emissive": summary.materials.emissive,
        },
        "textures": summary.textures,
        "texture_bytes": summary.texture_bytes,
        "lights": summary.lights.iter().map(|lights| json!({
            "kind": lights.kind,
            "count": lights.count,
            "power": lights.power.to_array(),
        })).collect::<Vec<_>>(),
        "cameras": summary.cameras.iter().map(|(name, degrees)| json!({
            "name": name,
            "vertical_fov_degrees": degrees,
        })).collect::<Vec<_>>(),
        "walkthroughs": summary.walkthroughs.iter().map(|(name, duration_s, key_frames)| json!({
            "name": name,
            "duration_s": duration_s,
            "key_frames": key_frames,
        })).collect::<Vec<_>>(),
    })
}

fn make(generate: &Generate) -> Result<Scene, Usage> {
    let detail = generate.detail.unwrap_or(1.0);
    if !(detail > 0.0 && detail <= 4.0) {
        return Err(usage(format!(
            "--detail {detail}: expected a number above 0 and at most 4"
        )));
    }
    let seed = generate.seed.unwrap_or(1);
    match generate.generator {
        Generator::CornellBox if generate.seed.is_some() || generate.detail.is_some() => Err(
            usage("the Cornell box is always the same: it takes no --seed and no --detail"),
        ),
        Generator::CornellBox => Ok(lie_scene::cornell_box()),
        Generator::Gallery => Ok(lie_scene::gallery(&Gallery { seed, detail })),
        Generator::Bar => Ok(lie_scene::bar(&Bar { seed, detail })),
        Generator::Mosque => Ok(lie_scene::mosque(&Mosque { seed, detail })),
        Generator::ScienceCenter => Ok(lie_scene::science_center(&ScienceCenter { seed, detail })),
    }
}

/// What scenes are written as.
#[derive(Clone, Copy)]
enum Format {
    Glb,
    Obj,
}

impl Format {
    fn of(path: &Path) -> Result<Self, Usage> {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        match ending.as_deref().and_then(|ending| ending.to_str()) {
            Some("glb") => Ok(Self::Glb),
            Some("obj") => Ok(Self::Obj),
            _ => Err(usage(format!(
                "{}: expected a name that ends in .glb or .obj",
                path.display()
            ))),
        }
    }
}

/// An export must not destroy what it was made from: neither the scene's file nor a material
/// library beside it.
fn refuse_to_overwrite(scene: &Path, out: &Path, format: Format) -> Result<(), Usage> {
    let refusal = |path: &Path, why| usage(format!("{}: {why}", path.display()));
    if let (Ok(scene), Ok(out_file)) = (scene.canonicalize(), out.canonicalize())
        && scene == out_file
    {
        return Err(refusal(out, "the output would replace the scene itself"));
    }
    let library = out.with_extension("mtl");
    if matches!(format, Format::Obj) && library.exists() && !out.exists() {
        let why = "the output's material library would replace another model's";
        return Err(refusal(&library, why));
    }
    Ok(())
}

fn write(scene: &Scene, out: &Path, format: Format) -> anyhow::Result<()> {
    let warnings = match format {
        Format::Glb => {
            let exported = lie_scene::export_glb(scene)?;
            put(out, &exported.content)?;
            exported.warnings
        }
        Format::Obj => {
            let library = out.with_extension("mtl");
            let name = library.file_name().unwrap_or_default().to_string_lossy();
            let exported = lie_scene::export_obj(scene, &name);
            // The library first: an .obj never names one that is not there.
            put(&library, exported.content.mtl.as_bytes())?;
            put(out, exported.content.obj.as_bytes())?;
            exported.warnings
        }
    };
    for warning in warnings {
        tracing::warn!("{}: {warning}", out.display());
    }
    Ok(())
}

/// Writes a file whole or not at all, and says so.
fn put(path: &Path, content: &[u8]) -> anyhow::Result<()> {
    let mut unfinished = path.as_os_str().to_owned();
    unfinished.push(format!(".{}.part", std::process::id()));
    let unfinished = PathBuf::from(unfinished);
    let written =
        std::fs::write(&unfinished, content).and_then(|()| std::fs::rename(&unfinished, path));
    if written.is_err() {
        // It may not even have been made.
        let _ = std::fs::remove_file(&unfinished);
    }
    written.with_context(|| format!("cannot write {}", path.display()))?;
    say(format_args!("{}: {} bytes", path.display(), content.len()))
}
