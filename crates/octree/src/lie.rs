use crate::{LieState, LitLight, Outcome};

/// What the constructor knows of one cell.
///
/// Invariants: `lights` are in order of their number and each was seen by some sample
/// (`clear ≥ 1`); every occluder blocked some sample's ray to its light; no light is both
/// in `lights` and `hidden`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lie {
    samples: u32,
    lights: Vec<LightEvidence>,
    hidden: Vec<HiddenLight>,
    /// Tree version at which what shaders see of it last changed.
    pub(crate) version: u64,
}

/// What the constructor knows of a light that reaches the cell.
#[derive(Clone, Debug, PartialEq)]
pub struct LightEvidence {
    /// Number of the light in the scene.
    pub light: u32,
    /// Samples that saw it.
    pub clear: u32,
    /// Samples that did not, counted since the first that did.
    pub blocked: u32,
    /// Samples that agreed with what was known, since one last added to it.
    pub agreed: u32,
    /// Largest [`Outcome::importance`] so far.
    pub importance: f32,
    /// The triangles that came in between, in the order of their discovery.
    pub occluders: Vec<Occluder>,
}

/// A light that no sample has seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HiddenLight {
    /// Number of the light in the scene.
    pub light: u32,
    /// Samples that did not see it.
    pub blocked: u32,
    /// Largest [`Outcome::importance`] so far.
    pub importance: f32,
}

/// A triangle that blocks a light somewhere in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occluder {
    /// Index in the scene.
    pub triangle: u32,
    /// Samples that it was found to block.
    pub hits: u32,
}

/// How much a cell's knowledge of one light is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing<'a> {
    /// It reaches the cell, past these occluders.
    Lit(&'a LightEvidence),
    /// It does not reach the cell.
    Hidden,
    /// Too few samples to say: a shader asks the scene.
    Doubtful,
}

impl Lie {
    /// A cell that was never sampled.
    pub(crate) fn empty(version: u64) -> Self {
        Self {
            version,
            ..Self::default()
        }
    }

    /// Samples taken in the cell.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The lights that reach the cell, in order of their number.
    #[must_use]
    pub fn lights(&self) -> &[LightEvidence] {
        &self.lights
    }

    /// The lights that could light the cell but were never seen from it, in order of their
    /// number.
    #[must_use]
    pub fn hidden(&self) -> &[HiddenLight] {
        &self.hidden
    }

    /// What is known of a light, if it was ever seen from here.
    #[must_use]
    pub fn light(&self, light: u32) -> Option<&LightEvidence> {
        let place = self
            .lights
            .binary_search_by_key(&light, |entry| entry.light);
        place.ok().map(|index| &self.lights[index])
    }

