use std::sync::Arc;

use glam::{UVec2, Vec2};
use lie_geom::{RandomKey, Ray};
use lie_octree::{CellKey, LieSettings, LieTree, Observation, ShadowRay, Visibility, observe};
use lie_render::World;
use lie_scene::Camera;
use rayon::prelude::*;

/// How LIEs are constructed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstructSettings {
    /// How the tree grows.
    pub lie: LieSettings,
    /// Seed of the samples: the same seed and views give the same tree, on any number of threads.
    pub seed: u64,
    /// Threads to sample with; 0 is one for each core.
    pub threads: usize,
    /// Relative RMSE of the picture below which a view counts as converged.
    pub tolerance: f32,
}

impl ConstructSettings {
    /// Share of a view's light evaluations that must be trusted before it counts as converged.
    pub const TRUSTED: f32 = 0.99;

    /// Settings for a scene, with the scene's own depth and threshold.
    #[must_use]
    pub fn new(settings: &lie_scene::RenderSettings) -> Self {
        Self {
            lie: LieSettings {
                max_depth: settings.max_depth,
                split_threshold: settings.split_threshold,
                ..LieSettings::default()
            },
            seed: 0,
            threads: 0,
            tolerance: 0.002,
        }
    }
}

/// What somebody looks at: samples are taken where it shows the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// From where.
    pub camera: Camera,
    /// Columns and rows of the picture.
    pub size: UVec2,
}

/// Constructs LIEs by sampling views (LIE §4.1), in batches.
///
/// A batch is observed by many threads against the tree as it stands, and then recorded by
/// one, in order: the result does not depend on how many threads there were.
pub struct Builder {
    world: Arc<World>,
    settings: ConstructSettings,
    tree: LieTree,
    pool: rayon::ThreadPool,
    views: Vec<ViewProgress>,
}

/// What a batch did.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchReport {
    /// Cells that shaders now see differently, parents before their children.
    pub changed: Vec<CellKey>,
    /// The tree's version.
    pub version: u64,
    /// Samples recorded so far.
    pub samples: u64,
    /// Relative RMSE of the picture over the last pass, the largest of all views; `None`
    /// before every view has seen a whole pass.
    pub estimated_error: Option<f32>,
    /// Whether every view has converged: error below the tolerance and lights trusted.
    pub converged: bool,
}

/// How far one view has come.
struct ViewProgress {
    view: View,
    key: RandomKey,
    /// Samples taken of it.
    taken: u64,
    pass: Pass,
    /// Mean luminance of the last whole pass, or of what there is of the first.
    typical: f32,
    /// Error and share of trusted light evaluations of the last whole pass.
    last: Option<(f32, f32)>,
}

/// Sums over one pass: one sample in every pixel.
#[derive(Clone, Copy, Default)]
struct Pass {
    samples: u64,
    evaluations: u64,
    trusted: u64,
    squared_error: f64,
    luminance: f64,
}

impl Builder {
    /// Samples in one batch.
    pub const BATCH: usize = 8192;

    /// An empty tree over the world.
    ///
    /// # Errors
    /// If the threads cannot be started.
    pub fn new(
        world: Arc<World>,
        settings: ConstructSettings,
    ) -> Result<Self, rayon::ThreadPoolBuildError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(settings.threads)
            .thread_name(|index| format!("construct-{index}"))
            .build()?;
        let tree = LieTree::new(world.scene().geometry.bounds(), settings.lie);
        Ok(Self {
            world,
            settings,
            tree,
            pool,
            views: vec![],
        })
    }

    /// The tree; a clone is a snapshot and costs nothing.
    #[must_use]
    pub fn tree(&self) -> &LieTree {
        &self.tree
    }

    /// Samples these views evenly, [`Self::BATCH`] samples in all, and learns from it. A
    /// view that was there in the last batch goes on where it was; without views nothing
    /// happens, and nothing is left to converge.
    pub fn batch(&mut self, views: &[View]) -> BatchReport {
        self.look_at(views);
        let mut planned = vec![];
        let share = Self::BATCH / self.views.len().max(1);
        for (index, progress) in self.views.iter_mut().enumerate() {
            planned.extend(
                (progress.taken..progress.taken + share as u64).map(|sample| (index, sample)),
            );
            progress.taken += share as u64;
        }
        let (world, tree, views_now) = (&*self.world, &self.tree, &self.views);
        let observations: Vec<Option<Observation>> = self.pool.install(|| {
            planned
                .par_iter()
                .with_min_len(64)
                .map_init(Scratch::default, |scratch, &(view, sample)| {
                    sample_view(world, tree, &views_now[view], sample, scratch)
                })
                .collect()
        });
        for ((view, _), observation) in planned.iter().zip(&observations) {
            if let Some(observation) = observation {
                self.tree.record(observation);
            }
            self.views[*view].count(observation.as_ref());
        }
        self.report()
    }

    /// Samples the views until they have converged, or until `max_samples` are recorded in
    /// all. `progress` is called after every batch.
    pub fn converge(
        &mut self,
        views: &[View],
        max_samples: u64,
        mut progress: impl FnMut(&BatchReport),
    ) -> BatchReport {
        loop {
            let report = self.batch(views);
            progress(&report);
            let taken: u64 = self.views.iter().map(|view| view.taken).sum();
            if report.converged || taken >= max_samples {
                return report;
            }
        }
    }

    /// Records `samples` samples of the views, rounded up to whole batches.
    pub fn sample(&mut self, views: &[View], samples: u64) -> BatchReport {
        let mut report = self.batch(&[]);
        for _ in 0..samples.div_ceil(Self::BATCH as u64) {
            report = self.batch(views);
        }
        report
    }

    /// Keeps the progress of views that stay, drops the others.
    fn look_at(&mut self, views: &[View]) {
        let mut before = std::mem::take(&mut self.views);
        for view in views {
            let known = before.iter().position(|progress| progress.view == *view);
            let progress = match known {
                Some(index) => before.swap_remove(index),
                None => ViewProgress::new(view.clone(), self.settings.seed),
            };
            self.views.push(progress);
        }
    }

    fn report(&mut self) -> BatchReport {
        let changed = self.tree.commit();
        let errors: Option<Vec<(f32, f32)>> = self.views.iter().map(|view| view.last).collect();
        let converged = |&(error, trusted): &(f32, f32)| {
            error <= self.settings.tolerance && trusted >= ConstructSettings::TRUSTED
        };
        BatchReport {
            changed,
            version: self.tree.version(),
            samples: self.tree.samples(),
            converged: errors
                .as_ref()
                .is_some_and(|errors| errors.iter().all(converged)),
            estimated_error: errors
                .map(|errors| errors.iter().fold(0.0, |max, &(error, _)| error.max(max))),
        }
    }
}

