use glam::UVec2;
use lie_protocol::{BeginFrame, Compression, PixelFormat, WireIntegrator};
use lie_render::{Film, RenderStats};
use lie_scene::Camera;

use crate::convert;

/// A frame to render.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRequest {
    /// The view.
    pub camera: Camera,
    /// Columns and rows.
    pub size: UVec2,
    /// Camera rays per pixel.
    pub samples_per_pixel: u32,
    /// Sample points per area light and camera ray.
    pub light_samples: u32,
    /// How visibility is found.
    pub integrator: WireIntegrator,
    /// Seed of all random numbers.
    pub seed: u64,
    /// How the pixels travel: `F32` is exact.
    pub format: PixelFormat,
    /// How the pixels are packed.
    pub compression: Compression,
}

/// A finished frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The pixels.
    pub film: Film,
    /// How it came about.
    pub stats: FrameStats,
}

/// How a frame came about. Times are wall-clock milliseconds as the client sees them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// From the call of [`super::Client::render_frame`] until the last tile is in the film.
    pub frame_ms: f64,
    /// From the call until the frame and its first tiles were handed to the connections with
    /// shaders.
    pub asked_ms: f64,
    /// From the call until the last tile has come.
    pub last_tile_ms: f64,
    /// From the call until the first tile is in the film.
    pub latency_ms: f64,
    /// Oldest LIEs that a tile was shaded with.
    pub lie_version: u64,
    /// Newest LIEs that a tile was shaded with.
    pub lie_version_max: u64,
    /// Share of light evaluations that the LIEs answered, in `[0, 1]`.
    pub trusted_fraction: f64,
    /// Tiles that it was cut into.
    pub tiles: u64,
    /// Tiles that were in flight at shaders that went away.
    pub lost_tiles: u64,
    /// How often a tile was given to another shader as well because it was late.
    pub reissued_tiles: u64,
    /// Shaders that were not asked at first, since they had let frames before wait.
    pub set_aside: u64,
    /// Bytes of pixels as they travelled.
    pub pixel_bytes: u64,
    /// Summed over tiles: milliseconds that they waited at their shader for a thread.
    pub queued_ms: f64,
    /// Summed over tiles: milliseconds for which their thread had nothing to do before.
    pub idle_ms: f64,
    /// Summed over tiles: milliseconds of rendering.
    pub render_ms: f64,
    /// Summed over tiles: milliseconds of packing, by the thread that rendered.
    pub pack_ms: f64,
    /// Milliseconds in which the client unpacked tiles and put them on its film.
    pub unpack_ms: f64,
    /// Summed over tiles: what they cost.
    pub render: RenderStats,
    /// Who rendered how much, in order of joining.
    pub shaders: Vec<ShaderShare>,
}

/// A shader's part in a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderShare {
    /// Its address.
    pub address: String,
    /// Tiles of the frame that came from it.
    pub tiles: u64,
}

impl FrameRequest {
    pub(super) fn begin(&self, frame: u64, view: u32) -> BeginFrame {
        BeginFrame {
            frame,
            view,
            camera: convert::wire_camera(&self.camera),
            size: self.size.to_array(),
            samples_per_pixel: self.samples_per_pixel,
            light_samples: self.light_samples,
            integrator: self.integrator,
            seed: self.seed,
            format: self.format,
            compression: self.compression,
        }
    }
}
