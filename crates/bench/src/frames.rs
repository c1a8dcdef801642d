use lie_render::{AccelKind, Film, compare};

use crate::{
    BenchError, Contender, Lineup, Progress, Spread, Stage, Stages,
    construct::Constructed,
    race::{Entrant, Render, Runs, pool, race, timed},
};

/// What is measured of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct FramesConfig {
    /// Numbers of threads, one measurement for each.
    pub threads: Vec<usize>,
    /// Frames of each contender.
    pub repeat: u32,
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

/// Renders a view by a line-up, in turn, and compares each with the standard.
///
/// # Errors
/// If threads cannot be started.
pub fn measure_frames(
    stage: &Stage,
    lineup: &Lineup,
    config: &FramesConfig,
    progress: &Progress<'_>,
) -> Result<SceneFrames, BenchError> {
    let mut picture = Film::new(stage.settings().size);
    let mut reference: Option<Film> = None;
    let mut rows = vec![];
    for &threads in &config.threads {
        let pool = pool(threads)?;
        // The first frame of a run is slower than the others; a small one will do for that.
        race(&pool, 1, &entrants(&stage.thumbnail(), lineup), &|_, _| {});
        let runs = race(&pool, config.repeat, &entrants(stage, lineup), progress);
        let mut finishers = lineup.iter().zip(&runs);
        let standard = finishers.find(|((contender, _), _)| *contender == Contender::Standard);
        let standard = standard.map(|(_, runs)| runs);
        // Pictures do not depend on the number of threads: one reference is enough.
        let reference = reference.get_or_insert_with(|| match standard {
            Some(standard) => standard.film.clone(),
            None => render_reference(stage, &pool, progress),
        });
        for ((contender, lies), runs) in lineup.iter().zip(&runs) {
            let figures = compare(&runs.film, reference, stage.exposure_stops())?;
            rows.push(FrameRow {
                threads: pool.current_num_threads(),
                speedup: standard.and_then(|standard| runs.speedup_over(standard)),
                relative_rmse: figures.relative_rmse,
                flip_mean: figures.flip_mean,
                ..row(stage, contender, lies, runs)
            });
        }
        picture = runs.into_iter().next_back().map_or(picture, |run| run.film);
    }
    Ok(SceneFrames { rows, picture })
}

fn entrants<'a>(stage: &'a Stage, lineup: &'a Lineup) -> Vec<Entrant<'a>> {
    let entrant = |(contender, lies): (Contender, Option<&'a Constructed>)| Entrant {
        name: format!("{}: {}", stage.name(), contender.name()),
        render: Box::new(move |tell| contender.render(stage, lies.map(|lies| &lies.lies), tell)),
    };
    lineup.iter().map(entrant).collect()
}

fn render_reference(stage: &Stage, pool: &rayon::ThreadPool, progress: &Progress<'_>) -> Film {
    let render: Render<'_> = Box::new(|tell| Contender::Standard.render(stage, None, tell));
    let what = format!("{}: reference", stage.name());
    timed(pool, &render, &|share| progress(&what, share)).0
}

/// What a contender's own frames say.
fn row(stage: &Stage, contender: Contender, lies: Option<&Constructed>, runs: &Runs) -> FrameRow {
    FrameRow {
        scene: stage.name().to_owned(),
        path: stage.path().to_owned(),
        camera: stage.camera().name.clone(),
        accel: stage.accel(),
        contender,
        threads: 0,
        frame_ms: runs.frame_ms(),
        speedup: None,
        stages: runs.stages(),
        relative_rmse: 0.0,
        flip_mean: 0.0,
        trusted_fraction: runs.stats.trusted_fraction(),
        shadow_rays: runs.stats.shadow_rays,
        lie_bytes: lies.map_or(0, |lies| lies.tree_bytes),
        shader_bytes: lies.map_or(0, |lies| lies.shader_bytes),
        construct_ms: lies.map_or(0.0, |lies| lies.construct_ms),
        converged: lies.is_some_and(|lies| lies.converged),
    }
}
