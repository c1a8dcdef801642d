use serde::{Deserialize, Serialize};

use crate::{
    ClientReport, Goodbye, Ping, Pong, Refuse, SceneSummary, Text, WireCamera, body::Control,
    bounded, limit,
};

/// The constructor takes the client in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClientWelcome {
    /// The client's number, until the connection ends.
    pub id: u32,
    /// What there is to see.
    pub scene: SceneSummary,
}

/// All shaders that the constructor knows; replaces the roster before it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Roster {
    /// Sorted by number.
    #[serde(deserialize_with = "bounded::list::<{ limit::SHADERS }, _, _>")]
    pub shaders: Vec<RosterEntry>,
}

/// A shader.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RosterEntry {
    /// Its number.
    pub id: u32,
    /// Where it takes clients, as `host:port`.
    pub address: Text,
    /// Its render threads.
    pub threads: u32,
    /// Whether it has the scene and its first LIEs, and takes clients.
    pub ready: bool,
    /// Whether it replays recorded costs: it has no pictures to give.
    pub replays: bool,
}

/// Where a client looks now: what the constructor is to learn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraUpdate {
    /// Counts the client's cameras; comes back in [`LieStatus`].
    pub serial: u64,
    /// The view.
    pub camera: WireCamera,
    /// Pixels per row, and rows.
    pub size: [u32; 2],
}

/// What the constructor has learnt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LieStatus {
    /// Newest version of the LIEs.
    pub version: u64,
    /// The receiver's newest camera that this takes into account.
    pub camera_serial: u64,
    /// Octree cells.
    pub cells: u64,
    /// (Cell, light) pairs.
    pub entries: u64,
    /// (Cell, light, triangle) triples.
    pub occluders: u64,
    /// Memory of the LIEs.
    pub bytes: u64,
    /// Construction samples so far.
    pub samples: u64,
    /// Bytes sent to all shaders so far, scene included.
    pub sent_bytes: u64,
    /// Shadow rays that shaders have traced to see whether the LIEs are right.
    pub audit_rays: u64,
    /// How many of them the LIEs had wrong.
    pub audit_wrong: u64,
    /// Relative RMSE of the picture that is expected if the LIEs were used without trust.
    pub estimated_error: f32,
    /// Whether more samples would not help what the clients see now.
    pub converged: bool,
    /// Whether the LIEs will never change again.
    pub frozen: bool,
}

messages! {
    /// What a constructor tells a client.
    ConstructorToClient {
        /// See [`Refuse`].
        Refuse(Refuse) = 2, at most limit::OPENING;
        /// See [`Ping`].
        Ping(Ping) = 3, at most limit::CONTROL;
        /// See [`Pong`].
        Pong(Pong) = 4, at most limit::CONTROL;
        /// See [`Goodbye`].
        Goodbye(Goodbye) = 5, at most limit::CONTROL;
        /// See [`ClientWelcome`].
        Welcome(ClientWelcome) = 32, at most limit::SUMMARY;
        /// See [`Roster`].
        Roster(Roster) = 33, at most limit::ROSTER;
        /// See [`LieStatus`].
        LieStatus(LieStatus) = 34, at most limit::CONTROL;
    }
}

messages! {
    /// What a client tells the constructor.
    ClientToConstructor {
        /// See [`Ping`].
        Ping(Ping) = 3, at most limit::CONTROL;
        /// See [`Pong`].
        Pong(Pong) = 4, at most limit::CONTROL;
        /// See [`Goodbye`].
        Goodbye(Goodbye) = 5, at most limit::CONTROL;
        /// See [`CameraUpdate`].
        Camera(CameraUpdate) = 40, at most limit::CONTROL;
        /// See [`ClientReport`].
        Report(ClientReport) = 41, at most limit::CONTROL;
    }
}

impl Control for ClientWelcome {}
impl Control for Roster {}
impl Control for CameraUpdate {}
impl Control for LieStatus {}
