//! Every limit of the protocol, in one place. Lengths in bytes unless the name says otherwise.

/// Longest text for people: names, versions, reasons.
pub const TEXT: usize = 512;
/// Longest body of a small control message.
pub const CONTROL: u32 = 4 * 1024;
/// Longest hello or refusal, whatever version sent it.
pub const OPENING: u32 = 2 * 1024;
/// Bytes of the scene in one chunk.
pub const SCENE_CHUNK: usize = 1024 * 1024;
/// Longest scene.
pub const SCENE: u64 = 1 << 36;
/// Longest part of a LIE update.
pub const LIE_DELTA: u32 = 4 * 1024 * 1024;
/// Cells in one part of a LIE update.
pub const CELLS: usize = 1 << 20;
/// Lights in one cell.
pub const LIGHTS: usize = 1 << 20;
/// Occluders of one light in one cell.
pub const OCCLUDERS: usize = 1 << 20;
/// Wrong answers in one report of an audit.
pub const MISMATCHES: usize = 256;
/// Longest report of an audit.
pub const AUDIT: u32 = 64 * 1024;
/// Longest scene summary.
pub const SUMMARY: u32 = 4 * 1024 * 1024;
/// Cameras in a scene summary.
pub const CAMERAS: usize = 1024;
/// Walkthroughs in a scene summary.
pub const WALKTHROUGHS: usize = 256;
/// Key frames in one walkthrough.
pub const KEY_FRAMES: usize = 16 * 1024;
/// Shaders in a roster.
pub const SHADERS: usize = 1024;
/// Longest roster.
pub const ROSTER: u32 = 1024 * 1024;
/// Clients in a status.
pub const CLIENTS: usize = 256;
/// Longest status of a farm.
pub const STATUS: u32 = 1024 * 1024;
/// Longest side of a tile, in pixels.
pub const TILE_SIDE: u32 = 256;
/// Longest side of a frame, in pixels.
pub const FRAME_SIDE: u32 = 16 * 1024;
/// Pixels of a tile as bytes, at most: three `f32` each, and what a compressor may add.
pub const TILE_PIXELS: usize = (TILE_SIDE * TILE_SIDE) as usize * 12 + 16 * 1024;
