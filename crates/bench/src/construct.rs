use std::{sync::Arc, time::Instant};

use lie_farm::{BatchReport, Builder, ConstructSettings, LieReplica, PublishedLies};

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
pub struct Lineup(Vec<(Contender, Option<Arc<Constructed>>)>);

impl Lineup {
    /// Constructs what these contenders need for a view, each from the usual settings.
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
        let mut lineup: Vec<(Contender, Option<Arc<Constructed>>)> = vec![];
        for &contender in contenders {
            let lies = match contender.construction(usual) {
                None => None,
                Some(settings) => {
                    let known = lineup.iter().filter_map(|(_, lies)| lies.as_ref());
                    let equal = known.into_iter().find(|lies| lies.settings == settings);
                    Some(match equal {
                        Some(lies) => lies.clone(),
                        None => Arc::new(construct(stage, settings, effort, progress)?),
                    })
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
            .map(|(contender, lies)| (*contender, lies.as_deref()))
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
    settings: ConstructSettings,
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

fn construct(
    stage: &Stage,
    settings: ConstructSettings,
    effort: Effort,
    progress: &Progress<'_>,
) -> Result<Constructed, BenchError> {
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
    let construct_ms = milliseconds(clock.elapsed());
    let lies = LieReplica::of(stage.world().clone(), builder.tree()).publish();
    Ok(Constructed {
        settings,
        shader_bytes: lies.bytes(),
        tree_bytes: builder.tree().stats().bytes,
        lies,
        converged: report.converged,
        construct_ms,
    })
}
