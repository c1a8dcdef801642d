use serde::{Deserialize, Serialize};

use crate::{
    AuditReport, Goodbye, LieDelta, LieDeltaHead, Ping, Pong, Refuse, ResyncRequest, SceneHash,
    ShaderReport, WireLieSettings,
    body::{Body, Control},
    codec, limit,
};

/// The constructor takes the shader in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShaderWelcome {
    /// The shader's number, until the connection ends.
    pub id: u32,
    /// The scene to render.
    pub scene: SceneHash,
    /// The scene's length in bytes, at most [`limit::SCENE`].
    pub scene_length: u64,
    /// How the LIEs are built.
    pub settings: WireLieSettings,
}

/// The shader does not have the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneRequest {
    /// Which scene.
    pub scene: SceneHash,
    /// First byte that is wanted: everything from here on.
    pub offset: u64,
}

/// A run of the scene's bytes. Body: the offset as bincode, then the bytes themselves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneChunk {
    /// Where the bytes belong.
    pub offset: u64,
    /// At most [`limit::SCENE_CHUNK`].
    pub bytes: Vec<u8>,
}

/// Every byte of the scene has been sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneReady {
    /// Which scene.
    pub scene: SceneHash,
}

/// The shader has the scene and wants LIEs: a snapshot, then updates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Subscribe {
    /// Which scene.
    pub scene: SceneHash,
}

/// The shader has taken in its first snapshot and takes clients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShaderReady {
    /// Which scene.
    pub scene: SceneHash,
}

messages! {
    /// What a constructor tells a shader.
    ConstructorToShader {
        /// See [`Refuse`].
        Refuse(Refuse) = 2, at most limit::OPENING;
        /// See [`Ping`].
        Ping(Ping) = 3, at most limit::CONTROL;
        /// See [`Pong`].
        Pong(Pong) = 4, at most limit::CONTROL;
        /// See [`Goodbye`].
        Goodbye(Goodbye) = 5, at most limit::CONTROL;
        /// See [`ShaderWelcome`].
        Welcome(ShaderWelcome) = 16, at most limit::CONTROL;
        /// See [`SceneChunk`].
        SceneChunk(SceneChunk) = 17, at most limit::SCENE_CHUNK as u32 + 16;
        /// See [`SceneReady`].
        SceneReady(SceneReady) = 18, at most limit::CONTROL;
        /// See [`LieDelta`].
        LieDelta(LieDelta) = 19, at most limit::LIE_DELTA;
    }
}

messages! {
    /// What a replay hears of what a constructor tells shaders: it has the scene's hash from its
    /// recording, and has no use for cells, whose decoding would be the cost of N shaders on one
    /// machine.
    ConstructorToReplay {
        /// See [`Refuse`].
        Refuse(Refuse) = 2, at most limit::OPENING;
        /// See [`Ping`].
        Ping(Ping) = 3, at most limit::CONTROL;
        /// See [`Pong`].
        Pong(Pong) = 4, at most limit::CONTROL;
        /// See [`Goodbye`].
        Goodbye(Goodbye) = 5, at most limit::CONTROL;
        /// See [`ShaderWelcome`].
        Welcome(ShaderWelcome) = 16, at most limit::CONTROL;
        /// See [`LieDelta`].
        LieDelta(LieDeltaHead) = 19, at most limit::LIE_DELTA;
    }
}

messages! {
    /// What a shader tells the constructor.
    ShaderToConstructor {
        /// See [`Ping`].
        Ping(Ping) = 3, at most limit::CONTROL;
        /// See [`Pong`].
        Pong(Pong) = 4, at most limit::CONTROL;
        /// See [`Goodbye`].
        Goodbye(Goodbye) = 5, at most limit::CONTROL;
        /// See [`SceneRequest`].
        SceneRequest(SceneRequest) = 24, at most limit::CONTROL;
        /// See [`Subscribe`].
        Subscribe(Subscribe) = 25, at most limit::CONTROL;
        /// See [`ResyncRequest`].
        Resync(ResyncRequest) = 26, at most limit::CONTROL;
        /// See [`ShaderReady`].
        Ready(ShaderReady) = 27, at most limit::CONTROL;
        /// See [`AuditReport`].
        Audit(AuditReport) = 28, at most limit::AUDIT;
        /// See [`ShaderReport`].
        Report(ShaderReport) = 29, at most limit::CONTROL;
    }
}

impl Control for ShaderWelcome {}
impl Control for SceneRequest {}
impl Control for SceneReady {}
impl Control for Subscribe {}
impl Control for ShaderReady {}

impl Body for SceneChunk {
    fn write(&self, out: &mut Vec<u8>) -> Result<(), String> {
        codec::write(&self.offset, out)?;
        out.extend_from_slice(&self.bytes);
        Ok(())
    }

    fn read(bytes: &[u8]) -> Result<Self, String> {
        let (offset, bytes) = codec::read(bytes)?;
        if bytes.len() > limit::SCENE_CHUNK {
            return Err(format!("{} bytes of a scene are too many", bytes.len()));
        }
        Ok(Self {
            offset,
            bytes: bytes.to_vec(),
        })
    }
}
