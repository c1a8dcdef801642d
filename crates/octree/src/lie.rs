use lie_geom::Aabb;

use crate::{
    Between, LieSettings, LieState, LightEvidence, LitLight, Mask, Observation, Outcome, Proof,
    Region, masking::Shown,
};

/// What the constructor knows of one cell.
///
/// Invariants: `lights` are in order of their number; every occluder blocked some sample's
/// ray to its light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lie {
    pub(crate) samples: u32,
    /// Samples that lights without evidence carried nothing to, those included that speak
    /// for the whole that this is a part of. Lights of the region are not asked where they are
    /// certain, or by a survey: this starts from nothing when one is in it no longer.
    pub(crate) dark: u32,
    pub(crate) lights: Vec<LightEvidence>,
    /// Where it was seen, and what is certain there.
    pub(crate) region: Region,
    /// What its own samples show of all lights together.
    pub(crate) shown: Shown,
    /// Tree version at which what shaders see of it last changed.
    pub(crate) version: u64,
}

/// How much a cell's knowledge of one light is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing<'a> {
    /// It reaches the cell, past these occluders.
    Lit(&'a LightEvidence),
    /// There is a proof of how it reaches the cell's region, or of that it does not.
    Certain,
    /// It does not reach the cell.
    Hidden,
    /// It reaches the cell past so much that asking the scene is cheaper.
    Crowded,
    /// Too few samples to say: a shader asks the scene.
    Doubtful,
}

/// Of rays from one point that all met the same, at most so many count: the next point is
/// worth more than the next ray.
const PER_SAMPLE: u32 = 2;

/// So many times the rays must agree on a light that geometry could not settle.
const OPEN: u32 = 4;

/// A plane through a cell leaves a surface in one of its parts about so much of its samples.
pub(crate) const QUARTER: u32 = 4;

impl Lie {
    /// A cell that was never sampled.
    pub(crate) fn empty(version: u64) -> Self {
        Self {
            version,
            ..Self::default()
        }
    }

    /// A part of this cell: what is known of the whole holds for each part, though it may
    /// say too much.
    pub(crate) fn part(&self, version: u64) -> Self {
        Self {
            samples: 0,
            dark: if self.region.is_empty() {
                self.dark / QUARTER
            } else {
                0
            },
            lights: self.lights.iter().map(LightEvidence::part).collect(),
            region: Region::default(),
            shown: Shown::default(),
            version,
        }
    }

    /// Keeps of what it inherited that which may block rays from its own bounds.
    pub(crate) fn narrow(&mut self, bounds: Aabb, geometry: &impl Between) {
        // What lies on a border belongs to it, wherever rounding puts it.
        let room = 1.0e-4 * bounds.size();
        let ends = Aabb {
            min: bounds.min - room,
            max: bounds.max + room,
        };
        for entry in &mut self.lights {
            if !entry.occluders.is_empty() {
                entry.narrow(geometry.between(entry.light, ends));
            }
        }
    }

    /// Samples taken in the cell.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Samples that speak for lights without evidence: these carried nothing to any of them.
    #[must_use]
    pub fn dark(&self) -> u32 {
        self.dark
    }

    /// Where it was seen, and what is certain there.
    #[must_use]
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// Takes over what has become certain, and where.
    pub(crate) fn settle(&mut self, region: Region) {
        self.lights.retain(|entry| !region.is_settled(entry.light));
        let is_lost = |(light, _)| region.proof(light).is_none();
        if self.region.lights().any(is_lost) {
            self.dark = 0;
        }
        self.region = region;
    }

    /// Whether nothing is known of it.
    pub(crate) fn is_blank(&self) -> bool {
        self.lights.is_empty() && self.dark == 0
    }

    /// Whether shaders are told nothing of it: no sample is its own, and what it inherited is
    /// too little to be relied on. Without doubt they rely on that as well.
    pub(crate) fn is_untold(&self, trust: u32) -> bool {
        self.is_blank() || (trust > 0 && self.samples == 0)
    }

    /// Whether enough rays agree on a light.
    fn is_trusted(&self, entry: &LightEvidence, trust: u32) -> bool {
        entry.is_trusted(self.trust_in(entry.light, trust))
    }

    /// Rays that must agree on a light. Where geometry could not settle it much is in the way,
    /// and it takes more of them.
    pub(crate) fn trust_in(&self, light: u32, trust: u32) -> u32 {
        let is_open = self.region.proof(light).is_some();
        trust.saturating_mul(if is_open { OPEN } else { 1 })
    }

