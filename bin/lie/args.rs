//! Values that several commands take.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glam::UVec2;
use lie_farm::snapshot::SnapshotFile;
use lie_protocol::{Compression, PixelFormat};
use lie_render::AccelKind;
use lie_scene::{Camera, RenderSettings, Scene, Walkthrough};

use crate::failure::{OrUsage, Usage, usage};

/// Parses `WxH`.
pub(crate) fn size(text: &str) -> Result<UVec2, String> {
    let expected = || {
        format!(
            "expected WIDTHxHEIGHT, each 1 to {}, such as 512x512",
            RenderSettings::MAX_SIDE
        )
    };
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side = |text: &str| {
        text.parse()
            .ok()
            .filter(|side| (1..=RenderSettings::MAX_SIDE).contains(side))
            .ok_or_else(expected)
    };
    Ok(UVec2::new(side(width)?, side(height)?))
}

/// Parses `X,Y`.
pub(crate) fn pixel(text: &str) -> Result<UVec2, String> {
    let sides = text.split_once(',');
    let number = |text: &str| text.trim().parse().ok();
    sides
        .and_then(|(x, y)| Some(UVec2::new(number(x)?, number(y)?)))
        .ok_or_else(|| "expected COLUMN,ROW, counted from 0,0 at the top left".to_owned())
}

/// Parses a share, such as 0.02.
pub(crate) fn share(text: &str) -> Result<f32, String> {
    let share = text.parse().ok();
    share
        .filter(|share| (0.0..=1.0).contains(share))
        .ok_or_else(|| "expected a number from 0 to 1, such as 0.02".to_owned())
}

/// How visibility of lights is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Integrator {
    /// A full shadow ray for every light and sample: the reference.
    Standard,
    /// Full shadow rays to the lights that give most; the rest is estimated (Ward 1994).
    Ward,
    /// Local illumination environments.
    Lie,
}

impl Integrator {
    /// Its name on the command line and in statistics.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Ward => "ward",
            Self::Lie => "lie",
        }
    }
}

/// What finds which triangles a ray hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Accel {
    /// A bounding volume hierarchy with eight children to a node.
    Bvh,
    /// The paper's two-level grid.
    Grid,
}

impl From<Accel> for AccelKind {
    fn from(accel: Accel) -> Self {
        match accel {
            Accel::Bvh => Self::Bvh,
            Accel::Grid => Self::Grid,
        }
    }
}

/// Checks of what is already known.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Audit {
    /// Check what LIEs answer with true shadow rays, in this share of the pixels of every frame;
    /// the constructor is told what was wrong, and mends it. 0 checks nothing.
    #[arg(long, default_value_t = 0.01, value_parser = share, allow_negative_numbers = true, value_name = "FRACTION")]
    pub(crate) audit: f32,
}

/// Bits per channel of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Precision {
    /// 16-bit floating point.
    Half,
    /// 32-bit floating point.
    Float,
}

impl From<Precision> for lie_render::Precision {
    fn from(precision: Precision) -> Self {
        match precision {
            Precision::Half => Self::Half,
            Precision::Float => Self::Float,
        }
    }
}

impl From<Precision> for PixelFormat {
    fn from(precision: Precision) -> Self {
        match precision {
            Precision::Half => Self::F16,
            Precision::Float => Self::F32,
        }
    }
}

/// How pixels travel, if they are to be compressed.
pub(crate) fn compression(is_wanted: bool) -> Compression {
    if is_wanted {
        Compression::Lz4
    } else {
        Compression::None
    }
}

/// The curve from radiance to an 8-bit picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ToneCurve {
    /// As it is, cut at white.
    Linear,
    /// A filmic curve.
    Aces,
}

impl From<ToneCurve> for lie_render::ToneCurve {
    fn from(curve: ToneCurve) -> Self {
        match curve {
            ToneCurve::Linear => Self::Linear,
            ToneCurve::Aces => Self::Aces,
        }
    }
}

