//! The processes of the renderer and what they share.
//!
//! * [`constructor::run`] holds the scene and learns the LIEs; [`shader::run`] renders
//!   tiles; [`client::Client`] puts frames together; [`launch::Farm`] starts them all on
//!   this machine, [`walk::walk`] takes a walk through a scene, and [`steer::steer`]
//!   follows whoever moves the camera.
//! * [`replay::run`] stands in for many shaders, to see how a farm of them would go.
//! * [`scheduler::Scheduler`] decides who renders which tile, and [`scene_blob`] and
//!   [`cache`] bring the scene to the shaders; [`snapshot`] keeps LIEs over restarts.
//! * [`connection`], [`handshake`], [`network`] and [`outbox`] are what every connection
//!   has: nothing above them knows that it is TCP. [`secure`] is who belongs to a cluster,
//!   and mutual TLS between those who do. [`discovery`] finds a constructor on a local network.
//! * [`Builder`] constructs LIEs, [`LieReplica`] is a shader's copy of them, and
//!   [`inspect::inspect`] says of one pixel what they know and what they make of it.
//!
//! Waiting for the network happens on tokio; construction and rendering have plain threads
//! of their own and never run on its workers.
//!
//! ```no_run
//! use lie_farm::{client::{Client, ClientConfig, ClientError}, network::Exposure};
//!
//! # async fn example() -> Result<(), ClientError> {
//! let client = Client::connect(ClientConfig::new("127.0.0.1:7400", Exposure::Loopback)).await?;
//! client.wait_for_shaders(1).await;
//! println!("{} with {} lights", client.scene().name, client.scene().lights);
//! # Ok(())
//! # }
//! ```

pub mod cache;
pub mod client;
pub mod connection;
mod construct;
pub mod constructor;
pub mod convert;
pub mod discovery;
mod exposure;
mod file;
pub mod handshake;
pub mod inspect;
pub mod launch;
mod metrics;
pub mod network;
mod once;
pub mod outbox;
pub mod pixels;
pub mod replay;
mod replica;
pub mod scene_blob;
pub mod scheduler;
pub mod secure;
mod serve;
pub mod shader;
pub mod snapshot;
pub mod status;
pub mod steer;
pub mod walk;

pub use construct::{BatchReport, Builder, ConstructSettings, Order, PastView, Snapshot, View};
pub use replica::{LieReplica, PublishedLies, ReplicaError};