    /// Whether a light that it has no evidence of is known to give it nothing: it shines
    /// elsewhere, or the cell's surfaces face away. Of one that may reach it by geometry, and could
    /// not be settled, samples have to tell; not all of them were asked.
    fn is_dark(&self, light: u32, trust: u32) -> bool {
        self.dark >= trust && self.region.proof(light).is_none()
    }

    /// The lights that reach the cell, in order of their number.
    pub fn lights(&self) -> impl Iterator<Item = &LightEvidence> {
        self.lights.iter().filter(|entry| entry.is_lit())
    }

    /// The lights that could light the cell but were never seen from it, in order of their
    /// number.
    pub fn hidden(&self) -> impl Iterator<Item = &LightEvidence> {
        self.lights.iter().filter(|entry| !entry.is_lit())
    }

    /// What is known of a light, seen or hidden.
    #[must_use]
    pub fn evidence(&self, light: u32) -> Option<&LightEvidence> {
        self.place(light).ok().map(|index| &self.lights[index])
    }

    /// What shaders make of a light, masking left aside, if `trust` rays must agree on one
    /// that gives all of a pixel's light, and fewer on one that gives less. At 0 they trust everything, as in
    /// the paper: what is not known to be lit is hidden.
    #[must_use]
    pub fn standing(&self, light: u32, trust: u32) -> Standing<'_> {
        if self.region.is_settled(light) {
            return Standing::Certain;
        }
        match self.evidence(light) {
            _ if trust > 0 && self.samples == 0 => Standing::Doubtful,
            Some(entry) if entry.crowded => Standing::Crowded,
            Some(entry) if !self.is_trusted(entry, trust) => Standing::Doubtful,
            Some(entry) if entry.is_lit() => Standing::Lit(entry),
            None if !self.is_dark(light, trust) => Standing::Doubtful,
            _ => Standing::Hidden,
        }
    }

    /// The cell's complexity: the sum of all occluders (LIE §4.1) that were seen to block a
    /// ray from it. A crowded light counts as more than `crowd`.
    #[must_use]
    pub fn complexity(&self, crowd: u32) -> usize {
        self.complexity_with(&self.region, crowd)
    }

    /// The same, if this were certain of it.
    #[must_use]
    pub fn complexity_with(&self, region: &Region, crowd: u32) -> usize {
        let is_left = |entry: &&LightEvidence| !region.is_settled(entry.light);
        let own = self.lights().filter(is_left);
        own.map(|entry| entry.confirmed(crowd)).sum::<usize>() + region.listed()
    }

    /// Occluders in all of its lists.
    #[must_use]
    pub fn listed(&self) -> usize {
        self.lights().map(|entry| entry.occluders.len()).sum()
    }

    /// Takes in what some samples saw: the three cases of LIE §4.1, and evidence. Rays that
    /// reached their lights count first, so that whatever blocked the others of the same
    /// light is kept.
    pub(crate) fn record<'a>(
        &mut self,
        samples: impl Iterator<Item = &'a Observation> + Clone,
        settings: &LieSettings,
    ) {
        for seen in samples.clone() {
            if self.region.is_empty() {
                let point = Aabb::around([seen.point]);
                self.region.bounds = self.region.bounds.union(point);
            }
            self.samples = self.samples.saturating_add(1);
            self.dark = self.dark.saturating_add(1);
            self.shown.record(seen);
        }
        let lights = samples.clone().flat_map(by_light);
        let outcomes = samples.flat_map(|seen| &seen.outcomes);
        for outcome in outcomes.clone() {
            if outcome.blocker.is_none() {
                self.entry(outcome).see(outcome.rays.min(PER_SAMPLE));
            }
        }
        for outcome in outcomes {
            if let Some(triangle) = outcome.blocker {
                let rays = outcome.rays.min(PER_SAMPLE);
                self.entry(outcome).block(triangle, rays, settings.crowd);
            }
        }
        for outcomes in lights {
            // All of them have entries by now.
            if let Ok(place) = self.place(outcomes[0].light) {
                self.lights[place].weigh(outcomes);
            }
        }
        for entry in &mut self.lights {
            entry.settle(settings.crowd);
        }
        self.mask(settings);
    }

    /// Whether what shaders rely on says otherwise than a ray that met `blocker`, or nothing.
    pub(crate) fn is_contradicted(&self, light: u32, blocker: Option<u32>, trust: u32) -> bool {
        match (self.standing(light, trust), blocker) {
            (Standing::Doubtful | Standing::Crowded, _) => false,
            (Standing::Certain, _) => match (self.region.proof(light), blocker) {
                (Some(Proof::Unoccluded), blocker) => blocker.is_some(),
                (Some(Proof::Behind(list)), Some(triangle)) => !list.contains(triangle),
                (Some(Proof::Hidden), blocker) => blocker.is_none(),
                _ => false,
            },
            (Standing::Lit(entry), Some(triangle)) => {
                let mut known = entry.occluders.iter();
                entry.mask.is_none() && !known.any(|known| known.triangle() == triangle)
            }
            (Standing::Lit(_), None) => false,
            (Standing::Hidden, blocker) => blocker.is_none(),
        }
    }

    /// Learns from a ray that a cell had wrong.
    pub(crate) fn contradict(&mut self, light: u32, blocker: Option<u32>, settings: &LieSettings) {
        self.region.reopen(light);
        let outcome = Outcome {
            blocker,
            importance: 1.0,
            ..Outcome::of(light)
        };
        let entry = self.entry(&outcome);
        match blocker {
            Some(triangle) => entry.block(triangle, 1, settings.crowd),
            None => entry.see(1),
        }
        entry.distrust();
        entry.settle(settings.crowd);
    }

    /// Where a light's evidence is, or would be.
    fn place(&self, light: u32) -> Result<usize, usize> {
        self.lights
            .binary_search_by_key(&light, |entry| entry.light)
    }

    /// Decides anew which lights the others mask.
    pub(crate) fn mask(&mut self, settings: &LieSettings) {
        self.shown.mask(&mut self.lights, settings);
    }

    /// The entry that an outcome belongs to, made first if there is none.
    fn entry(&mut self, outcome: &Outcome) -> &mut LightEvidence {
        let index = self.place(outcome.light).unwrap_or_else(|index| {
            self.lights.insert(index, LightEvidence::new(outcome.light));
            index
        });
        let entry = &mut self.lights[index];
        entry.matter(outcome.importance);
        entry
    }

    /// What shaders see of the cell, in a scene of so many lights.
    #[must_use]
    pub(crate) fn state(&self, trust: u32, lights_of_scene: u32) -> LieState {
        if self.is_untold(trust) {
            return LieState::default();
        }
        let trusted = |entry: &&LightEvidence| self.is_trusted(entry, trust);
        let sampled = self
            .lights()
            .filter(|entry| !entry.crowded && entry.mask != Some(Mask::LeftOut))
            .filter(trusted)
            .map(LightEvidence::to_lit);
        let mut lights: Vec<LitLight> = sampled.collect();
        lights.extend(self.region.lights().filter_map(|(light, proof)| {
            let occluders = match proof {
                Proof::Unoccluded => vec![],
                Proof::Behind(list) => list.iter().collect(),
                Proof::Hidden | Proof::Open => return None,
            };
            Some(LitLight { light, occluders })
        }));
        lights.sort_unstable_by_key(|lit| lit.light);
        LieState {
            lights,
            crowded: self
                .lights()
                .filter(|entry| entry.crowded)
                .map(|entry| entry.light)
                .collect(),
            // Without doubt, every light that is not lit is hidden: no need to name it. And
            // a cell is all that lies in it.
            hidden: if trust > 0 {
                self.left_out(trust, lights_of_scene)
            } else {
                vec![]
            },
            region: (trust > 0).then_some(self.region.bounds),
        }
    }

    /// The lights that are known to give the cell nothing, or are masked.
    fn left_out(&self, trust: u32, lights: u32) -> Vec<u32> {
        let mut rest = self.lights.iter().peekable();
        let is_left_out = |light: &u32| match rest.next_if(|entry| entry.light == *light) {
            Some(entry) => {
                let is_left_out = entry.mask == Some(Mask::LeftOut) || !entry.is_lit();
                is_left_out && self.is_trusted(entry, trust)
            }
            None => {
                let is_hidden = self.region.proof(*light) == Some(Proof::Hidden);
                is_hidden || self.is_dark(*light, trust)
            }
        };
        (0..lights).filter(is_left_out).collect()
    }
}

/// What a sample saw, light by light.
fn by_light(seen: &Observation) -> impl Iterator<Item = &[Outcome]> {
    // They were observed in that order.
    seen.outcomes.chunk_by(|a, b| a.light == b.light)
}

#[cfg(test)]
mod tests;