impl ViewProgress {
    fn new(view: View, seed: u64) -> Self {
        Self {
            view,
            key: RandomKey::new(seed),
            taken: 0,
            pass: Pass::default(),
            typical: 0.0,
            last: None,
        }
    }

    /// The film point of a sample: every pixel once in a pass, in an order that is spread
    /// over the picture from the first sample on. Every other pass goes through the pixels'
    /// centres, where a frame with one sample per pixel looks: what only a single pixel
    /// shows is found as well. The passes between go through random places.
    fn film_point(&self, sample: u64) -> (Vec2, RandomKey) {
        let size = self.view.size;
        let pixels = u64::from(size.x) * u64::from(size.y);
        let (pass, index) = (sample / pixels, sample % pixels);
        let key = self.key.mix(pass);
        // A stride near the golden section visits every pixel if it shares no factor with
        // their number.
        let mut stride = (pixels as f64 * 0.618_033_988_75) as u64 | 1;
        while gcd(stride, pixels) != 1 {
            stride += 2;
        }
        let pixel = (index * stride + key.bits(1) % pixels) % pixels;
        let key = key.mix(pixel);
        let corner = Vec2::new(
            (pixel % u64::from(size.x)) as f32,
            (pixel / u64::from(size.x)) as f32,
        );
        let offset = if pass.is_multiple_of(2) {
            Vec2::splat(0.5)
        } else {
            key.uniform2(0)
        };
        (corner + offset, key.mix(1))
    }

    fn count(&mut self, observation: Option<&Observation>) {
        let pass = &mut self.pass;
        pass.samples += 1;
        if let Some(seen) = observation {
            pass.evaluations += seen.outcomes.len() as u64;
            pass.trusted += u64::from(seen.trusted);
            pass.squared_error += f64::from(seen.predicted - seen.actual).powi(2);
            pass.luminance += f64::from(seen.actual);
        }
        if self.last.is_none() {
            self.typical = pass.mean();
        }
        if pass.samples == u64::from(self.view.size.x) * u64::from(self.view.size.y) {
            self.last = Some((pass.relative_rmse(), pass.trusted_share()));
            self.pass = Pass::default();
        }
    }
}

impl Pass {
    fn mean(&self) -> f32 {
        (self.luminance / self.samples as f64) as f32
    }

    fn relative_rmse(&self) -> f32 {
        let mean = self.luminance / self.samples as f64;
        let rmse = (self.squared_error / self.samples as f64).sqrt();
        if rmse == 0.0 {
            0.0
        } else {
            (rmse / mean) as f32
        }
    }

    fn trusted_share(&self) -> f32 {
        if self.evaluations == 0 {
            1.0
        } else {
            self.trusted as f32 / self.evaluations as f32
        }
    }
}

/// Buffers that one thread uses again and again.
#[derive(Default)]
struct Scratch {
    light_rays: Vec<lie_render::LightRay>,
    shadow_rays: Vec<ShadowRay>,
}

/// One sample of LIE §4.1; `None` where the camera ray leaves the scene.
fn sample_view(
    world: &World,
    tree: &LieTree,
    progress: &ViewProgress,
    sample: u64,
    scratch: &mut Scratch,
) -> Option<Observation> {
    let (film, key) = progress.film_point(sample);
    let ray = progress.view.camera.ray(film, progress.view.size);
    let surface = world.first_surface(&ray)?;
    world.light_rays(&surface, key, &mut scratch.light_rays);
    scratch.shadow_rays.clear();
    scratch
        .shadow_rays
        .extend(scratch.light_rays.iter().map(|light_ray| ShadowRay {
            light: light_ray.light,
            ray: light_ray.ray,
            weight: light_ray.weight(),
        }));
    Some(observe(
        tree,
        surface.position,
        &scratch.shadow_rays,
        progress.typical,
        &WorldVisibility(world),
    ))
}

struct WorldVisibility<'a>(&'a World);

impl Visibility for WorldVisibility<'_> {
    fn blocker(&self, ray: &Ray) -> Option<u32> {
        self.0.accel().blocker(ray)
    }

    fn blocks(&self, triangle: u32, ray: &Ray) -> bool {
        self.0.blocks(triangle, ray)
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
