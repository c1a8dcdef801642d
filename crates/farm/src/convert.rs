//! The one place where wire types become domain types and back.

use glam::{Quat, UVec2, Vec3};
use lie_geom::{Aabb, Ray};
use lie_octree::{CellBody, CellKey, CellState, LieState, LitLight};
use lie_protocol::{
    BeginFrame, SceneHash, SceneSummary, Text, WireBody, WireCamera, WireCell, WireKeyFrame,
    WireLight, WireMismatch, WireRenderSettings, WireWalkthrough, limit,
};
use lie_render::{FrameSettings, Mismatch};
use lie_scene::{Camera, KeyFrame, RenderSettings, Scene, Walkthrough};

/// Why what a peer sent is not what it should be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ConvertError {
    /// Not a possible camera.
    #[error("the camera is not possible")]
    Camera,
    /// Not a possible walkthrough.
    #[error("the walkthrough {0}")]
    Walkthrough(&'static str),
    /// A size, sample count or rectangle out of its limits.
    #[error("the frame's size, samples or tile are out of their limits")]
    Frame,
    /// Not a possible cell.
    #[error("cell {key:#x}: {problem}")]
    Cell {
        /// The cell's key.
        key: u64,
        /// What is wrong.
        problem: &'static str,
    },
}

/// A camera for the wire.
#[must_use]
pub fn wire_camera(camera: &Camera) -> WireCamera {
    WireCamera {
        name: Text::new(&camera.name),
        eye: camera.eye.to_array(),
        orientation: camera.orientation.to_array(),
        vertical_fov: camera.vertical_fov,
    }
}

/// A camera from a peer.
///
/// # Errors
/// [`ConvertError::Camera`].
pub fn camera(camera: &WireCamera) -> Result<Camera, ConvertError> {
    let camera = unchecked_camera(camera);
    if camera.is_valid() {
        Ok(camera)
    } else {
        Err(ConvertError::Camera)
    }
}

/// For scenes, which are validated as a whole.
pub(crate) fn unchecked_camera(camera: &WireCamera) -> Camera {
    Camera {
        name: camera.name.as_str().to_owned(),
        eye: Vec3::from(camera.eye),
        orientation: Quat::from_array(camera.orientation),
        vertical_fov: camera.vertical_fov,
    }
}

/// A walkthrough for the wire.
#[must_use]
pub fn wire_walkthrough(walkthrough: &Walkthrough) -> WireWalkthrough {
    let keys = walkthrough.key_frames.iter().take(limit::KEY_FRAMES);
    WireWalkthrough {
        name: Text::new(&walkthrough.name),
        key_frames: keys
            .map(|key| WireKeyFrame {
                time_s: key.time_s,
                eye: key.eye.to_array(),
                orientation: key.orientation.to_array(),
                vertical_fov: key.vertical_fov,
            })
            .collect(),
    }
}

/// A walkthrough from a peer.
///
/// # Errors
/// [`ConvertError::Walkthrough`].
pub fn walkthrough(walkthrough: &WireWalkthrough) -> Result<Walkthrough, ConvertError> {
    let walkthrough = unchecked_walkthrough(walkthrough);
    match walkthrough.problem() {
        None => Ok(walkthrough),
        Some(problem) => Err(ConvertError::Walkthrough(problem)),
    }
}

/// For scenes, which are validated as a whole.
pub(crate) fn unchecked_walkthrough(walkthrough: &WireWalkthrough) -> Walkthrough {
    let keys = walkthrough.key_frames.iter();
    Walkthrough {
        name: walkthrough.name.as_str().to_owned(),
        key_frames: keys
            .map(|key| KeyFrame {
                time_s: key.time_s,
                eye: Vec3::from(key.eye),
                orientation: Quat::from_array(key.orientation),
                vertical_fov: key.vertical_fov,
            })
            .collect(),
    }
}

/// Render settings for the wire.
#[must_use]
pub fn wire_settings(settings: &RenderSettings) -> WireRenderSettings {
    WireRenderSettings {
        size: settings.size.to_array(),
        samples_per_pixel: settings.samples_per_pixel,
        light_samples: settings.light_samples,
        exposure_stops: settings.exposure_stops,
        max_depth: settings.max_depth,
        split_threshold: settings.split_threshold.unwrap_or(0),
    }
}

/// Render settings from the wire; not checked.
#[must_use]
pub fn settings(settings: &WireRenderSettings) -> RenderSettings {
    RenderSettings {
        size: UVec2::from(settings.size),
        samples_per_pixel: settings.samples_per_pixel,
        light_samples: settings.light_samples,
        exposure_stops: settings.exposure_stops,
        max_depth: settings.max_depth,
        split_threshold: (settings.split_threshold != 0).then_some(settings.split_threshold),
    }
}

/// What a client gets to know of a scene.
#[must_use]
pub fn summary(scene: &Scene, hash: SceneHash) -> SceneSummary {
    let bounds = scene.geometry.bounds();
    let cameras = scene.cameras.iter().take(limit::CAMERAS);
    let walkthroughs = scene.walkthroughs.iter().take(limit::WALKTHROUGHS);
    SceneSummary {
        name: Text::new(&scene.name),
        hash,
        bounds: [bounds.min.to_array(), bounds.max.to_array()],
        triangles: scene.geometry.len() as u64,
        lights: scene.lights.len() as u64,
        cameras: cameras.map(wire_camera).collect(),
        walkthroughs: walkthroughs.map(wire_walkthrough).collect(),
        settings: wire_settings(&scene.settings),
    }
}

