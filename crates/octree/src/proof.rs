use lie_geom::Aabb;

/// What is certain of a light everywhere in a cell's region, whatever samples say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Proof {
    /// Nothing is in the way.
    Unoccluded,
    /// Every segment to it is blocked.
    Hidden,
    /// Nothing but these triangles can be in the way.
    Behind(Box<[u32]>),
    /// It could not be settled: samples have to do.
    Open,
}

/// Where a cell's surfaces have been seen, and what is certain there.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Box around the places that shadow rays start from.
    pub bounds: Aabb,
    /// Lights that somebody has tried to settle, in order of their number.
    pub lights: Vec<(u32, Proof)>,
}

impl Default for Region {
    fn default() -> Self {
        Self {
            bounds: Aabb::EMPTY,
            lights: vec![],
        }
    }
}

impl Region {
    /// What is certain of a light; `None` if nobody has tried.
    #[must_use]
    pub fn proof(&self, light: u32) -> Option<&Proof> {
        let place = self.lights.binary_search_by_key(&light, |entry| entry.0);
        place.ok().map(|place| &self.lights[place].1)
    }

    /// Whether something is certain of a light.
    #[must_use]
    pub fn is_settled(&self, light: u32) -> bool {
        self.proof(light).is_some_and(|proof| *proof != Proof::Open)
    }

    /// Lights that something is certain of.
    pub(crate) fn settled(&self) -> impl Iterator<Item = u32> {
        let settled = self
            .lights
            .iter()
            .filter(|(_, proof)| *proof != Proof::Open);
        settled.map(|(light, _)| *light)
    }

    /// Takes back what was certain of a light.
    pub(crate) fn reopen(&mut self, light: u32) {
        let place = self.lights.binary_search_by_key(&light, |entry| entry.0);
        if let Ok(place) = place {
            self.lights[place].1 = Proof::Open;
        }
    }

    /// Lights that are certain to reach some of it.
    #[must_use]
    pub fn lit(&self) -> usize {
        let is_lit =
            |entry: &&(u32, Proof)| matches!(entry.1, Proof::Unoccluded | Proof::Behind(_));
        self.lights.iter().filter(is_lit).count()
    }

    /// Triangles in all of its lists.
    #[must_use]
    pub fn listed(&self) -> usize {
        let listed = |(_, proof): &(u32, Proof)| match proof {
            Proof::Behind(list) => list.len(),
            _ => 0,
        };
        self.lights.iter().map(listed).sum()
    }

    /// Heap memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.lights[..]) + self.listed() * size_of::<u32>()
    }
}