    /// What shaders make of a light, if `trust` samples must agree on one that gives all of
    /// a pixel's light, and fewer on one that gives less. At 0 they trust everything, as in
    /// the paper: what is not known to be lit is hidden.
    #[must_use]
    pub fn standing(&self, light: u32, trust: u32) -> Standing<'_> {
        if let Some(entry) = self.light(light) {
            return if entry.is_trusted(trust) {
                Standing::Lit(entry)
            } else {
                Standing::Doubtful
            };
        }
        let place = self
            .hidden
            .binary_search_by_key(&light, |entry| entry.light);
        if trust == 0 || place.is_ok_and(|index| self.hidden[index].is_trusted(trust)) {
            Standing::Hidden
        } else {
            Standing::Doubtful
        }
    }

    /// The cell's complexity: the sum of all occluders (LIE §4.1).
    #[must_use]
    pub fn complexity(&self) -> usize {
        self.lights.iter().map(|entry| entry.occluders.len()).sum()
    }

    /// Takes in one sample: the three cases of LIE §4.1, and evidence. Says whether shaders
    /// now see the cell differently.
    pub(crate) fn record(&mut self, outcomes: &[Outcome], trust: u32) -> bool {
        self.samples = self.samples.saturating_add(1);
        let mut changed = false;
        for outcome in outcomes {
            let light = outcome.light;
            let was_doubtful = self.standing(light, trust) == Standing::Doubtful;
            let news = match outcome.blocker {
                None => self.see(outcome),
                Some(triangle) => self.block(outcome, triangle),
            };
            let is_doubtful = self.standing(light, trust) == Standing::Doubtful;
            changed |= was_doubtful != is_doubtful || (news && !is_doubtful);
        }
        changed
    }

    /// An unoccluded sample. Says whether it saw the light for the first time.
    fn see(
        &mut self,
        &Outcome {
            light, importance, ..
        }: &Outcome,
    ) -> bool {
        match self
            .lights
            .binary_search_by_key(&light, |entry| entry.light)
        {
            Ok(index) => {
                let entry = &mut self.lights[index];
                entry.clear = entry.clear.saturating_add(1);
                entry.agreed = entry.agreed.saturating_add(1);
                entry.importance = entry.importance.max(importance);
                false
            }
            // Unoccluded and not in the LIE: the light is added.
            Err(index) => {
                self.hidden.retain(|entry| entry.light != light);
                let entry = LightEvidence {
                    light,
                    clear: 1,
                    blocked: 0,
                    agreed: 0,
                    importance,
                    occluders: vec![],
                };
                self.lights.insert(index, entry);
                true
            }
        }
    }

    /// An occluded sample. Says whether it added an occluder.
    fn block(
        &mut self,
        &Outcome {
            light, importance, ..
        }: &Outcome,
        triangle: u32,
    ) -> bool {
        match self
            .lights
            .binary_search_by_key(&light, |entry| entry.light)
        {
            // In the LIE: partially occluded, and the blocker joins the light's occluders.
            Ok(index) => {
                let entry = &mut self.lights[index];
                entry.importance = entry.importance.max(importance);
                entry.block(triangle)
            }
            // Not in the LIE: it stays as it is, but for the evidence.
            Err(_) => {
                let new = HiddenLight {
                    light,
                    blocked: 0,
                    importance,
                };
                let place = self
                    .hidden
                    .binary_search_by_key(&light, |entry| entry.light);
                let index = place.unwrap_or_else(|index| {
                    self.hidden.insert(index, new);
                    index
                });
                let entry = &mut self.hidden[index];
                entry.blocked = entry.blocked.saturating_add(1);
                entry.importance = entry.importance.max(importance);
                false
            }
        }
    }

    /// What shaders see of the cell.
    #[must_use]
    pub(crate) fn state(&self, trust: u32) -> LieState {
        let lights = self.lights.iter().filter(|entry| entry.is_trusted(trust));
        // Without doubt, every light that is not lit is hidden: no need to name it.
        let hidden = self
            .hidden
            .iter()
            .filter(|entry| trust > 0 && entry.is_trusted(trust));
        LieState {
            lights: lights
                .map(|entry| LitLight {
                    light: entry.light,
                    occluders: entry
                        .occluders
                        .iter()
                        .map(|occluder| occluder.triangle)
                        .collect(),
                })
                .collect(),
            hidden: hidden.map(|entry| entry.light).collect(),
        }
    }

    /// Heap memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.lights[..])
            + size_of_val(&self.hidden[..])
            + self.complexity() * size_of::<Occluder>()
    }
}

/// Samples that must agree on a light of this importance: in proportion to it, so that what
/// may be wrong of any light is worth about the same; but at least a sixteenth.
fn required(trust: u32, importance: f32) -> f32 {
    trust as f32 * importance.clamp(1.0 / 16.0, 1.0)
}

impl HiddenLight {
    fn is_trusted(&self, trust: u32) -> bool {
        self.blocked as f32 >= required(trust, self.importance)
    }
}

