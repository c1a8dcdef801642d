use std::time::Instant;

use lie_farm::{BatchReport, Builder, ConstructSettings, LieReplica, PublishedLies};
use lie_octree::LieTree;

use crate::{BenchError, Contender, Progress, Stage, race::milliseconds};

/// How much construction a view gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Until it has converged.
    UntilConverged {
        /// Passes over the picture after which that is given up.
        max_passes: u64,
    },
    /// So many pixels, in whole batches.
    Samples(u64),
}

/// Contenders, and the LIEs that they ask.
pub struct Lineup(Vec<(Contender, Option<Constructed>)>);

impl Lineup {
    /// Constructs what these contenders need for a view, each from the usual settings.
    /// Masking is drawn from what construction learns, which it does not change: contenders
    /// that differ in nothing else share one construction.
    ///
    /// # Errors
    /// If threads cannot be started.
    pub fn construct(
        stage: &Stage,
        contenders: &[Contender],
        usual: ConstructSettings,
        effort: Effort,
        progress: &Progress<'_>,
    ) -> Result<Self, BenchError> {
        let mut grown: Vec<Grown> = vec![];
        let mut lineup = vec![];
        for &contender in contenders {
            let lies = match contender.construction(usual) {
                None => None,
                Some(settings) => {
                    let plain = unmasked(settings);
                    let known = grown.iter().position(|grown| grown.settings == plain);
                    let index = match known {
                        Some(index) => index,
                        None => {
                            grown.push(grow(stage, plain, effort, progress)?);
                            grown.len() - 1
                        }
                    };
                    Some(grown[index].masked(stage, settings.lie.masking))
                }
            };
            lineup.push((contender, lies));
        }
        Ok(Self(lineup))
    }

    /// Each contender, with its LIEs if it asks any.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (Contender, Option<&Constructed>)> {
        self.0
            .iter()
            .map(|(contender, lies)| (*contender, lies.as_ref()))
    }

    /// The LIEs of a contender, if it is there and asks any.
    #[must_use]
    pub fn lies(&self, contender: Contender) -> Option<&PublishedLies> {
        let mut all = self.iter();
        let (_, lies) = all.find(|&(other, _)| other == contender)?;
        lies.map(|lies| &lies.lies)
    }

    /// Whether the view converged for each of them.
    #[must_use]
    pub fn has_converged(&self) -> bool {
        self.iter()
            .all(|(_, lies)| lies.is_none_or(|lies| lies.converged))
    }
}

/// LIEs of a view, and what they took.
pub(crate) struct Constructed {
    /// As shaders have them.
    pub(crate) lies: PublishedLies,
    /// Whether the view converged.
    pub(crate) converged: bool,
    /// Time of construction.
    pub(crate) construct_ms: f64,
    /// Memory of the constructor's tree, evidence included.
    pub(crate) tree_bytes: u64,
    /// Memory of a shader's cells.
    pub(crate) shader_bytes: u64,
}

/// What construction learnt.
struct Grown {
    /// Without masking.
    settings: ConstructSettings,
    tree: LieTree,
    converged: bool,
    construct_ms: f64,
}

/// What to construct with, so that these settings' LIEs can be drawn from it.
fn unmasked(mut settings: ConstructSettings) -> ConstructSettings {
    // What is proven is not sampled, and masking goes by samples; the paper's mode proves nothing.
    settings.proofs &= settings.lie.masking == 0.0 && settings.lie.trust > 0;
    settings.lie.masking = 0.0;
    settings
}

fn grow(
    stage: &Stage,
    settings: ConstructSettings,
    effort: Effort,
    progress: &Progress<'_>,
) -> Result<Grown, BenchError> {
    let clock = Instant::now();
    let mut builder = Builder::new(stage.world().clone(), settings)?;
    let views = [stage.view()];
    let samples = match effort {
        Effort::UntilConverged { max_passes } => max_passes * stage.pixels(),
        Effort::Samples(samples) => samples,
    };
    let tell = |report: &BatchReport| {
        let share = report.taken as f64 / samples.max(1) as f64;
        progress(
            &format!("{}: construct", stage.name()),
            (share as f32).min(1.0),
        );
    };
    let report = match effort {
        Effort::UntilConverged { .. } => builder.converge(&views, samples, tell),
        Effort::Samples(_) => builder.sample(&views, samples, tell),
    };
    Ok(Grown {
        settings,
        tree: builder.tree().clone(),
        converged: report.converged,
        construct_ms: milliseconds(clock.elapsed()),
    })
}

impl Grown {
    /// As shaders have it that leave out so large a share of the light.
    fn masked(&self, stage: &Stage, masking: f32) -> Constructed {
        let tree = self.tree.with_masking(masking);
        let lies = LieReplica::of(stage.world().clone(), &tree).publish();
        Constructed {
            shader_bytes: lies.bytes(),
            tree_bytes: tree.stats().bytes,
            lies,
            converged: self.converged,
            construct_ms: self.construct_ms,
        }
    }
}
