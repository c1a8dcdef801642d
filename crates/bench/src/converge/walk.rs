use std::time::Instant;

use lie_farm::{Builder, LieReplica, View};
use lie_render::{Film, compare};
use lie_scene::{Camera, Walkthrough};

use super::{Bench, Mode, course::render_now, deadline::is_over};
use crate::{
    BenchError, Contender, Stage,
    race::{Render, timed},
};

/// Seconds of the walkthrough from one frame to the next: four frames a second.
const STEP_S: f32 = 0.25;

/// Passes that the first view gets before the walk begins.
const START_PASSES: u64 = 4;

/// One of so many pixels is sampled between two frames.
const BUDGET_SHARE: u64 = 4;

/// The walk's views, and the standard's picture of those that were asked for.
pub(super) struct WalkReferences<'a> {
    walkthrough: &'a Walkthrough,
    films: Vec<Film>,
}

impl<'a> WalkReferences<'a> {
    pub(super) fn new(walkthrough: &'a Walkthrough) -> Self {
        Self {
            walkthrough,
            films: vec![],
        }
    }

    /// From the middle on, where one walks: a walkthrough begins and ends at rest.
    fn camera(&self, frame: u32) -> Camera {
        let middle = 0.5 * self.walkthrough.duration_s();
        self.walkthrough.camera_at(middle + frame as f32 * STEP_S)
    }

    /// Frames are asked for in order, from the first.
    fn film(&mut self, frame: u32, render: impl FnOnce() -> Film) -> &Film {
        let index = frame as usize;
        if index >= self.films.len() {
            self.films.push(render());
        }
        &self.films[index.min(self.films.len() - 1)]
    }
}

/// The largest relative RMSE of a walk's frames against the standard's. LIEs start from
/// nothing at the walk's first view, which gets some passes and is not counted; each
/// following view gets a part of a pass before its frame.
pub(super) fn worst_error(
    bench: &Bench<'_>,
    mode: Mode,
    references: &mut WalkReferences<'_>,
    end: Option<Instant>,
) -> Result<Option<f64>, BenchError> {
    if bench.config.walk_frames == 0 {
        return Ok(None);
    }
    let stage = bench.stage;
    let mut builder = Builder::new(stage.world().clone(), mode.settings(bench.config.construct))?;
    let view = |camera: Camera| View {
        camera,
        size: stage.settings().size,
    };
    learn(
        bench,
        mode,
        &mut builder,
        &view(references.camera(0)),
        START_PASSES * stage.pixels(),
        end,
    );
    let mut worst: Option<f64> = None;
    for frame in 1..=bench.config.walk_frames {
        if is_over(end) {
            break;
        }
        let seen = stage.seen_from(references.camera(frame));
        learn(
            bench,
            mode,
            &mut builder,
            &seen.view(),
            stage.pixels() / BUDGET_SHARE,
            None,
        );
        let lies = LieReplica::of(stage.world().clone(), builder.tree()).publish();
        let (film, _, _) = render_now(bench, mode, &lies, &seen);
        let reference = references.film(frame - 1, || render_standard(bench, mode, &seen));
        let error = compare(&film, reference, stage.exposure_stops())?.relative_rmse;
        worst = Some(worst.unwrap_or(0.0).max(error));
    }
    Ok(worst)
}

/// Samples a view for so many pixels, in whole batches, or until the time is over.
fn learn(
    bench: &Bench<'_>,
    mode: Mode,
    builder: &mut Builder,
    view: &View,
    pixels: u64,
    end: Option<Instant>,
) {
    // It counts from its own beginning; without views it does nothing but say so.
    let before = builder.batch(&[]).taken;
    let mut taken = 0;
    while taken < pixels && !is_over(end) {
        taken = builder.batch(std::slice::from_ref(view)).taken - before;
        bench.tell(mode, "walk", (taken as f32 / pixels as f32).min(1.0));
    }
}

fn render_standard(bench: &Bench<'_>, mode: Mode, stage: &Stage) -> Film {
    let render: Render<'_> = Box::new(|tell| Contender::Standard.render(stage, None, tell));
    let tell = |share: f32| bench.tell(mode, "reference of the walk", share);
    timed(bench.pool, &render, &tell).0
}
