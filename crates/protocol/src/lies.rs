use serde::{Deserialize, Serialize};

use crate::{
    body::{Body, Control},
    bounded, codec, limit,
};

/// How the constructor's octree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WireLieSettings {
    /// Levels below the root.
    pub max_depth: u32,
    /// Sum of occluders above which a cell splits.
    pub split_threshold: u32,
    /// Samples that must agree before a light in a cell is relied on.
    pub trust: u32,
}

/// One part of an update: the newest states of the cells that have changed between two
/// versions. The receiver applies all parts together when the last one is there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LieDelta {
    /// What the receiver must have; 0 is a snapshot, which replaces everything.
    pub from_version: u64,
    /// What the receiver then has.
    pub to_version: u64,
    /// Counts the parts from 0.
    pub part: u32,
    /// Whether no part follows.
    pub last: bool,
    /// Parents before children over all parts.
    #[serde(deserialize_with = "bounded::list::<{ limit::CELLS }, _, _>")]
    pub cells: Vec<WireCell>,
}

/// What a replay reads of a [`LieDelta`]: everything but the cells, which follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LieDeltaHead {
    /// See [`LieDelta::from_version`].
    pub from_version: u64,
    /// See [`LieDelta::to_version`].
    pub to_version: u64,
    /// See [`LieDelta::part`].
    pub part: u32,
    /// See [`LieDelta::last`].
    pub last: bool,
}

impl Body for LieDeltaHead {
    fn write(&self, out: &mut Vec<u8>) -> Result<(), String> {
        codec::write(self, out)
    }

    fn read(bytes: &[u8]) -> Result<Self, String> {
        codec::read(bytes).map(|(head, _cells)| head)
    }
}

/// An octree cell's whole state: applying it twice is the same as once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireCell {
    /// A leading 1, then three bits per level.
    pub key: u64,
    /// Rises with every change of the cell.
    pub version: u64,
    /// The state.
    pub body: WireBody,
}

/// What a cell is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum WireBody {
    /// Split into eight.
    Interior,
    /// What is trusted of each light; one in no list is doubtful.
    Leaf {
        /// Smallest and largest corner of the box that the rest is about; none is all of the
        /// cell.
        region: Option<[[f32; 3]; 2]>,
        /// The lights that reach the cell, in rising order.
        #[serde(deserialize_with = "bounded::list::<{ limit::LIGHTS }, _, _>")]
        lights: Vec<WireLight>,
        /// The lights that do not, in rising order.
        #[serde(deserialize_with = "bounded::list::<{ limit::LIGHTS }, _, _>")]
        hidden: Vec<u32>,
        /// The lights whose rays to the cell go through the scene, in rising order.
        #[serde(deserialize_with = "bounded::list::<{ limit::LIGHTS }, _, _>")]
        crowded: Vec<u32>,
    },
}

/// A light that reaches a cell.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WireLight {
    /// Its number.
    pub light: u32,
    /// Triangles that block some of its rays to the cell; none if it is unoccluded.
    #[serde(deserialize_with = "bounded::list::<{ limit::OCCLUDERS }, _, _>")]
    pub occluders: Vec<u32>,
}

/// The receiver has missed something and wants a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ResyncRequest {
    /// What it has.
    pub have_version: u64,
}

/// What audits on a shader have come to since its last report.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AuditReport {
    /// Shadow rays that LIEs answer for, and that were traced to see.
    pub rays: u64,
    /// How many of them the LIEs had wrong, those that are not listed included.
    pub wrong: u64,
    /// Some of these.
    #[serde(deserialize_with = "bounded::list::<{ limit::MISMATCHES }, _, _>")]
    pub mismatches: Vec<WireMismatch>,
}

/// A shadow ray that a cell answers wrongly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireMismatch {
    /// Number of the light.
    pub light: u32,
    /// Where the ray leaves the surface.
    pub point: [f32; 3],
    /// Start of the ray, at either end.
    pub origin: [f32; 3],
    /// To the other end.
    pub direction: [f32; 3],
    /// The part of it that counts, in units of `direction`.
    pub span: [f32; 2],
}

impl Control for AuditReport {}
impl Control for LieDelta {}
impl Control for ResyncRequest {}
