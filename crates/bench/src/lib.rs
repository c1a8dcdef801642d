//! Measurement: frames of several integrators in alternation, the paper's tables, the way
//! from a cold start to a converged picture, and what is written about them.
//!
//! * [`Stage`] is a view of a scene, ready to be measured; [`Contender`] what renders it.
//! * [`measure_frames`] renders a view by a [`Lineup`] of contenders in turn: [`table1`] and
//!   [`table2`] make the paper's tables of its [`FrameRow`]s, with the paper's own figures
//!   ([`paper`]) beside ours.
//! * [`builds`] says what the acceleration structures take.
//! * [`figure4`] shows what each pixel costs, as the paper's Figure 4.
//! * [`converge`] follows error and frame time while LIEs are constructed.
//! * [`growth`] measures frames over the number of lights and of triangles.
//! * [`farm`] renders on a farm in turn with this process.
//! * [`latency`] measures the way from input to picture.
//! * [`scale`] sees how a farm grows, with shaders that are simulated.
//! * [`peers`] lets another program render the same scene in turn with ours.
//! * [`Table`], [`plot`], [`Report`] and [`Machine`] are what comes out: text, Markdown, SVG.
//!
//! Times are milliseconds on the wall. Every time stands beside the error of its picture,
//! and every speed-up is a ratio of frames that were rendered one after the other.
//!
//! ```no_run
//! use std::sync::Arc;
//! use lie_bench::{Contender, Effort, FramesConfig, Lineup, Stage, measure_frames, table1};
//! use lie_farm::ConstructSettings;
//! use lie_render::AccelKind;
//!
//! # fn scene() -> lie_scene::Scene { unimplemented!() }
//! let scene = Arc::new(scene());
//! let camera = scene.cameras[0].clone();
//! let size = glam::UVec2::splat(512);
//! let stage = Stage::new("scenes/bar", scene, camera, size, AccelKind::default());
//! let settings = ConstructSettings::new(stage.world().scene());
//! let effort = Effort::UntilConverged { max_passes: 64 };
//! let lineup = Lineup::construct(&stage, Contender::ALL, settings, effort, &|_, _| {})?;
//! let config = FramesConfig { threads: vec![1, 2], repeat: 3 };
//! let frames = measure_frames(&stage, &lineup, &config, &|_, _| {})?;
//! println!("{}", table1::table(&frames.rows).text());
//! # Ok::<(), lie_bench::BenchError>(())
//! ```

mod construct;
mod contender;
mod error;
mod frames;
mod machine;
mod race;
mod report;
mod spread;
mod stage;
mod table;

pub mod builds;
pub mod converge;
pub mod farm;
pub mod figure4;
pub mod growth;
pub mod latency;
pub mod paper;
pub mod peers;
pub mod plot;
pub mod proxy;
pub mod scale;
pub mod table1;
pub mod table2;

pub use construct::{Effort, Lineup};
pub use contender::Contender;
pub use error::BenchError;
pub use frames::{FrameRow, FramesConfig, SceneFrames, measure_frames};
pub use machine::Machine;
pub use race::Stages;
pub use report::{Figure, Panel, Picture, Report, Section};
pub use spread::Spread;
pub use stage::Stage;
pub use table::Table;

/// Told what is being done and the share of it that is done, in `[0, 1]`.
pub type Progress<'a> = dyn Fn(&str, f32) + Sync + 'a;
