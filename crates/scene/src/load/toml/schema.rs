//! What a scene.toml may hold. Unknown keys are errors.

use std::ops::Range;

use glam::{UVec2, Vec2, Vec3};
use serde::Deserialize;
use toml::Spanned;

use crate::generate::MAX_DETAIL;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) geometry: Vec<Spanned<GeometryEntry>>,
    #[serde(default)]
    pub(super) material: Vec<Spanned<MaterialEntry>>,
    #[serde(default)]
    pub(super) light: Vec<Spanned<LightEntry>>,
    #[serde(default)]
    pub(super) camera: Vec<Spanned<CameraEntry>>,
    #[serde(default)]
    pub(super) walkthrough: Vec<Spanned<WalkthroughEntry>>,
    pub(super) settings: Option<Spanned<SettingsEntry>>,
    #[serde(default)]
    pub(super) background: BackgroundEntry,
}

/// Geometry from a file or a generator, moved by scale, then rotation, then translation.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GeometryEntry {
    pub(super) file: Option<String>,
    pub(super) generator: Option<Spanned<String>>,
    /// Generators: what random numbers start from.
    pub(super) seed: Option<u64>,
    /// Generators: how finely round things are divided; 1 is the usual.
    pub(super) detail: Option<Detail>,
    pub(super) translation: Option<Point>,
    pub(super) rotation_axis: Option<Point>,
    pub(super) rotation_degrees: Option<Rotation>,
    pub(super) scale: Option<Scale>,
    /// Whether lights and emission of the file count.
    #[serde(default = "yes")]
    pub(super) keep_lights: bool,
    /// Whether cameras and walkthroughs of the file count.
    #[serde(default = "yes")]
    pub(super) keep_cameras: bool,
}

/// Degrees about `rotation_axis`, or about x, then y, then z.
#[derive(Clone, Copy, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number of degrees, or three of them about x, y and z"
)]
pub(super) enum Rotation {
    About(f32),
    Euler([f32; 3]),
}

#[derive(Clone, Copy, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, or three of them along x, y and z"
)]
pub(super) enum Scale {
    Uniform(f32),
    PerAxis([f32; 3]),
}

