use std::time::Instant;

use lie_farm::{BatchReport, Builder, ConstructSettings, LieReplica, PublishedLies};

use crate::{BenchError, Progress, Stage, race::milliseconds};

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

/// LIEs of a view, and what they took.
pub struct Constructed {
    /// As shaders have them.
    pub lies: PublishedLies,
    /// What the last batch said.
    pub report: BatchReport,
    /// Time of construction.
    pub construct_ms: f64,
    /// Memory of the constructor's tree, evidence included.
    pub tree_bytes: u64,
    /// Memory of a shader's cells.
    pub shader_bytes: u64,
}

/// Constructs LIEs for a view.
///
/// # Errors
/// If threads cannot be started.
pub fn construct(
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
        shader_bytes: lies.bytes(),
        tree_bytes: builder.tree().stats().bytes,
        lies,
        report,
        construct_ms,
    })
}
