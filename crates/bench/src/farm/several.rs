use lie_render::compare;
use serde_json::{Value, json};

use super::FarmFrame;
use crate::{
    BenchError, Progress, Spread, Stage, Table,
    table::{ms, percent, times},
};

/// Some shaders beside one, each on as many threads.
#[derive(Clone, Debug, PartialEq)]
pub struct SeveralRow {
    /// The scene's name.
    pub scene: String,
    /// How many.
    pub shaders: usize,
    /// Threads of each.
    pub threads: usize,
    /// Time of a frame by one.
    pub one_ms: Spread,
    /// By all.
    pub several_ms: Spread,
    /// One's time divided by that of all, turn by turn.
    pub speedup: Spread,
    /// Share of the pixels in which the two pictures differ.
    pub differing: f64,
}

/// Renders a stage's frame on a farm of one shader and on one of several, in turn.
///
/// # Errors
/// If a farm has no frame.
pub fn measure_several(
    stage: &Stage,
    (shaders, threads): (usize, usize),
    repeat: u32,
    one: &mut FarmFrame<'_>,
    several: &mut FarmFrame<'_>,
    progress: &Progress<'_>,
) -> Result<SeveralRow, BenchError> {
    // The first two of each: until it is known what tiles cost.
    let mut differing = 0.0;
    for _ in 0..2 {
        let figures = compare(&several()?.film, &one()?.film, stage.exposure_stops())?;
        differing = figures.differing;
    }
    let repeat = repeat.max(1);
    let (mut one_ms, mut several_ms) = (vec![], vec![]);
    for repetition in 0..repeat {
        let what = format!("{}, {shaders} shaders and one", stage.name());
        progress(&what, repetition as f32 / repeat as f32);
        one_ms.push(one()?.stats.frame_ms);
        several_ms.push(several()?.stats.frame_ms);
    }
    let pairs = one_ms.iter().zip(&several_ms);
    let ratios: Vec<f64> = pairs.map(|(one, several)| one / several).collect();
    let spread = |values: &[f64]| Spread::of(values).unwrap_or(Spread::NONE);
    Ok(SeveralRow {
        scene: stage.name().to_owned(),
        shaders,
        threads,
        one_ms: spread(&one_ms),
        several_ms: spread(&several_ms),
        speedup: spread(&ratios),
        differing,
    })
}

/// The table.
#[must_use]
pub fn several_table(rows: &[SeveralRow]) -> Table {
    let numbers = [
        "shaders", "threads", "one ms", "all ms", "speed-up", "min", "max", "differ",
    ];
    let mut table = Table::new(&["scene"], &numbers);
    for row in rows {
        table.push([
            row.scene.clone(),
            row.shaders.to_string(),
            row.threads.to_string(),
            ms(row.one_ms.median),
            ms(row.several_ms.median),
            times(row.speedup.median),
            times(row.speedup.min),
            times(row.speedup.max),
            percent(row.differing),
        ]);
    }
    table
}

/// The rows as JSON.
#[must_use]
pub fn several_json(rows: &[SeveralRow]) -> Value {
    let row = |row: &SeveralRow| {
        json!({
            "scene": row.scene,
            "shaders": row.shaders,
            "threads": row.threads,
            "one_ms": row.one_ms.median,
            "several_ms": row.several_ms.median,
            "speedup": row.speedup.median,
            "speedup_min": row.speedup.min,
            "speedup_max": row.speedup.max,
            "differing": row.differing,
        })
    };
    rows.iter().map(row).collect()
}
