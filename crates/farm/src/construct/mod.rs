mod neighbours;
mod sample;
mod view;

use std::sync::Arc;

use lie_octree::{CellKey, LieSettings, LieTree, Observation};
use lie_render::World;
use rayon::prelude::*;

pub use self::view::View;
use self::{
    neighbours::Neighbours,
    view::{Square, ViewProgress},
};

/// How LIEs are constructed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstructSettings {
    /// How the tree grows.
    pub lie: LieSettings,
    /// Seed of the samples: the same seed and views give the same tree, on any number of threads.
    pub seed: u64,
    /// Threads to sample with; 0 is one for each core.
    pub threads: usize,
    /// Relative RMSE of the picture that is good enough.
    pub tolerance: f32,
}

impl ConstructSettings {
    /// Settings for a scene, with the scene's own depth and threshold.
    #[must_use]
    pub fn new(scene: &lie_scene::Scene) -> Self {
        Self {
            lie: LieSettings {
                max_depth: scene.settings.max_depth,
                split_threshold: scene.split_threshold(),
                ..LieSettings::default()
            },
            seed: 0,
            threads: 0,
            tolerance: 0.002,
        }
    }
}

/// Constructs LIEs by sampling views (LIE §4.1), in batches.
///
/// A batch is observed by many threads against the tree as it stands, and then recorded by
/// one, in order: the result does not depend on how many threads there were.
pub struct Builder {
    world: Arc<World>,
    neighbours: Neighbours,
    settings: ConstructSettings,
    tree: LieTree,
    pool: rayon::ThreadPool,
    views: Vec<ViewProgress>,
    /// Pixels sampled so far, those that show no surface included.
    taken: u64,
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
    /// Pixels sampled so far, those that show no surface included.
    pub taken: u64,
    /// Relative RMSE of the picture over the last pass through the pixels' centres, the largest
    /// of all views; `None` before every view has seen a whole pass.
    pub estimated_error: Option<f32>,
    /// Whether every view has converged: more construction would make its picture neither
    /// better nor much cheaper.
    pub converged: bool,
}

impl Builder {
    /// Squares of 16 × 16 pixels in one batch.
    const BATCH: usize = 32;

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
        let scene = world.scene();
        let lights = scene.lights.len() as u32;
        let tree = LieTree::new(scene.geometry.bounds(), lights, settings.lie);
        Ok(Self {
            neighbours: Neighbours::new(&world.scene().geometry),
            world,
            settings,
            tree,
            pool,
            views: vec![],
            taken: 0,
        })
    }

    /// The tree; a clone is a snapshot and costs nothing.
    #[must_use]
    pub fn tree(&self) -> &LieTree {
        &self.tree
    }

    /// Samples some squares of these views, of each about as many, and learns from it. A
    /// view that was there in the last batch goes on where it was; without views nothing
    /// happens, and nothing is left to converge.
    pub fn batch(&mut self, views: &[View]) -> BatchReport {
        self.look_at(views);
        let mut planned: Vec<(usize, Square)> = vec![];
        let share = Self::BATCH.div_ceil(self.views.len().max(1));
        for (index, progress) in self.views.iter_mut().enumerate() {
            planned.extend((0..share).map(|_| (index, progress.next_square())));
        }
        let (world, tree, views_now) = (&*self.world, &self.tree, &self.views);
        let neighbours = &self.neighbours;
        let observed: Vec<Vec<Observation>> = self.pool.install(|| {
            planned
                .par_iter()
                .with_max_len(1)
                .map(|&(view, square)| {
                    sample::observe_square(world, neighbours, tree, &views_now[view], square)
                })
                .collect()
        });
        for (&(view, square), observations) in planned.iter().zip(&observed) {
            self.views[view].count(square, observations);
            self.taken += square.pixels();
        }
        let observed: Vec<Observation> = observed.into_iter().flatten().collect();
        self.tree.record(&observed);
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
        let before = self.taken;
        loop {
            let report = self.batch(views);
            progress(&report);
            if report.converged || self.taken - before >= max_samples {
                return report;
            }
        }
    }

    /// Samples `samples` pixels of the views, rounded up to whole batches. `progress` is
    /// called after every batch.
    pub fn sample(
        &mut self,
        views: &[View],
        samples: u64,
        mut progress: impl FnMut(&BatchReport),
    ) -> BatchReport {
        let before = self.taken;
        let mut report = self.batch(&[]);
        while self.taken - before < samples && !views.is_empty() {
            report = self.batch(views);
            progress(&report);
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
        let views = &self.views;
        let errors: Option<Vec<f32>> = views.iter().map(ViewProgress::error).collect();
        BatchReport {
            changed,
            version: self.tree.version(),
            samples: self.tree.samples(),
            taken: self.taken,
            converged: views.iter().all(|view| view.has_converged(&self.settings)),
            estimated_error: errors.map(|errors| errors.into_iter().fold(0.0, f32::max)),
        }
    }
}
