use lie_geom::Aabb;

use crate::TriangleSet;

/// What is certain of a light everywhere in a cell's region, whatever samples say. `L` is how
/// the list is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof<L = TriangleSet> {
    /// Nothing is in the way.
    Unoccluded,
    /// Every segment to it is blocked.
    Hidden,
    /// Nothing but these triangles can be in the way.
    Behind(L),
    /// It could not be settled: samples have to do.
    Open,
}

impl Proof<&TriangleSet> {
    /// The same with a list of its own.
    #[must_use]
    pub fn cloned(self) -> Proof {
        match self {
            Self::Unoccluded => Proof::Unoccluded,
            Self::Hidden => Proof::Hidden,
            Self::Behind(list) => Proof::Behind(list.clone()),
            Self::Open => Proof::Open,
        }
    }
}

/// Where a cell's surfaces have been seen, and what is certain there.
///
/// Invariants: lights rise; there is one list for each that is behind one, in the same order.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Box around the places that shadow rays start from.
    pub bounds: Aabb,
    /// Lights that somebody has tried to settle: the number, and the verdict in the lowest bits.
    verdicts: Box<[u32]>,
    lists: Box<[TriangleSet]>,
}

/// Bits of a verdict.
const BITS: u32 = 2;
const UNOCCLUDED: u32 = 0;
const HIDDEN: u32 = 1;
const BEHIND: u32 = 2;
const OPEN: u32 = 3;

impl Default for Region {
    fn default() -> Self {
        Self::new(Aabb::EMPTY, vec![])
    }
}

impl Region {
    /// What is certain in a box, of lights below 2³⁰ in rising order.
    #[must_use]
    pub fn new(bounds: Aabb, lights: Vec<(u32, Proof)>) -> Self {
        let mut lists = vec![];
        let verdicts = lights.into_iter().map(|(light, proof)| {
            let verdict = match proof {
                Proof::Unoccluded => UNOCCLUDED,
                Proof::Hidden => HIDDEN,
                Proof::Behind(list) => {
                    lists.push(list);
                    BEHIND
                }
                Proof::Open => OPEN,
            };
            light << BITS | verdict
        });
        Self {
            bounds,
            verdicts: verdicts.collect(),
            lists: lists.into(),
        }
    }

    /// Lights that somebody has tried to settle, in order of their number.
    pub fn lights(&self) -> impl Iterator<Item = (u32, Proof<&TriangleSet>)> {
        let mut lists = self.lists.iter();
        self.verdicts
            .iter()
            .map(move |entry| (entry >> BITS, proof_of(*entry, || lists.next())))
    }

    /// Whether nobody has tried to settle any light.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.verdicts.is_empty()
    }

    /// How many lights somebody has tried to settle.
    #[must_use]
    pub fn len(&self) -> usize {
        self.verdicts.len()
    }

    /// What is certain of a light; `None` if nobody has tried.
    #[must_use]
    pub fn proof(&self, light: u32) -> Option<Proof<&TriangleSet>> {
        let place = self.place(light)?;
        let list = || self.lists.get(self.lists_before(place));
        Some(proof_of(self.verdicts[place], list))
    }

    /// Whether something is certain of a light.
    #[must_use]
    pub fn is_settled(&self, light: u32) -> bool {
        let is_open = |place: usize| verdict_of(self.verdicts[place]) == OPEN;
        self.place(light).is_some_and(|place| !is_open(place))
    }

    /// Takes back what was certain of a light.
    pub(crate) fn reopen(&mut self, light: u32) {
        let Some(place) = self.place(light) else {
            return;
        };
        if verdict_of(self.verdicts[place]) == BEHIND {
            let mut lists = std::mem::take(&mut self.lists).into_vec();
            lists.remove(self.lists_before(place));
            self.lists = lists.into();
        }
        self.verdicts[place] |= OPEN;
    }

    /// Lights that are certain to reach some of it.
    #[must_use]
    pub fn lit(&self) -> usize {
        let is_lit = |entry: &(u32, Proof<&TriangleSet>)| {
            matches!(entry.1, Proof::Unoccluded | Proof::Behind(_))
        };
        self.lights().filter(is_lit).count()
    }

    /// Triangles in all of its lists.
    #[must_use]
    pub fn listed(&self) -> usize {
        self.lists.iter().map(TriangleSet::len).sum()
    }

    /// Whether its invariants hold; for tests.
    pub(crate) fn is_valid(&self) -> bool {
        self.verdicts.is_sorted_by(|a, b| a >> BITS < b >> BITS)
            && self.lists_before(self.verdicts.len()) == self.lists.len()
    }

    /// Lists of the lights before the one at a place.
    fn lists_before(&self, place: usize) -> usize {
        let before = self.verdicts[..place].iter();
        before.filter(|&&entry| verdict_of(entry) == BEHIND).count()
    }

    fn place(&self, light: u32) -> Option<usize> {
        let number = |entry: &u32| entry >> BITS;
        self.verdicts.binary_search_by_key(&light, number).ok()
    }
}

/// A verdict as it is held.
fn verdict_of(entry: u32) -> u32 {
    entry & ((1 << BITS) - 1)
}

fn proof_of<'a>(
    entry: u32,
    list: impl FnOnce() -> Option<&'a TriangleSet>,
) -> Proof<&'a TriangleSet> {
    match verdict_of(entry) {
        UNOCCLUDED => Proof::Unoccluded,
        HIDDEN => Proof::Hidden,
        BEHIND => list().map_or(Proof::Open, Proof::Behind),
        _ => Proof::Open,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lights() -> Vec<(u32, Proof)> {
        vec![
            (1, Proof::Behind([4, 2].into())),
            (3, Proof::Hidden),
            (4, Proof::Unoccluded),
            (7, Proof::Behind([9].into())),
            (8, Proof::Open),
            (9, Proof::Behind([1, 300].into())),
        ]
    }

    fn check(region: &Region, expected: &[(u32, Proof)]) {
        assert!(region.is_valid());
        let found = region
            .lights()
            .map(|(light, proof)| (light, proof.cloned()));
        assert_eq!(found.collect::<Vec<_>>(), expected);
        for light in 0..12 {
            let known = expected.iter().find(|entry| entry.0 == light);
            let known = known.map(|entry| &entry.1);
            assert_eq!(region.proof(light).map(Proof::cloned).as_ref(), known);
            let is_settled = known.is_some_and(|proof| *proof != Proof::Open);
            assert_eq!(region.is_settled(light), is_settled);
        }
    }

    #[test]
    fn what_is_certain_comes_out_as_it_went_in() {
        let region = Region::new(Aabb::EMPTY, lights());
        check(&region, &lights());
        assert_eq!((region.len(), region.lit(), region.listed()), (6, 4, 5));
        check(&Region::default(), &[]);
    }

    #[test]
    fn what_is_taken_back_is_open_and_has_no_list() {
        let mut region = Region::new(Aabb::EMPTY, lights());
        let mut expected = lights();
        for (place, light) in [(3, 7), (1, 3), (4, 8), (0, 1)] {
            region.reopen(light);
            expected[place].1 = Proof::Open;
            check(&region, &expected);
        }
        region.reopen(100);
        check(&region, &expected);
    }
}
