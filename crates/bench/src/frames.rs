use lie_render::{AccelKind, Film, compare};

use crate::{
    BenchError, Constructed, Contender, Progress, Spread, Stage, Stages,
    race::{Entrant, Runs, pool, race, timed},
};

/// What is measured of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct FramesConfig {
    /// Numbers of threads, one measurement for each.
    pub threads: Vec<usize>,
    /// Frames of each contender.
    pub repeat: u32,
    /// Who renders, in turn.
    pub contenders: Vec<Contender>,
}

/// One contender on so many threads.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRow {
    /// The scene's name.
    pub scene: String,
    /// What it was loaded from.
    pub path: String,
    /// The camera's name.
    pub camera: String,
    /// What found hits.
    pub accel: AccelKind,
    /// Who rendered.
    pub contender: Contender,
    /// Threads.
    pub threads: usize,
    /// Times of the frame alone.
    pub frame_ms: Spread,
    /// The standard's time divided by this one's, repetition by repetition; `None` if the
    /// standard did not take part.
    pub speedup: Option<Spread>,
    /// Where the time went.
    pub stages: Stages,
    /// Relative RMSE against the standard's picture.
    pub relative_rmse: f64,
    /// Mean FLIP against the standard's picture.
    pub flip_mean: f64,
    /// Share of the light evaluations that LIEs answered.
    pub trusted_fraction: f64,
    /// Rays to lights through the whole scene.
    pub shadow_rays: u64,
    /// Memory of the LIEs with their evidence; 0 without LIEs.
    pub lie_bytes: u64,
    /// Memory of the LIEs as a shader has them; 0 without LIEs.
    pub shader_bytes: u64,
    /// Time that construction took; 0 without LIEs.
    pub construct_ms: f64,
    /// Whether construction ended because the view had converged.
    pub converged: bool,
}

/// All that was measured of a view.
pub struct SceneFrames {
    /// For each number of threads, each contender.
    pub rows: Vec<FrameRow>,
    /// The last contender's picture.
    pub picture: Film,
}

/// Renders a view by some contenders, in turn, and compares each with the standard.
///
/// # Errors
/// If threads cannot be started.
pub fn measure_frames(
    stage: &Stage,
    constructed: &Constructed,
    config: &FramesConfig,
    progress: &Progress<'_>,
) -> Result<SceneFrames, BenchError> {
    let most = config.threads.iter().copied().max().unwrap_or(0);
    let mut picture = Film::new(stage.settings().size);
    let mut reference: Option<Film> = None;
    let mut rows = vec![];
    for &threads in &config.threads {
        let pool = pool(threads)?;
        warm_up(stage, constructed, config, &pool);
        let entrants = entrants(stage, constructed, &config.contenders);
        let runs = race(&pool, config.repeat, &entrants, progress);
        let mut finishers = config.contenders.iter().zip(&runs);
        let standard = finishers.find(|(contender, _)| **contender == Contender::Standard);
        let standard = standard.map(|(_, runs)| runs);
        // Pictures do not depend on the number of threads: one reference is enough.
        if reference.is_none() {
            reference = Some(match standard {
                Some(standard) => standard.film.clone(),
                None => render_reference(stage, constructed, most, progress)?,
            });
        }
        for (&contender, runs) in config.contenders.iter().zip(&runs) {
            let reference = reference.as_ref().unwrap_or(&runs.film);
            let speedup = standard.and_then(|standard| runs.speedup_over(standard));
            let mut row = row(stage, contender, pool.current_num_threads(), runs);
            row.speedup = speedup;
            let figures = compare(&runs.film, reference, stage.exposure_stops())?;
            (row.relative_rmse, row.flip_mean) = (figures.relative_rmse, figures.flip_mean);
            if contender.uses_lies() {
                row.lie_bytes = constructed.tree_bytes;
                row.shader_bytes = constructed.shader_bytes;
                row.construct_ms = constructed.construct_ms;
                row.converged = constructed.report.converged;
            }
            rows.push(row);
        }
        picture = runs.into_iter().next_back().map_or(picture, |run| run.film);
    }
    Ok(SceneFrames { rows, picture })
}

fn entrants<'a>(
    stage: &'a Stage,
    constructed: &'a Constructed,
    contenders: &[Contender],
) -> Vec<Entrant<'a>> {
    let entrant = |&contender: &Contender| Entrant {
        name: format!("{}: {}", stage.name(), contender.name()),
        render: Box::new(move |tell| contender.render(stage, &constructed.lies, tell)),
    };
    contenders.iter().map(entrant).collect()
}

/// The first frame of a run is slower than the others; a small one will do for that.
fn warm_up(
    stage: &Stage,
    constructed: &Constructed,
    config: &FramesConfig,
    pool: &rayon::ThreadPool,
) {
    let small = stage.thumbnail();
    race(
        pool,
        1,
        &entrants(&small, constructed, &config.contenders),
        &|_, _| {},
    );
}

fn render_reference(
    stage: &Stage,
    constructed: &Constructed,
    threads: usize,
    progress: &Progress<'_>,
) -> Result<Film, BenchError> {
    let entrants = entrants(stage, constructed, &[Contender::Standard]);
    let what = format!("{}: reference", stage.name());
    let tell = |share: f32| progress(&what, share);
    let (film, _, _) = timed(&pool(threads)?, &entrants[0].render, &tell);
    Ok(film)
}

/// What a contender's own frames say.
fn row(stage: &Stage, contender: Contender, threads: usize, runs: &Runs) -> FrameRow {
    FrameRow {
        scene: stage.name().to_owned(),
        path: stage.path().to_owned(),
        camera: stage.camera().name.clone(),
        accel: stage.accel(),
        contender,
        threads,
        frame_ms: runs.frame_ms(),
        speedup: None,
        stages: runs.stages(),
        relative_rmse: 0.0,
        flip_mean: 0.0,
        trusted_fraction: runs.stats.trusted_fraction(),
        shadow_rays: runs.stats.shadow_rays,
        lie_bytes: 0,
        shader_bytes: 0,
        construct_ms: 0.0,
        converged: false,
    }
}
