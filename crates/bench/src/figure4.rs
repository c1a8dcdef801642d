//! The paper's Figure 4: what each pixel costs, with and without masking.

mod show;

use lie_render::{AovLies, Aovs, CellFacts, CostModel, Film, RenderStats, Work, compare};

pub use self::show::{json, panel, section, table};
use crate::{BenchError, Contender, Lineup, Progress, Stage, construct::Constructed, race::pool};

/// Whose pixels' costs are shown.
pub const CONTENDERS: &[Contender] = &[Contender::Standard, Contender::Lie, Contender::LieMasked];

/// What a view costs one contender.
#[derive(Clone, Debug, PartialEq)]
pub struct CostRow {
    /// The scene's name.
    pub scene: String,
    /// What it was loaded from.
    pub path: String,
    /// The camera's name.
    pub camera: String,
    /// Who rendered.
    pub contender: Contender,
    /// Mean over the pixels, in microseconds of one thread, by [`CostModel`].
    pub cost_us: f64,
    /// The same as measured, once, on all threads: stage times by the number of pixels.
    pub measured_us: f64,
    /// What was counted, over all pixels.
    pub work: Work,
    /// What the renderer counted and timed.
    pub stats: RenderStats,
    /// Share of the pixels that cost less than without masking; `None` for others.
    pub cheaper_pixels: Option<f64>,
    /// Share of the cost without masking that masking saves; `None` for others.
    pub saved: Option<f64>,
    /// Relative RMSE against the standard's picture.
    pub relative_rmse: f64,
    /// Mean FLIP against the standard's picture.
    pub flip_mean: f64,
}

/// What a view costs.
pub struct SceneCosts {
    /// One for each of [`CONTENDERS`] in the line-up.
    pub rows: Vec<CostRow>,
    /// The picture, without masking.
    pub picture: Film,
    /// For each row, each pixel's cost in microseconds, row by row.
    pub costs_us: Vec<Vec<f32>>,
}

/// Counts the cost of each pixel of a view, and renders the pictures that it is the cost of.
/// Of the line-up only [`CONTENDERS`] take part; pictures are compared with the standard's,
/// which must be among them.
///
/// # Errors
/// If threads cannot be started.
pub fn measure(
    stage: &Stage,
    lineup: &Lineup,
    threads: usize,
    progress: &Progress<'_>,
) -> Result<SceneCosts, BenchError> {
    let pool = pool(threads)?;
    let mut films: Vec<(Contender, Film)> = vec![];
    let mut found = SceneCosts {
        rows: vec![],
        picture: Film::new(stage.settings().size),
        costs_us: vec![],
    };
    for (contender, lies) in lineup.iter() {
        if !CONTENDERS.contains(&contender) {
            continue;
        }
        let what = format!("{}: cost of {}", stage.name(), contender.name());
        let (film, stats) = pool.install(|| {
            let lookup = lies.map(|lies| &lies.lies);
            contender.render(stage, lookup, &mut |share| progress(&what, 0.5 * share))
        });
        let tell = |share: f32| progress(&what, 0.5 + 0.5 * share);
        let aovs = pool.install(|| count(stage, lies, &tell));
        let model = CostModel::default();
        let costs = aovs.pixels().iter().map(|pixel| &pixel.work);
        let costs = costs.map(|work| 1.0e-3 * model.cost_ns(work) as f32);
        found.costs_us.push(costs.collect());
        found.rows.push(row(stage, contender, &aovs, stats));
        films.push((contender, film));
    }
    finish(stage, &mut found, &films)?;
    Ok(found)
}

fn count(stage: &Stage, lies: Option<&Constructed>, tell: &(dyn Fn(f32) + Sync)) -> Aovs {
    let lies = lies.map(|lies| AovLies {
        lookup: &lies.lies,
        facts: &|_| CellFacts::default(),
        odds: None,
    });
    let (world, camera) = (stage.world(), stage.camera());
    Aovs::render(world, lies, camera, stage.settings(), &mut |share| {
        tell(share);
    })
}

/// What a contender's own frame and counts say.
fn row(stage: &Stage, contender: Contender, aovs: &Aovs, stats: RenderStats) -> CostRow {
    let work = aovs.total();
    let per_pixel_us = 1.0e-3 / stage.pixels() as f64;
    CostRow {
        scene: stage.name().to_owned(),
        path: stage.path().to_owned(),
        camera: stage.camera().name.clone(),
        contender,
        cost_us: per_pixel_us * CostModel::default().cost_ns(&work),
        measured_us: per_pixel_us * CostModel::measured_ns(&stats) as f64,
        work,
        stats,
        cheaper_pixels: None,
        saved: None,
        relative_rmse: 0.0,
        flip_mean: 0.0,
    }
}

/// Fills in what follows from comparing contenders.
fn finish(
    stage: &Stage,
    found: &mut SceneCosts,
    films: &[(Contender, Film)],
) -> Result<(), BenchError> {
    let place = |wanted| films.iter().position(|(contender, _)| *contender == wanted);
    if let Some(standard) = place(Contender::Standard) {
        for (row, (_, film)) in found.rows.iter_mut().zip(films) {
            let figures = compare(film, &films[standard].1, stage.exposure_stops())?;
            row.relative_rmse = figures.relative_rmse;
            row.flip_mean = figures.flip_mean;
        }
    }
    if let (Some(plain), Some(masked)) = (place(Contender::Lie), place(Contender::LieMasked)) {
        let pairs = found.costs_us[plain].iter().zip(&found.costs_us[masked]);
        let cheaper = pairs.filter(|(plain, masked)| masked < plain).count();
        let plain_us = found.rows[plain].cost_us;
        let row = &mut found.rows[masked];
        row.cheaper_pixels = Some(cheaper as f64 / stage.pixels() as f64);
        row.saved = Some(1.0 - row.cost_us / plain_us);
    }
    if let Some(plain) = place(Contender::Lie)
        .or(Some(0))
        .filter(|_| !films.is_empty())
    {
        found.picture = films[plain].1.clone();
    }
    Ok(())
}
