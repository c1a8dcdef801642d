use std::time::Instant;

use lie_farm::{BatchReport, Builder, LieReplica, PublishedLies};
use lie_render::{Film, RenderStats, compare};

use super::{Bench, ConvergeRow, ConvergeSummary, Mode, audit::audit, deadline::is_over};
use crate::{
    BenchError, Contender, Stage,
    race::{Runs, milliseconds, timed},
};

/// One mode's way from nothing to convergence.
pub(super) struct Course {
    pub(super) rows: Vec<ConvergeRow>,
    /// Without the walk.
    pub(super) summary: ConvergeSummary,
}

/// Passes after which a frame is rendered: a quarter, a half, one, two, four and so on.
const FIRST_MARK: f64 = 0.25;

/// Constructs batch by batch until the view has converged, or the passes or the time are
/// over, and renders a frame at each mark.
pub(super) fn follow(
    bench: &Bench<'_>,
    mode: Mode,
    first: &Runs,
    end: Option<Instant>,
) -> Result<Course, BenchError> {
    let Bench { stage, config, .. } = bench;
    let mut builder = Builder::new(stage.world().clone(), mode.settings(config.construct))?;
    let views = [stage.view()];
    let most = config.max_samples as f64 / stage.pixels() as f64;
    let mut rows = vec![first_row(bench, mode, first)?];
    let mut construct_ms = 0.0;
    let mut converged_ms = None;
    let mut mark = FIRST_MARK;
    while !is_over(end) {
        let clock = Instant::now();
        let report = builder.batch(&views);
        construct_ms += milliseconds(clock.elapsed());
        let passes = report.taken as f64 / stage.pixels() as f64;
        bench.tell(mode, "construct", (passes / most) as f32);
        let is_last = report.converged || passes >= most || is_over(end);
        if is_last || passes >= mark {
            while mark <= passes {
                mark *= 2.0;
            }
            rows.push(mark_row(bench, mode, &builder, &report, construct_ms)?);
        }
        converged_ms = report.converged.then_some(construct_ms);
        if is_last {
            break;
        }
    }
    let last = &rows[rows.len() - 1];
    let summary = ConvergeSummary {
        scene: stage.name().to_owned(),
        path: stage.path().to_owned(),
        camera: stage.camera().name.clone(),
        mode,
        threads: bench.pool.current_num_threads(),
        standard_frame_ms: bench.standard.frame_ms(),
        converged_ms,
        first_frame_ms: first.frame_ms(),
        first_frame_relative_rmse: rows[0].relative_rmse,
        last_frame_ms: last.frame_ms,
        last_frame_relative_rmse: last.relative_rmse,
        last_frame_trusted_fraction: last.trusted_fraction,
        worst_walk_relative_rmse: None,
        lie_bytes: builder.tree().stats().bytes,
    };
    Ok(Course { rows, summary })
}

/// A frame by LIEs as they are.
pub(super) fn render_now(
    bench: &Bench<'_>,
    mode: Mode,
    lies: &PublishedLies,
    stage: &Stage,
) -> (Film, RenderStats, f64) {
    let render: crate::race::Render<'_> =
        Box::new(|tell| Contender::Lie.render(stage, Some(lies), tell));
    timed(bench.pool, &render, &|share| {
        bench.tell(mode, "frame", share);
    })
}

/// Before anything is known.
fn first_row(bench: &Bench<'_>, mode: Mode, first: &Runs) -> Result<ConvergeRow, BenchError> {
    let stage = bench.stage;
    let figures = compare(&first.film, &bench.standard.film, stage.exposure_stops())?;
    Ok(ConvergeRow {
        scene: stage.name().to_owned(),
        mode,
        time_ms: 0.0,
        samples: 0,
        passes: 0.0,
        relative_rmse: figures.relative_rmse,
        flip_mean: figures.flip_mean,
        trusted_fraction: first.stats.trusted_fraction(),
        frame_ms: first.frame_ms().median,
        audit: None,
    })
}

fn mark_row(
    bench: &Bench<'_>,
    mode: Mode,
    builder: &Builder,
    report: &BatchReport,
    time_ms: f64,
) -> Result<ConvergeRow, BenchError> {
    let stage = bench.stage;
    let lies = LieReplica::of(stage.world().clone(), builder.tree()).publish();
    let (film, stats, frame_ms) = render_now(bench, mode, &lies, stage);
    let audited = audit(bench, stage, &lies, report.taken);
    let figures = compare(&film, &bench.standard.film, stage.exposure_stops())?;
    Ok(ConvergeRow {
        scene: stage.name().to_owned(),
        mode,
        time_ms,
        samples: report.samples,
        passes: report.taken as f64 / stage.pixels() as f64,
        relative_rmse: figures.relative_rmse,
        flip_mean: figures.flip_mean,
        trusted_fraction: stats.trusted_fraction(),
        frame_ms,
        audit: Some(audited),
    })
}
