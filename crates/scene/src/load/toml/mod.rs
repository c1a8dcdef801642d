//! `scene.toml`: geometry from files and generators, with lights, cameras and walkthroughs.

mod geometry;
mod light;
mod schema;

use std::path::Path;

use glam::Vec3;

use self::schema::{CameraEntry, Problem, SceneFile, WalkthroughEntry};
use super::{LoadError, framing, source};
use crate::{Background, Camera, KeyFrame, RenderSettings, Scene, Walkthrough, draft::Draft};

/// Field of view where none is stated, in radians.
const VERTICAL_FOV: f32 = std::f32::consts::FRAC_PI_3;

/// Reads a scene file and everything it names.
pub(super) fn load(path: &Path) -> Result<(Scene, Vec<String>), LoadError> {
    let text = String::from_utf8(source::read(path)?).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(&error.as_bytes()[..valid]).into_owned();
        syntax(path, &before, (valid..valid, "expected UTF-8 text".into()))
    })?;
    let at = |problem: Problem| syntax(path, &text, problem);
    let file: SceneFile = ::toml::from_str(&text)
        .map_err(|error| at((error.span().unwrap_or(0..0), error.message().to_owned())))?;

    // What the file itself says comes first: its first camera is the default.
    let mut draft = Draft::default();
    draft.cameras = cameras(&file).map_err(at)?;
    draft.walkthroughs = walkthroughs(&file).map_err(at)?;
    for entry in &file.geometry {
        geometry::add(entry, path, &at, &mut draft)?;
    }
    for entry in &file.material {
        geometry::override_material(entry, &mut draft).map_err(at)?;
    }
    for entry in &file.light {
        light::add(entry, &mut draft).map_err(at)?;
    }
    let settings = match &file.settings {
        Some(entry) => {
            let settings = entry.as_ref().settings();
            settings
                .validate()
                .map_err(|error| at((entry.span(), error.to_string())))?;
            settings
        }
        None => RenderSettings::default(),
    };
    framing::add_missing(&mut draft);
    let background = Background {
        radiance: file
            .background
            .radiance
            .map_or(Vec3::ZERO, |radiance| radiance.0),
    };
    let name = file.name.unwrap_or_else(|| default_name(path));
    draft
        .finish(name, background, settings)
        .map_err(|source| LoadError::Scene {
            path: path.to_owned(),
            source,
        })
}

/// The file's own name, or its folder's for a `scene.toml`.
fn default_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    let folder = path.parent().and_then(Path::file_name);
    let name = if stem == "scene" {
        folder.unwrap_or(stem)
    } else {
        stem
    };
    name.to_string_lossy().into_owned()
}

fn syntax(path: &Path, text: &str, (span, problem): Problem) -> LoadError {
    let before = text.get(..span.start).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    LoadError::Syntax {
        path: path.to_owned(),
        line: before.matches('\n').count() + 1,
        column: before[line_start..].chars().count() + 1,
        problem,
    }
}

fn cameras(file: &SceneFile) -> Result<Vec<Camera>, Problem> {
    let camera = |(index, entry): (usize, &::toml::Spanned<CameraEntry>)| {
        let camera = entry.as_ref();
        if camera.eye.0 == camera.target.0 {
            return Err((
                entry.span(),
                "the camera's eye and target are the same".to_owned(),
            ));
        }
        Ok(Camera::look_at(
            camera
                .name
                .clone()
                .unwrap_or_else(|| format!("camera {index}")),
            camera.eye.0,
            camera.target.0,
            camera.up.map_or(Vec3::Y, |up| up.0),
            camera
                .vertical_fov_degrees
                .map_or(VERTICAL_FOV, |fov| fov.0),
        ))
    };
    file.camera.iter().enumerate().map(camera).collect()
}

fn walkthroughs(file: &SceneFile) -> Result<Vec<Walkthrough>, Problem> {
    let walkthrough = |(index, entry): (usize, &::toml::Spanned<WalkthroughEntry>)| {
        let walk = entry.as_ref();
        let times: Vec<f32> = walk.key_frame.iter().map(|key| key.time_s).collect();
        if times.is_empty() {
            return Err((
                entry.span(),
                "expected at least one [[walkthrough.key_frame]]".to_owned(),
            ));
        }
        if !(times.iter().all(|time| time.is_finite()) && times.windows(2).all(|w| w[0] < w[1])) {
            return Err((
                entry.span(),
                "expected key frames in strictly rising time_s".to_owned(),
            ));
        }
        let key_frame = |key: &schema::KeyFrameEntry| {
            let fov = key.vertical_fov_degrees.map_or(VERTICAL_FOV, |fov| fov.0);
            KeyFrame::look_at(key.time_s, key.eye.0, key.target.0, fov)
        };
        Ok(Walkthrough {
            name: walk
                .name
                .clone()
                .unwrap_or_else(|| format!("walkthrough {index}")),
            key_frames: walk.key_frame.iter().map(key_frame).collect(),
        })
    };
    file.walkthrough
        .iter()
        .enumerate()
        .map(walkthrough)
        .collect()
}

#[cfg(test)]
mod tests;
