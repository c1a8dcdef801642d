use serde::{Deserialize, Serialize};

use crate::{
    Goodbye, Ping, Pong, Refuse, SceneHash, Text, WireCamera,
    body::{Body, Control},
    codec, limit,
};

/// The shader takes the client in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileWelcome {
    /// The scene that it renders; a client of another scene must leave.
    pub scene: SceneHash,
    /// Its render threads.
    pub threads: u32,
    /// Whether it replays recorded costs: its pixels are no picture of anything.
    pub replays: bool,
}

/// How visibility of lights is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WireIntegrator {
    /// A shadow ray for every light sample.
    Standard,
    /// The LIEs.
    Lie,
}

/// How a channel travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PixelFormat {
    /// IEEE half, little-endian.
    F16,
    /// IEEE single, little-endian, exact.
    F32,
}

/// How a tile's pixels are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Compression {
    /// Not at all.
    None,
    /// One LZ4 block.
    Lz4,
}

/// What all tiles of a frame have in common. Frames with lower numbers are void from here on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeginFrame {
    /// Rises with every frame of this client.
    pub frame: u64,
    /// The client's number at the constructor. With the frame's it names the frame in the logs of
    /// all processes, and means nothing else.
    pub view: u32,
    /// The view.
    pub camera: WireCamera,
    /// Pixels per row, and rows; at most [`limit::FRAME_SIDE`].
    pub size: [u32; 2],
    /// Camera rays per pixel.
    pub samples_per_pixel: u32,
    /// Sample points per area light and camera ray.
    pub light_samples: u32,
    /// How to render.
    pub integrator: WireIntegrator,
    /// Of the random numbers.
    pub seed: u64,
    /// How the pixels travel.
    pub format: PixelFormat,
    /// How the pixels are packed.
    pub compression: Compression,
}

/// Asks for one tile of the frame begun last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileRequest {
    /// The frame.
    pub frame: u64,
    /// The tile's number in the frame.
    pub tile: u32,
    /// Upper left pixel.
    pub origin: [u32; 2],
    /// Pixels per row, and rows; at most [`limit::TILE_SIDE`].
    pub size: [u32; 2],
}

/// What a tile cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WireCost {
    /// Nanoseconds from the request's arrival to the start of the work.
    pub queued_ns: u64,
    /// Nanoseconds for which its thread had nothing to do before it, of its frame's time.
    pub idle_ns: u64,
    /// Nanoseconds of rendering, of which the next four are parts.
    pub render_ns: u64,
    /// Nanoseconds in primary visibility.
    pub visibility_ns: u64,
    /// Nanoseconds in lights that no ray is needed for.
    pub unoccluded_ns: u64,
    /// Nanoseconds in lights tested against occluder lists.
    pub partial_ns: u64,
    /// Nanoseconds in lights tested against the whole scene.
    pub full_ns: u64,
    /// Nanoseconds of packing its pixels, which follow the rendering.
    pub pack_ns: u64,
    /// Camera rays.
    pub primary_rays: u64,
    /// Shadow rays through the whole scene.
    pub shadow_rays: u64,
    /// Rays tested against an occluder list instead.
    pub list_rays: u64,
    /// Triangles in the lists that those rays met.
    pub occluder_tests: u64,
    /// Lights evaluated at surface points.
    pub evaluations: u64,
    /// Those that the LIEs answered.
    pub trusted: u64,
}

/// All of a finished tile but its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileReport {
    /// The frame.
    pub frame: u64,
    /// The tile's number in the frame.
    pub tile: u32,
    /// The LIEs it was shaded with; 0 for none.
    pub lie_version: u64,
    /// What it cost.
    pub cost: WireCost,
}

/// A finished tile. Body: the report as bincode, then the pixels as bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TileDone {
    /// Everything else.
    pub report: TileReport,
    /// Red, green, blue of each pixel, row by row, in the frame's format and packing; at
    /// most [`limit::TILE_PIXELS`].
    pub pixels: Vec<u8>,
}

/// A tile that the shader could not render: its code panicked at it. It goes on with others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileFailed {
    /// The frame.
    pub frame: u64,
    /// The tile's number in the frame.
    pub tile: u32,
    /// Why, for people.
    pub reason: Text,
}

/// Tiles of frames before this one are not wanted any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CancelBefore {
    /// The first frame that still counts.
    pub frame: u64,
}

messages! {
    /// What a shader tells a client.
    ShaderToClient {
        /// See [`Refuse`].
        Refuse(Refuse) = 2, at most limit::OPENING;
        /// See [`Ping`].
        Ping(Ping) = 3, at most limit::CONTROL;
        /// See [`Pong`].
        Pong(Pong) = 4, at most limit::CONTROL;
        /// See [`Goodbye`].
        Goodbye(Goodbye) = 5, at most limit::CONTROL;
        /// See [`TileWelcome`].
        Welcome(TileWelcome) = 48, at most limit::CONTROL;
        /// See [`TileDone`].
        TileDone(TileDone) = 49, at most limit::TILE_PIXELS as u32 + 256;
        /// See [`TileFailed`].
        TileFailed(TileFailed) = 50, at most limit::CONTROL;
    }
}

messages! {
    /// What a client tells a shader.
    ClientToShader {
        /// See [`Ping`].
        Ping(Ping) = 3, at most limit::CONTROL;
        /// See [`Pong`].
        Pong(Pong) = 4, at most limit::CONTROL;
        /// See [`Goodbye`].
        Goodbye(Goodbye) = 5, at most limit::CONTROL;
        /// See [`BeginFrame`].
        BeginFrame(BeginFrame) = 56, at most limit::CONTROL;
        /// See [`TileRequest`].
        TileRequest(TileRequest) = 57, at most limit::CONTROL;
        /// See [`CancelBefore`].
        CancelBefore(CancelBefore) = 58, at most limit::CONTROL;
    }
}

impl Control for TileWelcome {}
impl Control for TileFailed {}
impl Control for BeginFrame {}
impl Control for TileRequest {}
impl Control for CancelBefore {}

impl Body for TileDone {
    fn write(&self, out: &mut Vec<u8>) -> Result<(), String> {
        codec::write(&self.report, out)?;
        out.extend_from_slice(&self.pixels);
        Ok(())
    }

    fn read(bytes: &[u8]) -> Result<Self, String> {
        let (report, pixels) = codec::read(bytes)?;
        if pixels.len() > limit::TILE_PIXELS {
            return Err(format!("{} bytes of pixels are too many", pixels.len()));
        }
        Ok(Self {
            report,
            pixels: pixels.to_vec(),
        })
    }
}