impl LightEvidence {
    fn is_trusted(&self, trust: u32) -> bool {
        self.agreed as f32 >= required(trust, self.importance)
    }

    /// Counts a blocked sample; says whether the blocker is new.
    fn block(&mut self, triangle: u32) -> bool {
        self.blocked = self.blocked.saturating_add(1);
        if let Some(known) = self
            .occluders
            .iter_mut()
            .find(|occluder| occluder.triangle == triangle)
        {
            known.hits = known.hits.saturating_add(1);
            self.agreed = self.agreed.saturating_add(1);
            return false;
        }
        self.occluders.push(Occluder { triangle, hits: 1 });
        self.agreed = 0;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEEN: Option<u32> = None;

    fn record(lie: &mut Lie, outcomes: &[(u32, Option<u32>)], trust: u32) -> bool {
        let outcomes: Vec<_> = outcomes
            .iter()
            .map(|&(light, blocker)| Outcome {
                light,
                blocker,
                importance: 1.0,
            })
            .collect();
        lie.record(&outcomes, trust)
    }

    #[test]
    fn the_three_cases_of_the_paper() {
        let mut lie = Lie::default();
        assert!(!record(&mut lie, &[(4, Some(1))], 0));
        assert!(
            lie.lights().is_empty(),
            "a light that nothing saw is not added"
        );
        assert!(record(&mut lie, &[(4, SEEN), (2, SEEN)], 0));
        assert!(record(&mut lie, &[(4, Some(1))], 0));
        assert!(
            !record(&mut lie, &[(4, Some(1)), (2, SEEN)], 0),
            "nothing new"
        );
        assert_eq!(
            lie.lights()
                .iter()
                .map(|entry| entry.light)
                .collect::<Vec<_>>(),
            [2, 4]
        );
        assert_eq!((lie.samples(), lie.complexity()), (4, 1));
        let entry = lie.light(4).unwrap();
        assert_eq!((entry.clear, entry.blocked), (1, 2));
        assert_eq!(
            entry.occluders,
            [Occluder {
                triangle: 1,
                hits: 2
            }]
        );
    }

    #[test]
    fn trust_takes_samples_that_agree_and_ends_with_one_that_does_not() {
        let mut lie = Lie::default();
        let standing = |lie: &Lie, light| match lie.standing(light, 2) {
            Standing::Lit(_) => "lit",
            Standing::Hidden => "hidden",
            Standing::Doubtful => "doubtful",
        };
        assert!(!record(&mut lie, &[(0, SEEN), (1, Some(7))], 2));
        assert!(
            record(&mut lie, &[(0, SEEN), (1, Some(7))], 2),
            "light 1 is now trusted to be hidden"
        );
        assert_eq!(
            (standing(&lie, 0), standing(&lie, 1), standing(&lie, 9)),
            ("doubtful", "hidden", "doubtful")
        );
        assert_eq!(
            lie.state(2),
            LieState {
                lights: vec![],
                hidden: vec![1]
            }
        );
        assert!(record(&mut lie, &[(0, SEEN), (1, SEEN)], 2));
        assert_eq!((standing(&lie, 0), standing(&lie, 1)), ("lit", "doubtful"));
        assert!(
            record(&mut lie, &[(0, Some(3))], 2),
            "a new occluder ends the trust"
        );
        assert_eq!(standing(&lie, 0), "doubtful");
        assert!(lie.hidden().is_empty());
    }

    #[test]
    fn a_light_that_gives_little_needs_fewer_samples() {
        let mut lie = Lie::default();
        let outcome = |light, importance| Outcome {
            light,
            blocker: SEEN,
            importance,
        };
        for _ in 0..17 {
            lie.record(&[outcome(0, 1.0), outcome(1, 0.25), outcome(2, 0.0)], 64);
        }
        let trusted = |light| lie.standing(light, 64) != Standing::Doubtful;
        assert!(!trusted(0) && trusted(1) && trusted(2));
    }
}
