//! What the processes say to each other, as bytes.
//!
//! Sans-IO: nothing here knows a socket or a clock, and no type of the renderer; `lie-farm`
//! converts. Every message is a frame: a 12-byte [`Header`], then a body whose greatest
//! length is stated per kind and checked before anything is allocated.
//!
//! Who talks to whom, each direction an enum of its own, so that a message in the wrong
//! place is an error and never a match arm:
//!
//! | from → to | messages |
//! |---|---|
//! | whoever dials → whoever listens, first | [`Opening`] |
//! | constructor ⇄ shader | [`ConstructorToShader`], [`ShaderToConstructor`] |
//! | constructor → replay, as a shader | [`ConstructorToReplay`] |
//! | constructor ⇄ client | [`ConstructorToClient`], [`ClientToConstructor`] |
//! | shader ⇄ client | [`ShaderToClient`], [`ClientToShader`] |
//! | constructor → observer | [`ConstructorToObserver`] |
//!
//! ```
//! use lie_protocol::{Decoder, Opening, Refuse, encode};
//!
//! let mut bytes = Vec::new();
//! encode(&Opening::Refuse(Refuse::new("full")), &mut bytes).expect("a short text");
//! let mut decoder = Decoder::default();
//! decoder.push(&bytes);
//! let message: Option<Opening> = decoder.next().expect("bytes of our own");
//! assert_eq!(message, Some(Opening::Refuse(Refuse::new("full"))));
//! ```

#[macro_use]
mod message;

mod body;
mod bounded;
pub mod codec;
mod constructor_client;
mod constructor_shader;
mod decoder;
mod error;
mod header;
mod hello;
mod lies;
pub mod limit;
mod session;
mod shader_client;
mod status;
mod text;
mod view;

pub use constructor_client::{
    CameraUpdate, ClientToConstructor, ClientWelcome, ConstructorToClient, LieStatus, Roster,
    RosterEntry,
};
pub use constructor_shader::{
    ConstructorToReplay, ConstructorToShader, SceneChunk, SceneReady, SceneRequest, ShaderReady,
    ShaderToConstructor, ShaderWelcome, Subscribe,
};
pub use decoder::{Decoder, encode};
pub use error::ProtocolError;
pub use header::{Header, MAGIC, PROTOCOL_VERSION};
pub use hello::{Hello, Opening, Refuse, Role};
pub use lies::{
    AuditReport, LieDelta, LieDeltaHead, ResyncRequest, WireBody, WireCell, WireLieSettings,
    WireLight, WireMismatch,
};
pub use message::Message;
pub use session::{Goodbye, Ping, Pong};
pub use shader_client::{
    BeginFrame, CancelBefore, ClientToShader, Compression, PixelFormat, ShaderToClient, TileDone,
    TileFailed, TileReport, TileRequest, TileWelcome, WireCost, WireIntegrator,
};
pub use status::{
    ClientReport, ClientStatus, ConstructorToObserver, FarmStatus, ShaderHealth, ShaderReport,
    ShaderStatus,
};
pub use text::Text;
pub use view::{
    SceneHash, SceneSummary, WireCamera, WireKeyFrame, WireRenderSettings, WireWalkthrough,
};
