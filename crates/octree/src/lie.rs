use crate::{LieState, LitLight, Outcome};

/// What the constructor knows of one cell.
///
/// Invariants: `lights` are in order of their number and each was seen by some sample
/// (`clear ≥ 1`); every occluder blocked some sample's ray to its light.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lie {
    samples: u32,
    lights: Vec<LightEvidence>,
    /// Tree version at which what shaders see of it last changed.
    pub(crate) version: u64,
}

/// What the constructor knows of one light in one cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LightEvidence {
    /// Number of the light in the scene.
    pub light: u32,
    /// Samples that saw it.
    pub clear: u32,
    /// Samples that did not, counted since the first that did.
    pub blocked: u32,
    /// The triangles that came in between.
    pub occluders: Vec<Occluder>,
}

/// A triangle that blocks a light somewhere in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occluder {
    /// Index in the scene.
    pub triangle: u32,
    /// Samples that it was found to block.
    pub hits: u32,
}

/// What recording one observation changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Change {
    pub(crate) new_lights: usize,
    pub(crate) new_occluders: usize,
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

    /// What is known of a light, if it was ever seen from here.
    #[must_use]
    pub fn light(&self, light: u32) -> Option<&LightEvidence> {
        let place = self
            .lights
            .binary_search_by_key(&light, |entry| entry.light);
        place.ok().map(|index| &self.lights[index])
    }

    /// The cell's complexity: the sum of all occluders (LIE §4.1).
    #[must_use]
    pub fn complexity(&self) -> usize {
        self.lights.iter().map(|entry| entry.occluders.len()).sum()
    }

    /// Takes in one sample: the three cases of LIE §4.1.
    pub(crate) fn record(&mut self, outcomes: &[Outcome]) -> Change {
        self.samples = self.samples.saturating_add(1);
        let mut change = Change::default();
        for outcome in outcomes {
            let place = self
                .lights
                .binary_search_by_key(&outcome.light, |entry| entry.light);
            match (outcome.blocker, place) {
                // Unoccluded, seen before.
                (None, Ok(index)) => {
                    let entry = &mut self.lights[index];
                    entry.clear = entry.clear.saturating_add(1);
                }
                // Unoccluded, seen for the first time: the light is added.
                (None, Err(index)) => {
                    let entry = LightEvidence {
                        light: outcome.light,
                        clear: 1,
                        blocked: 0,
                        occluders: vec![],
                    };
                    self.lights.insert(index, entry);
                    change.new_lights += 1;
                }
                // Occluded and never seen: nothing.
                (Some(_), Err(_)) => {}
                // Partially occluded: the blocker joins the light's occluders.
                (Some(triangle), Ok(index)) => {
                    change.new_occluders += usize::from(self.lights[index].block(triangle));
                }
            }
        }
        change
    }

    /// What shaders see of the cell.
    #[must_use]
    pub(crate) fn state(&self, trust: u32) -> LieState {
        LieState {
            trusted: self.samples >= trust,
            lights: self
                .lights
                .iter()
                .map(|entry| LitLight {
                    light: entry.light,
                    occluders: entry
                        .occluders
                        .iter()
                        .map(|occluder| occluder.triangle)
                        .collect(),
                })
                .collect(),
        }
    }
}

impl LightEvidence {
    /// Counts a blocked sample; says whether the blocker is new.
    fn block(&mut self, triangle: u32) -> bool {
        self.blocked = self.blocked.saturating_add(1);
        if let Some(known) = self
            .occluders
            .iter_mut()
            .find(|occluder| occluder.triangle == triangle)
        {
            known.hits = known.hits.saturating_add(1);
            return false;
        }
        self.occluders.push(Occluder { triangle, hits: 1 });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_cases_of_the_paper() {
        let seen = |light| Outcome {
            light,
            blocker: None,
        };
        let blocked = |light, triangle| Outcome {
            light,
            blocker: Some(triangle),
        };
        let mut lie = Lie::default();
        assert_eq!(lie.record(&[blocked(4, 1)]), Change::default());
        assert!(
            lie.lights().is_empty(),
            "a light that nothing saw is not added"
        );
        assert_eq!(lie.record(&[seen(4), seen(2)]).new_lights, 2);
        assert_eq!(lie.record(&[blocked(4, 1)]).new_occluders, 1);
        assert_eq!(lie.record(&[blocked(4, 1), seen(2)]), Change::default());
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
}
