//! Everything in the house that reads bytes from outside, as [`Target`]s: what to feed, what to
//! do with it as the processes do, and how much memory that may take. Nothing here is part of
//! the product; `tests/mutations` and `fuzz/` drive it.
//!
//! * [`TARGETS`] are the targets: messages, scenes on the wire, trees, snapshots, scene files,
//!   bundles. Each has seeds of its own, made by the product itself.
//! * [`mutated`] spoils a seed. What comes out follows from a seed and a number alone.
//!
//! A target must never panic, hang, or take more memory than it says, whatever it is fed.
//!
//! ```
//! let target = lie_trial::TARGETS.iter().find(|target| target.name == "bundle").expect("one");
//! let mut run = (target.open)();
//! assert!(!run(b"anything at all"));
//! ```

#![allow(
    clippy::unwrap_used,
    reason = "what is made here is known to be right; only what is fed is not"
)]

mod bundle;
mod dice;
mod fixture;
mod lies;
mod messages;
mod mutate;
mod scene_blob;
mod scenes;

pub use dice::Dice;
pub use messages::Way;
pub use mutate::mutated;

/// Something that reads bytes from outside.
pub struct Target {
    /// What it is called, on command lines and in folders.
    pub name: &'static str,
    /// Good input, which mutations start from.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Gets ready to read any number of inputs. No input has an effect on another.
    pub open: fn() -> Run,
    /// Memory that reading one input may take at most.
    pub memory: Memory,
    /// How its seeds are written, and so how they are best spoilt.
    pub form: Form,
}

/// Reads an input, and says whether anything in it was taken for good.
pub type Run = Box<dyn FnMut(&[u8]) -> bool>;

/// A limit of memory: so many bytes, and so many more for each byte of input.
#[derive(Clone, Copy, Debug)]
pub struct Memory {
    /// Whatever the input.
    pub fixed: usize,
    /// For each byte of it.
    pub for_each: usize,
}

impl Memory {
    /// The limit for an input of so many bytes.
    #[must_use]
    pub fn of(self, input: usize) -> usize {
        self.fixed + self.for_each * input
    }
}

/// How input is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Bytes.
    Bytes,
    /// Text.
    Text,
    /// Several files, of which some are text.
    Files,
}

/// All there are.
pub const TARGETS: [Target; 8] = [
    messages::TARGET,
    scene_blob::TARGET,
    lies::TREE,
    lies::SNAPSHOT,
    scenes::OBJ,
    scenes::GLTF,
    scenes::TOML,
    bundle::TARGET,
];