/// New values for every material of a name.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialEntry {
    pub(super) name: String,
    pub(super) base_color: Option<Color>,
    pub(super) alpha: Option<Unit>,
    pub(super) metallic: Option<Unit>,
    pub(super) roughness: Option<Unit>,
    pub(super) specular: Option<Unit>,
    pub(super) emission: Option<Power>,
    pub(super) double_sided: Option<bool>,
    /// Alpha below this is no surface; 0 makes the material opaque.
    pub(super) alpha_cutoff: Option<Unit>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightEntry {
    pub(super) name: Option<String>,
    pub(super) kind: Option<Spanned<String>>,
    pub(super) radiant_intensity: Option<Power>,
    pub(super) radiance: Option<Power>,
    pub(super) irradiance: Option<Power>,
    pub(super) position: Option<Point>,
    pub(super) target: Option<Point>,
    pub(super) direction: Option<Point>,
    pub(super) inner_degrees: Option<f32>,
    pub(super) outer_degrees: Option<f32>,
    /// Width and height of a rectangle around `position`, in metres.
    pub(super) size_m: Option<Size>,
    pub(super) up: Option<Point>,
    pub(super) corner: Option<Point>,
    pub(super) edge_u: Option<Point>,
    pub(super) edge_v: Option<Point>,
    pub(super) double_sided: Option<bool>,
    pub(super) visible: Option<bool>,
    pub(super) emissive_material: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraEntry {
    pub(super) name: Option<String>,
    pub(super) eye: Point,
    pub(super) target: Point,
    pub(super) up: Option<Point>,
    pub(super) vertical_fov_degrees: Option<FieldOfView>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WalkthroughEntry {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) key_frame: Vec<KeyFrameEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KeyFrameEntry {
    pub(super) time_s: f32,
    pub(super) eye: Point,
    pub(super) target: Point,
    pub(super) vertical_fov_degrees: Option<FieldOfView>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SettingsEntry {
    pub(super) size: Option<[u32; 2]>,
    pub(super) samples_per_pixel: Option<u32>,
    pub(super) light_samples: Option<u32>,
    pub(super) exposure_stops: Option<f32>,
    pub(super) max_depth: Option<u32>,
    pub(super) split_threshold: Option<u32>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BackgroundEntry {
    pub(super) radiance: Option<Power>,
}

/// Three finite numbers.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "[f32; 3]")]
pub(super) struct Point(pub(super) Vec3);

/// Three finite numbers, none negative.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "[f32; 3]")]
pub(super) struct Power(pub(super) Vec3);

/// Three numbers from 0 to 1.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "[f32; 3]")]
pub(super) struct Color(pub(super) Vec3);

/// Two numbers above 0.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "[f32; 2]")]
pub(super) struct Size(pub(super) Vec2);

/// A number from 0 to 1.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f32")]
pub(super) struct Unit(pub(super) f32);

/// How finely generators divide round things.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f32")]
pub(super) struct Detail(pub(super) f32);

/// Degrees between 0 and 180, held in radians.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f32")]
pub(super) struct FieldOfView(pub(super) f32);

fn yes() -> bool {
    true
}

impl TryFrom<[f32; 3]> for Point {
    type Error = &'static str;
    fn try_from(value: [f32; 3]) -> Result<Self, Self::Error> {
        let value = Vec3::from(value);
        value
            .is_finite()
            .then_some(Self(value))
            .ok_or("expected three finite numbers")
    }
}

impl TryFrom<[f32; 3]> for Power {
    type Error = &'static str;
    fn try_from(value: [f32; 3]) -> Result<Self, Self::Error> {
        let value = Vec3::from(value);
        (value.is_finite() && value.min_element() >= 0.0)
            .then_some(Self(value))
            .ok_or("expected three finite numbers, none of them negative")
    }
}

impl TryFrom<[f32; 3]> for Color {
    type Error = &'static str;
    fn try_from(value: [f32; 3]) -> Result<Self, Self::Error> {
        value
            .iter()
            .all(|channel| (0.0..=1.0).contains(channel))
            .then_some(Self(value.into()))
            .ok_or("expected three numbers from 0 to 1")
    }
}

impl TryFrom<[f32; 2]> for Size {
    type Error = &'static str;
    fn try_from(value: [f32; 2]) -> Result<Self, Self::Error> {
        let value = Vec2::from(value);
        (value.is_finite() && value.min_element() > 0.0)
            .then_some(Self(value))
            .ok_or("expected two finite numbers above 0")
    }
}

impl TryFrom<f32> for Unit {
    type Error = &'static str;
    fn try_from(value: f32) -> Result<Self, Self::Error> {
        (0.0..=1.0)
            .contains(&value)
            .then_some(Self(value))
            .ok_or("expected a number from 0 to 1")
    }
}

impl TryFrom<f32> for Detail {
    type Error = String;
    fn try_from(value: f32) -> Result<Self, Self::Error> {
        (value > 0.0 && value <= MAX_DETAIL)
            .then_some(Self(value))
            .ok_or_else(|| format!("expected a detail above 0 and at most {MAX_DETAIL}"))
    }
}

impl TryFrom<f32> for FieldOfView {
    type Error = &'static str;
    fn try_from(value: f32) -> Result<Self, Self::Error> {
        (value > 0.0 && value < 180.0)
            .then_some(Self(value.to_radians()))
            .ok_or("expected degrees between 0 and 180")
    }
}

impl SettingsEntry {
    /// The settings, where nothing is said the usual ones.
    pub(super) fn settings(&self) -> crate::RenderSettings {
        let usual = crate::RenderSettings::default();
        crate::RenderSettings {
            size: self.size.map_or(usual.size, UVec2::from),
            samples_per_pixel: self.samples_per_pixel.unwrap_or(usual.samples_per_pixel),
            light_samples: self.light_samples.unwrap_or(usual.light_samples),
            exposure_stops: self.exposure_stops.unwrap_or(usual.exposure_stops),
            max_depth: self.max_depth.unwrap_or(usual.max_depth),
            split_threshold: self.split_threshold,
        }
    }
}

/// Where in the file something stands, and what is wrong there.
pub(super) type Problem = (Range<usize>, String);