/// A frame's settings from a client.
///
/// # Errors
/// [`ConvertError::Frame`].
pub fn frame_settings(begin: &BeginFrame) -> Result<FrameSettings, ConvertError> {
    let sides = 1..=limit::FRAME_SIDE;
    let possible = begin.size.iter().all(|side| sides.contains(side))
        && (1..=RenderSettings::MAX_SAMPLES_PER_PIXEL).contains(&begin.samples_per_pixel)
        && (1..=RenderSettings::MAX_LIGHT_SAMPLES).contains(&begin.light_samples);
    if !possible {
        return Err(ConvertError::Frame);
    }
    Ok(FrameSettings {
        size: UVec2::from(begin.size),
        samples_per_pixel: begin.samples_per_pixel,
        light_samples: begin.light_samples,
        seed: begin.seed,
        ward: None,
    })
}

/// What an audit found, for the wire.
#[must_use]
pub fn wire_mismatch(wrong: &Mismatch) -> WireMismatch {
    WireMismatch {
        light: wrong.light,
        point: wrong.point.to_array(),
        origin: wrong.ray.origin.to_array(),
        direction: wrong.ray.direction.to_array(),
        span: [wrong.ray.t_min, wrong.ray.t_max],
    }
}

/// What an audit found. Whether it makes sense is for [`crate::Builder::mend`] to say.
#[must_use]
pub fn mismatch(wrong: &WireMismatch) -> Mismatch {
    Mismatch {
        light: wrong.light,
        point: wrong.point.into(),
        ray: Ray {
            origin: wrong.origin.into(),
            direction: wrong.direction.into(),
            t_min: wrong.span[0],
            t_max: wrong.span[1],
        },
    }
}

/// A cell for the wire.
#[must_use]
pub fn wire_cell(state: &CellState) -> WireCell {
    let body = match &state.body {
        CellBody::Inner => WireBody::Interior,
        CellBody::Leaf(lie) => WireBody::Leaf {
            region: lie
                .region
                .map(|region| [region.min.to_array(), region.max.to_array()]),
            hidden: lie.hidden.clone(),
            crowded: lie.crowded.clone(),
            lights: lie
                .lights
                .iter()
                .map(|lit| WireLight {
                    light: lit.light,
                    occluders: lit.occluders.clone(),
                })
                .collect(),
        },
    };
    WireCell {
        key: state.key.raw(),
        version: state.version,
        body,
    }
}

/// A cell from the constructor. Whether its lights and triangles exist is for
/// [`crate::LieReplica::apply`] to say.
///
/// # Errors
/// [`ConvertError::Cell`].
pub fn cell(cell: WireCell) -> Result<CellState, ConvertError> {
    let raw = cell.key;
    let wrong = |problem| ConvertError::Cell { key: raw, problem };
    let key = CellKey::from_raw(raw).ok_or_else(|| wrong("no cell has this key"))?;
    let body = match cell.body {
        WireBody::Interior => CellBody::Inner,
        WireBody::Leaf {
            region,
            lights,
            hidden,
            crowded,
        } => {
            let rising = lights.windows(2).all(|pair| pair[0].light < pair[1].light)
                && [&hidden, &crowded]
                    .iter()
                    .all(|list| list.windows(2).all(|pair| pair[0] < pair[1]));
            if !rising {
                return Err(wrong("its lights are out of order"));
            }
            let lights = lights.into_iter().map(|lit| LitLight {
                light: lit.light,
                occluders: lit.occluders,
            });
            CellBody::Leaf(LieState {
                region: region.map(|[min, max]| Aabb {
                    min: min.into(),
                    max: max.into(),
                }),
                lights: lights.collect(),
                hidden,
                crowded,
            })
        }
    };
    Ok(CellState {
        key,
        version: cell.version,
        body,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_impossible_walkthrough_of_a_peer_is_refused_before_anybody_walks_it() {
        let key = |time_s| WireKeyFrame {
            time_s,
            eye: [1.0, 2.0, 3.0],
            orientation: [0.0, 0.0, 0.0, 1.0],
            vertical_fov: 1.0,
        };
        let walk = |key_frames| {
            walkthrough(&WireWalkthrough {
                name: Text::new("walk"),
                key_frames,
            })
        };
        let whole = walk(vec![key(0.0), key(1.0)]).unwrap();
        assert_eq!(whole.camera_at(0.5).eye, Vec3::new(1.0, 2.0, 3.0));
        let narrow = WireKeyFrame {
            vertical_fov: 0.0,
            ..key(1.0)
        };
        for (keys, piece) in [
            (vec![], "no key frames"),
            (vec![key(1.0), key(1.0)], "do not rise"),
            (vec![key(0.0), key(f32::NAN)], "do not rise"),
            (vec![key(f32::NAN)], "impossible"),
            (vec![key(0.0), key(f32::INFINITY)], "impossible"),
            (vec![key(0.0), narrow], "impossible"),
        ] {
            let message = walk(keys).unwrap_err().to_string();
            assert!(message.contains(piece), "{message}");
        }
    }
}
