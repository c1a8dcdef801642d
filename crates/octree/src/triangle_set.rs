/// Some triangles' numbers, rising, packed: each as its distance from the one before, in seven
/// bits to a byte, the lowest first. There are millions, and neighbours have neighbouring numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TriangleSet {
    packed: Box<[u8]>,
}

/// Marks a byte that more of its number follow.
const MORE: u8 = 0x80;

impl TriangleSet {
    /// The numbers, rising.
    pub fn iter(&self) -> impl Iterator<Item = u32> {
        let mut before = 0u32;
        let mut rest = self.packed.iter();
        std::iter::from_fn(move || {
            let (mut distance, mut shift) = (0u32, 0);
            loop {
                let &byte = rest.next()?;
                distance |= u32::from(byte & !MORE) << shift;
                if byte & MORE == 0 {
                    break;
                }
                shift += 7;
            }
            before = before.wrapping_add(distance);
            Some(before)
        })
    }

    /// How many there are. Counts them.
    #[must_use]
    pub fn len(&self) -> usize {
        self.packed.iter().filter(|&byte| byte & MORE == 0).count()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.packed.is_empty()
    }

    /// Whether a triangle is one of them.
    #[must_use]
    pub fn contains(&self, triangle: u32) -> bool {
        self.iter()
            .take_while(|&known| known <= triangle)
            .any(|known| known == triangle)
    }

    /// What it is held in.
    pub(crate) fn as_bytes(&self) -> &[u8] {
        &self.packed
    }

    /// From what another is held in.
    pub(crate) fn from_own(packed: &[u8]) -> Self {
        Self {
            packed: packed.into(),
        }
    }

    /// From whatever bytes; `None` if no set of triangles below `end` is held in them.
    pub(crate) fn from_any(packed: &[u8], end: u32) -> Option<Self> {
        let mut triangles = vec![];
        let (mut distance, mut shift, mut before) = (0u64, 0, 0u64);
        for &byte in packed {
            if shift > 28 {
                return None;
            }
            distance |= u64::from(byte & !MORE) << shift;
            shift += 7;
            if byte & MORE == 0 {
                before += distance;
                triangles.push(u32::try_from(before).ok().filter(|&number| number < end)?);
                (distance, shift) = (0, 0);
            }
        }
        // Each set is held in one way only.
        let set = Self::from(triangles);
        (*set.packed == *packed).then_some(set)
    }
}

impl From<Vec<u32>> for TriangleSet {
    /// In whatever order, and however often each is named.
    fn from(mut triangles: Vec<u32>) -> Self {
        triangles.sort_unstable();
        triangles.dedup();
        let mut packed = Vec::with_capacity(2 * triangles.len());
        let mut before = 0;
        for triangle in triangles {
            let mut distance = triangle - before;
            before = triangle;
            while distance >= u32::from(MORE) {
                packed.push(distance as u8 | MORE);
                distance >>= 7;
            }
            packed.push(distance as u8);
        }
        Self {
            packed: packed.into(),
        }
    }
}

impl<const N: usize> From<[u32; N]> for TriangleSet {
    fn from(triangles: [u32; N]) -> Self {
        triangles.to_vec().into()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn what_goes_in_comes_out(triangles in prop::collection::vec(
            prop_oneof![0..300u32, any::<u32>()], 0..80), other in any::<u32>()) {
            let expected: BTreeSet<u32> = triangles.iter().copied().collect();
            let set = TriangleSet::from(triangles);
            prop_assert_eq!(set.iter().collect::<Vec<_>>(), expected.iter().copied().collect::<Vec<_>>());
            prop_assert_eq!((set.len(), set.is_empty()), (expected.len(), expected.is_empty()));
            prop_assert!(expected.iter().all(|&triangle| set.contains(triangle)));
            prop_assert_eq!(set.contains(other), expected.contains(&other));
            let last = expected.last().copied();
            let end = last.map_or(0, |last| last.saturating_add(1));
            if last != Some(u32::MAX) {
                prop_assert_eq!(TriangleSet::from_any(set.as_bytes(), end), Some(set.clone()));
            }
            if let Some(last) = last {
                prop_assert_eq!(TriangleSet::from_any(set.as_bytes(), last), None);
            }
        }

        #[test]
        fn whatever_is_taken_for_one_is_one(bytes in prop::collection::vec(any::<u8>(), 0..12), end in any::<u32>()) {
            if let Some(set) = TriangleSet::from_any(&bytes, end) {
                let triangles: Vec<u32> = set.iter().collect();
                prop_assert!(triangles.is_sorted_by(|a, b| a < b) && triangles.iter().all(|&it| it < end));
                prop_assert_eq!(TriangleSet::from(triangles), set);
            }
        }
    }
}
