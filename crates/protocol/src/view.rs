use serde::{Deserialize, Serialize};

use crate::{Text, bounded, limit};

/// BLAKE3 of a scene's bytes: its name on the wire and in the cache.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct SceneHash(pub [u8; 32]);

impl std::fmt::Display for SceneHash {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0
            .iter()
            .try_for_each(|byte| write!(formatter, "{byte:02x}"))
    }
}

/// A pinhole camera. Metres and radians, right-handed; not yet checked to be possible.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireCamera {
    /// Name to call it by.
    pub name: Text,
    /// The pinhole, in world space.
    pub eye: [f32; 3],
    /// World from camera, as x, y, z, w.
    pub orientation: [f32; 4],
    /// In radians.
    pub vertical_fov: f32,
}

/// A walkthrough's key frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireKeyFrame {
    /// Seconds from the start.
    pub time_s: f32,
    /// The pinhole, in world space.
    pub eye: [f32; 3],
    /// World from camera, as x, y, z, w.
    pub orientation: [f32; 4],
    /// In radians.
    pub vertical_fov: f32,
}

/// A camera's path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireWalkthrough {
    /// Name to call it by.
    pub name: Text,
    /// In rising time.
    #[serde(deserialize_with = "bounded::list::<{ limit::KEY_FRAMES }, _, _>")]
    pub key_frames: Vec<WireKeyFrame>,
}

/// How a scene wants to be rendered.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireRenderSettings {
    /// Pixels per row, and rows.
    pub size: [u32; 2],
    /// Camera rays per pixel.
    pub samples_per_pixel: u32,
    /// Sample points per area light and camera ray.
    pub light_samples: u32,
    /// In stops.
    pub exposure_stops: f32,
    /// Levels below the octree's root.
    pub max_depth: u32,
    /// Sum of occluders above which a cell splits; 0 leaves it to the constructor's rule.
    pub split_threshold: u32,
}

/// What a client knows of a scene without having it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneSummary {
    /// Name to call it by.
    pub name: Text,
    /// Which scene it is.
    pub hash: SceneHash,
    /// Smallest and greatest corner, in metres.
    pub bounds: [[f32; 3]; 2],
    /// How many triangles.
    pub triangles: u64,
    /// How many lights.
    pub lights: u64,
    /// At least one; the first is the default.
    #[serde(deserialize_with = "bounded::list::<{ limit::CAMERAS }, _, _>")]
    pub cameras: Vec<WireCamera>,
    /// May be none; the first is the default.
    #[serde(deserialize_with = "bounded::list::<{ limit::WALKTHROUGHS }, _, _>")]
    pub walkthroughs: Vec<WireWalkthrough>,
    /// The scene's own.
    pub settings: WireRenderSettings,
}