/// Local illumination environments that outlast a process.
#[derive(Args)]
#[command(next_help_heading = "Snapshots")]
pub(crate) struct Lies {
    /// Keep local illumination environments in this file: go on from what is saved there, and
    /// save what is learnt since. `lie render` saves once its picture is written, `lie inspect` last
    /// of all, a constructor every minute and at its end. Views that had converged have converged at once.
    /// A snapshot that is damaged, or of another format, scene or other settings of
    /// construction, is refused with a warning, constructed anew and replaced. A file that is
    /// no snapshot ends the command with code 2 and is left as it is.
    #[arg(long, value_name = "FILE")]
    lies: Option<PathBuf>,
}

impl Lies {
    /// The file, if one is named and it is a snapshot or may become one.
    pub(crate) fn file(&self) -> Result<Option<SnapshotFile>, Usage> {
        let file = self.lies.as_ref().map(SnapshotFile::new);
        file.as_ref()
            .map_or(Ok(()), SnapshotFile::check)
            .or_usage()?;
        Ok(file)
    }
}

/// Loads a scene and logs what was left out of it.
pub(crate) fn load_scene(path: &Path) -> Result<Scene, Usage> {
    let loaded = lie_scene::load(path).or_usage()?;
    for warning in &loaded.warnings {
        tracing::warn!("{}: {warning}", path.display());
    }
    Ok(loaded.scene)
}

/// The camera of that name; the first without one.
pub(crate) fn find_camera<'a>(scene: &'a Scene, name: Option<&str>) -> Result<&'a Camera, Usage> {
    find(&scene.cameras, name, "camera", |camera| &camera.name)
}

/// The walkthrough of that name; the first without one.
pub(crate) fn find_walkthrough<'a>(
    scene: &'a Scene,
    name: Option<&str>,
) -> Result<&'a Walkthrough, Usage> {
    find(&scene.walkthroughs, name, "walkthrough", |walk| &walk.name)
}

fn find<'a, T>(
    items: &'a [T],
    name: Option<&str>,
    kind: &str,
    name_of: impl Fn(&T) -> &String,
) -> Result<&'a T, Usage> {
    let found = match name {
        None => items.first(),
        Some(name) => items.iter().find(|item| name_of(item) == name),
    };
    found.ok_or_else(|| {
        let known: Vec<&str> = items.iter().map(|item| name_of(item).as_str()).collect();
        match (name, known.is_empty()) {
            (_, true) => usage(format!("the scene has no {kind}")),
            (None, false) => usage(format!("no {kind}")),
            (Some(name), false) => usage(format!(
                "the scene has no {kind} '{name}'; it has: {}",
                known.join(", ")
            )),
        }
    })
}

/// Writes JSON, followed by a line end.
pub(crate) fn write_json(path: &PathBuf, value: &serde_json::Value) -> anyhow::Result<()> {
    use anyhow::Context;
    let text = serde_json::to_string_pretty(value)? + "\n";
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// Writes a line to standard output. A closed pipe is no error: the reader had enough.
pub(crate) fn say(line: impl std::fmt::Display) -> anyhow::Result<()> {
    use std::io::{ErrorKind, Write};
    match writeln!(std::io::stdout(), "{line}") {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => Ok(result?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_sides_with_an_x() {
        assert_eq!(size("640x360"), Ok(UVec2::new(640, 360)));
        for wrong in ["", "640", "0x3", "3x-1", "99999x3", "3x3x3", "axb"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn pixels_are_a_column_and_a_row() {
        assert_eq!(pixel("320,180"), Ok(UVec2::new(320, 180)));
        assert_eq!(pixel("3, 0"), Ok(UVec2::new(3, 0)));
        for wrong in ["", "3", "3,", "-1,3", "3x3", "1,2,3", "1.5,2"] {
            assert!(pixel(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn shares_are_numbers_from_0_to_1() {
        assert_eq!(share("0.02"), Ok(0.02));
        assert_eq!((share("0"), share("1")), (Ok(0.0), Ok(1.0)));
        for wrong in ["", "-0.1", "1.01", "NaN", "inf", "2 %"] {
            assert!(share(wrong).is_err(), "{wrong}");
        }
    }
}
