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
/// Invariants: lights rise; there is a list for each that is behind one, in the same order.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Box around the places that shadow rays start from.
    pub bounds: Aabb,
    /// Lights that somebody has tried to settle: the number, and the verdict in the lowest bits.
    verdicts: Box<[u32]>,
    lists: Box<[(u32, TriangleSet)]>,
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
                    lists.push((light, list));
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
        self.verdicts.iter().map(move |entry| {
            let proof = match entry & ((1 << BITS) - 1) {
                UNOCCLUDED => Proof::Unoccluded,
                HIDDEN => Proof::Hidden,
                OPEN => Proof::Open,
                _ => lists
                    .next()
                    .map_or(Proof::Open, |(_, list)| Proof::Behind(list)),
            };
            (entry >> BITS, proof)
        })
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
        Some(match self.verdicts[place] & ((1 << BITS) - 1) {
            UNOCCLUDED => Proof::Unoccluded,
            HIDDEN => Proof::Hidden,
            OPEN => Proof::Open,
            _ => {
                let list = self.lists.binary_search_by_key(&light, |entry| entry.0);
                list.map_or(Proof::Open, |place| Proof::Behind(&self.lists[place].1))
            }
        })
    }

    /// Whether something is certain of a light.
    #[must_use]
    pub fn is_settled(&self, light: u32) -> bool {
        let verdict = |place: usize| self.verdicts[place] & ((1 << BITS) - 1);
        self.place(light)
            .is_some_and(|place| verdict(place) != OPEN)
    }

    /// Takes back what was certain of a light.
    pub(crate) fn reopen(&mut self, light: u32) {
        if let Some(place) = self.place(light) {
            self.verdicts[place] |= OPEN;
            let lists = std::mem::take(&mut self.lists).into_vec();
            self.lists = lists.into_iter().filter(|list| list.0 != light).collect();
        }
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
        self.lists.iter().map(|(_, list)| list.len()).sum()
    }

    /// Whether its invariants hold; for tests.
    pub(crate) fn is_valid(&self) -> bool {
        let behind = self.verdicts.iter().filter(|&entry| entry & OPEN == BEHIND);
        let behind = behind.map(|entry| entry >> BITS);
        self.verdicts.is_sorted_by(|a, b| a >> BITS < b >> BITS)
            && behind.eq(self.lists.iter().map(|list| list.0))
    }

    /// Heap memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let lists: usize = self.lists.iter().map(|(_, list)| list.bytes()).sum();
        size_of_val(&self.verdicts[..]) + size_of_val(&self.lists[..]) + lists
    }

    fn place(&self, light: u32) -> Option<usize> {
        let number = |entry: &u32| entry >> BITS;
        self.verdicts.binary_search_by_key(&light, number).ok()
    }
}
