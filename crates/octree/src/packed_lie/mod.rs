//! A cell at rest. There are tens of thousands, of which few are asked at any time: one takes as
//! few bytes as it can, in one piece, and is unpacked to be read or changed.
//!
//! Numbers are of variable length (LEB128) or, where they are floats, little-endian. First
//! the counts, then the region, then light by light what samples say. Occluders keep their order.

mod bytes;
mod decode;
mod encode;

pub(crate) use bytes::{BytesError, Reader, Writer};
pub(crate) use decode::{Limits, lie};

use crate::Lie;

/// A [`Lie`] in few bytes. Equal ones have equal bytes.
///
/// Invariant: the bytes are those of a whole [`Lie`], and the counts are its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedLie {
    bytes: Box<[u8]>,
    counts: Counts,
}

/// What is counted often, of every cell there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Counts {
    /// Samples taken in it.
    pub(crate) samples: u32,
    /// Lights that reach it, by samples or by proof.
    pub(crate) entries: u32,
    /// Those of them that are masked.
    pub(crate) masked: u32,
    /// Triangles in all of its lists.
    pub(crate) occluders: u32,
}

impl Default for PackedLie {
    fn default() -> Self {
        Self::of(&Lie::default())
    }
}

impl PackedLie {
    /// The same in few bytes.
    #[must_use]
    pub fn of(lie: &Lie) -> Self {
        let mut out = Writer::default();
        encode::lie(&mut out, lie);
        let masked = lie.lights().filter(|entry| entry.mask.is_some());
        Self {
            bytes: out.0.into(),
            counts: Counts {
                samples: lie.samples,
                entries: (lie.lights().count() + lie.region.lit()) as u32,
                masked: masked.count() as u32,
                occluders: (lie.listed() + lie.region.listed()) as u32,
            },
        }
    }

    /// The same in the form that is read and changed.
    #[must_use]
    pub fn unpack(&self) -> Lie {
        match lie(&mut Reader(&self.bytes), None) {
            Ok(lie) => lie,
            Err(_) => unreachable!("its bytes were those of a whole one"),
        }
    }

    /// What it is held in.
    pub(crate) fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(crate) fn counts(&self) -> Counts {
        self.counts
    }

    /// Memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Self>() + self.bytes.len()
    }
}

/// What leads the evidence of a light.
mod flag {
    pub(super) const INHERITED: u8 = 1;
    pub(super) const CROWDED: u8 = 2;
    pub(super) const LEFT_OUT: u8 = 4;
    pub(super) const WHOLE: u8 = 8;
    /// Luminances follow: they are not both 0.
    pub(super) const LUMINANCES: u8 = 16;
    /// A list of occluders follows.
    pub(super) const OCCLUDERS: u8 = 32;
    pub(super) const ALL: u8 = 63;
}

/// What is certain of a light, in two bits.
mod verdict {
    pub(super) const UNOCCLUDED: u64 = 0;
    pub(super) const HIDDEN: u64 = 1;
    pub(super) const BEHIND: u64 = 2;
    pub(super) const OPEN: u64 = 3;
    pub(super) const BITS: u32 = 2;
}

#[cfg(test)]
mod tests;
