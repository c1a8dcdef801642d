//! What a farm is doing, for people and scripts. Whatever a process says of itself here is
//! shown and never relied on.

use serde::{Deserialize, Serialize};

use crate::{LieStatus, Refuse, SceneHash, Text, body::Control, bounded, limit};

/// What a shader has done. Everything that is not of the moment counts from the start of its
/// process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShaderReport {
    /// Tiles rendered to their end.
    pub tiles: u64,
    /// Camera rays.
    pub camera_rays: u64,
    /// Shadow rays through the whole scene.
    pub shadow_rays: u64,
    /// Rays tested against an occluder list instead.
    pub list_rays: u64,
    /// Nanoseconds of rendering, summed over threads.
    pub render_ns: u64,
    /// The LIEs that tiles are shaded with now; 0 for none.
    pub lie_version: u64,
    /// Clients that are connected now.
    pub clients: u32,
    /// Tiles that were asked for and are not done now.
    pub outstanding: u32,
    /// Bytes sent to clients.
    pub sent_bytes: u64,
}

/// What a client has done. Counts from its start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClientReport {
    /// Frames asked for.
    pub frames: u64,
    /// Microseconds that the last finished frame took; 0 if there is none.
    pub frame_us: u64,
    /// Tiles that were in flight at shaders that went away.
    pub lost_tiles: u64,
    /// Tiles that were given to a second shader because they were late.
    pub reissued_tiles: u64,
}

/// How a shader is, as the constructor sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ShaderHealth {
    /// It fetches the scene or its first LIEs.
    Starting,
    /// It takes clients.
    Ready,
    /// It is connected and has said nothing for longer than it should.
    Silent,
}

/// A shader.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShaderStatus {
    /// Its number.
    pub id: u32,
    /// Where it takes clients, as `host:port`.
    pub address: Text,
    /// Its render threads, as it says.
    pub threads: u32,
    /// Whether it replays recorded costs instead of rendering.
    pub replays: bool,
    /// How it is.
    pub health: ShaderHealth,
    /// Milliseconds since it joined.
    pub joined_ms: u64,
    /// Milliseconds since anything was heard of it.
    pub heard_ms: u64,
    /// Microseconds from the last ping that it answered to the answer.
    pub ping_us: Option<u64>,
    /// Bytes sent to it.
    pub sent_bytes: u64,
    /// What it says of itself; none if it has not yet.
    pub report: Option<ShaderReport>,
}

/// A client.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClientStatus {
    /// Its number.
    pub id: u32,
    /// Where it connects from, as `host:port`.
    pub address: Text,
    /// Milliseconds since it joined.
    pub joined_ms: u64,
    /// Cameras that it has told the constructor.
    pub cameras: u64,
    /// What it says of itself; none if it has not yet.
    pub report: Option<ClientReport>,
}

/// A farm at one moment: the constructor's answer to an observer's hello.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FarmStatus {
    /// The constructor's build, for people.
    pub build: Text,
    /// The scene's name.
    pub scene: Text,
    /// Which scene it is.
    pub hash: SceneHash,
    /// How many triangles.
    pub triangles: u64,
    /// How many lights.
    pub lights: u64,
    /// Milliseconds since the constructor began to take connections.
    pub uptime_ms: u64,
    /// What it has learnt; its `camera_serial` means nothing here.
    pub lies: LieStatus,
    /// Construction samples per second, over the last seconds.
    pub samples_per_s: f32,
    /// Shaders that have joined so far.
    pub shaders_joined: u64,
    /// Those that were lost: they left without a word.
    pub shaders_lost: u64,
    /// Sorted by number.
    #[serde(deserialize_with = "bounded::list::<{ limit::SHADERS }, _, _>")]
    pub shaders: Vec<ShaderStatus>,
    /// Sorted by number.
    #[serde(deserialize_with = "bounded::list::<{ limit::CLIENTS }, _, _>")]
    pub clients: Vec<ClientStatus>,
}

messages! {
    /// What a constructor tells an observer: one message, then the connection closes. An observer
    /// says hello and nothing else.
    #[expect(clippy::large_enum_variant, reason = "there is never more than one")]
    ConstructorToObserver {
        /// See [`Refuse`].
        Refuse(Refuse) = 2, at most limit::OPENING;
        /// See [`FarmStatus`].
        Status(FarmStatus) = 64, at most limit::STATUS;
    }
}

impl Control for ShaderReport {}
impl Control for ClientReport {}
impl Control for FarmStatus {}
