use std::num::NonZeroU64;

/// Which cell of an octree: the path from the root, three bits to a level behind a leading
/// one (a locational code). Bit 0 of an octant is x, bit 1 is y, bit 2 is z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellKey(NonZeroU64);

const EIGHT: NonZeroU64 = NonZeroU64::new(8).unwrap();

impl CellKey {
    /// The whole octree.
    pub const ROOT: Self = Self(NonZeroU64::MIN);

    /// Deepest cell that a key can name; the root has depth 0.
    pub const MAX_DEPTH: u32 = 20;

    /// A key from its number, if it is one.
    #[must_use]
    pub fn from_raw(raw: u64) -> Option<Self> {
        let bits = 64 - raw.leading_zeros();
        let valid = raw != 0 && bits % 3 == 1 && bits / 3 <= Self::MAX_DEPTH;
        if valid {
            NonZeroU64::new(raw).map(Self)
        } else {
            None
        }
    }

    /// The key as a number.
    #[must_use]
    pub fn raw(self) -> u64 {
        self.0.get()
    }

    /// Levels below the root.
    #[must_use]
    pub fn depth(self) -> u32 {
        (63 - self.0.leading_zeros()) / 3
    }

    /// The cell's child in an octant, `0..8`.
    ///
    /// # Panics
    /// Past [`Self::MAX_DEPTH`].
    #[must_use]
    pub fn child(self, octant: usize) -> Self {
        assert!(
            octant < 8 && self.depth() < Self::MAX_DEPTH,
            "no such child"
        );
        // The leading one stays, so the number is never zero.
        Self(self.0.saturating_mul(EIGHT) | octant as u64)
    }

    /// The octant taken at each level, from the root down.
    pub fn path(self) -> impl Iterator<Item = usize> {
        let (raw, depth) = (self.raw(), self.depth());
        (0..depth).map(move |level| (raw >> (3 * (depth - 1 - level)) & 7) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_name_paths() {
        let key = CellKey::ROOT.child(3).child(0).child(7);
        assert_eq!(key.depth(), 3);
        assert_eq!(key.path().collect::<Vec<_>>(), [3, 0, 7]);
        assert_eq!(CellKey::from_raw(key.raw()), Some(key));
        assert_eq!(CellKey::ROOT.path().count(), 0);
        let deepest = (0..20).fold(CellKey::ROOT, |key, _| key.child(7));
        assert_eq!(CellKey::from_raw(deepest.raw()), Some(deepest));
        assert_eq!(deepest.depth(), 20);
        for raw in [0, 2, 3, 4, 7, 16, u64::MAX, 1 << 63] {
            assert_eq!(CellKey::from_raw(raw), None, "{raw}");
        }
    }
}
