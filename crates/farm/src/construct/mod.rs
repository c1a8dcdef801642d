mod mend;
mod neighbours;
mod pass_rays;
mod past;
mod place;
mod point;
mod prove;
mod sample;
mod shafts;
mod sheet;
mod square;
mod tally;
mod view;

use std::{
    collections::{BTreeMap, VecDeque},
    sync::Arc,
};

use lie_octree::{CellKey, LieSettings, LieTree, Observation, Proof, Region};
use lie_render::{Mismatch, World};
use rayon::prelude::*;

use self::{
    neighbours::Neighbours, place::Place, point::Point, prove::Prover, shafts::Shafts,
    sheet::Weighing, view::ViewProgress,
};
pub(crate) use self::{past::MOST_VIEWS, tally::Finding};
pub use self::{
    past::{PastView, Snapshot},
    view::View,
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
    /// Whether lights are settled by geometry where that is possible.
    pub proofs: bool,
    /// Where samples are taken first.
    pub order: Order,
}

/// Which points of a view a pass samples, and in which order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// Those where a part of a pixel's light is in doubt, by how much it is. In the paper's
    /// mode all of them, those first whose cells have the fewest samples.
    #[default]
    Doubt,
    /// All of them, as they lie in space.
    Space,
}

/// So many times the points that a cell needs to split, and it is not worth proving anything.
const CROWDED: usize = 4;

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
            proofs: true,
            order: Order::Doubt,
        }
    }
}

impl ConstructSettings {
    /// Where nothing is doubted, what a cell has not seen of a light with an extent is wrong, and
    /// each point sees some of it alone: it takes twice as many points, less one, to split. A
    /// light without extent is known for good where it was seen.
    fn for_scene(mut self, scene: &lie_scene::Scene) -> Self {
        if self.lie.trust == 0 && !scene.lights.iter().all(lie_scene::Light::is_delta) {
            self.lie.split_samples = self.lie.split_samples.saturating_mul(2).saturating_sub(1);
        }
        self
    }
}

/// Constructs LIEs by sampling views (LIE §4.1), in batches.
///
/// A batch is observed by many threads against the tree as it stands, and then recorded by
/// one, in order: the result does not depend on how many threads there were.
pub struct Builder {
    world: Arc<World>,
    neighbours: Neighbours,
    shafts: Arc<Shafts>,
    /// `None` where nothing is to be proven.
    prover: Option<Prover>,
    settings: ConstructSettings,
    tree: LieTree,
    pool: rayon::ThreadPool,
    views: Vec<ViewProgress>,
    /// Views that were looked at before, the latest last.
    past: VecDeque<PastView>,
    /// Samples that others had taken before it.
    epoch: u64,
    /// Pixels sampled so far, those included that show no surface or nothing that is in doubt.
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
    /// Pixels that this builder has sampled so far, those included that show no surface or nothing
    /// that is in doubt.
    pub taken: u64,
    /// Relative RMSE of the picture over the last pass through the pixels' centres, as far as
    /// samples answer for it: what is certain is counted neither in the error nor in the mean.
    /// The largest of all views; `None` before every view has seen a whole pass.
    pub estimated_error: Option<f32>,
    /// Whether every view has converged: more construction would make its picture neither
    /// better nor much cheaper.
    pub converged: bool,
}

impl Builder {
    /// Surface points in one batch, about.
    const BATCH: u64 = 8192;

    /// An empty tree over the world.
    ///
    /// # Errors
    /// If the threads cannot be started.
    pub fn new(
        world: Arc<World>,
        settings: ConstructSettings,
    ) -> Result<Self, rayon::ThreadPoolBuildError> {
        let settings = settings.for_scene(world.scene());
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(settings.threads)
            .thread_name(|index| format!("construct-{index}"))
            .build()?;
        let scene = world.scene();
        let lights = scene.lights.len() as u32;
        let tree = LieTree::new(scene.geometry.bounds(), lights, settings.lie);
        // The paper's mode proves nothing, and masking wants to see what lights give.
        let lie = tree.settings();
        let shafts = Arc::new(Shafts::new(world.clone()));
        let may_prove = settings.proofs && lie.trust > 0 && lie.masking == 0.0;
        let prover = may_prove.then(|| Prover::new(&world, shafts.clone(), lie.crowd));
        Ok(Self {
            prover,
            shafts,
            neighbours: Neighbours::new(&world.scene().geometry),
            world,
            settings,
            tree,
            pool,
            views: vec![],
            past: VecDeque::new(),
            epoch: 0,
            taken: 0,
        })
    }

    /// What it constructs LIEs for.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Pixels that it has sampled so far, those included that show no surface or nothing that is in
    /// doubt.
    #[must_use]
    pub fn taken(&self) -> u64 {
        self.taken
    }

    /// The tree; a clone is a snapshot and costs nothing.
    #[must_use]
    pub fn tree(&self) -> &LieTree {
        &self.tree
    }

    /// Samples some surface points of these views, of each about as many, and learns from it:
    /// first where most of a pixel's light is in doubt. A view that was there in the last batch
    /// goes on where it was; without views nothing happens, and nothing is left to converge.
    pub fn batch(&mut self, views: &[View]) -> BatchReport {
        self.look_at(views);
        let planned = self.plan();
        let points = self.visible_points(&planned);
        self.prove(&points);
        let (world, tree, views_now) = (&*self.world, &self.tree, &self.views);
        let (neighbours, prover) = (&self.neighbours, self.prover.as_ref());
        let observed: Vec<Vec<Observation>> = self.pool.install(|| {
            planned
                .par_iter()
                .zip(points)
                .with_max_len(1)
                .map(|((view, places), points)| {
                    let progress = &views_now[*view];
                    let random = progress.random(places);
                    let typical = progress.typical;
                    let sampling = sample::Sampling {
                        world,
                        neighbours,
                        prover,
                        tree,
                        typical,
                        is_survey: progress.is_survey,
                    };
                    sampling.observe(random, points)
                })
                .collect()
        });
        for ((view, places), observations) in planned.iter().zip(&observed) {
            self.views[*view].count(observations);
            self.taken += places.len() as u64;
        }
        let done = self.views.iter_mut().map(ViewProgress::end_batch);
        self.taken += done.sum::<u64>();
        let observed: Vec<Observation> = observed.into_iter().flatten().collect();
        self.tree.record_between(&observed, &*self.shafts);
        self.report()
    }

    /// Neighbourhoods that are worth a sample, each with its view's index.
    fn plan(&mut self) -> Vec<(usize, Vec<Place>)> {
        let weighing = Weighing {
            world: &self.world,
            tree: &self.tree,
            order: self.settings.order,
            prover: self.prover.as_ref(),
        };
        let share = Self::BATCH.div_ceil(self.views.len().max(1) as u64);
        let views = &mut self.views;
        self.pool.install(|| {
            let plan = |(index, progress): (usize, &mut ViewProgress)| {
                let places = progress.plan(weighing, share);
                places.into_iter().map(move |places| (index, places))
            };
            views.iter_mut().enumerate().flat_map(plan).collect()
        })
    }

    /// The surfaces at the planned places.
    fn visible_points(&self, planned: &[(usize, Vec<Place>)]) -> Vec<Vec<Point>> {
        let (world, views) = (&*self.world, &self.views);
        let points = |(view, places): &(usize, Vec<Place>)| {
            let point = |place| Point::new(world, views[*view].rays(), place);
            places.iter().map(point).collect()
        };
        self.pool
            .install(|| planned.par_iter().with_max_len(1).map(points).collect())
    }

    /// Settles what can be settled of the cells around some points, and splits those of which too
    /// much is left.
    fn prove<'p>(&mut self, points: &'p [Vec<Point>]) {
        let Some(prover) = &self.prover else { return };
        let settings = self.tree.settings();
        let dense = settings.split_samples as usize;
        let origin = |point: &&Point| point.surface.shadow_origin;
        let mut left: Vec<&Point> = points.iter().flatten().collect();
        // What is certain of the cells that the points left over were in.
        let mut above: BTreeMap<CellKey, Region> = BTreeMap::new();
        while !left.is_empty() {
            let tree = &self.tree;
            let mut placed: Vec<(CellKey, &Point)> = left
                .iter()
                .map(|point| (tree.key_at(origin(point)), *point))
                .collect();
            placed.sort_by_key(|&(key, _)| key);
            let cells: Vec<&[(CellKey, &Point)]> = placed.chunk_by(|a, b| a.0 == b.0).collect();
            let world = &*self.world;
            let settle = |cell: &[(CellKey, &'p Point)]| {
                let key = cell[0].0;
                let points: Vec<&'p Point> = cell.iter().map(|(_, point)| *point).collect();
                let lie = tree.lie_at(origin(&points[0]));
                if points.len() > CROWDED * dense && key.depth() < settings.max_depth {
                    // It will be split anyway.
                    return (key, Some(Region::default()), points);
                }
                let parent = CellKey::from_raw(key.raw() >> 3);
                let above = parent.and_then(|parent| above.get(&parent));
                let bounds = tree.cube().cell_bounds(key);
                let region = prover.settle(world, &lie, above, bounds, &points);
                (key, region, points)
            };
            let settled: Vec<(CellKey, Option<Region>, Vec<&Point>)> = self
                .pool
                .install(|| cells.par_iter().map(|cell| settle(cell)).collect());
            left.clear();
            let mut next = BTreeMap::new();
            for (key, region, points) in settled {
                let Some(region) = region else { continue };
                let open = region.lights().filter(|(_, proof)| *proof == Proof::Open);
                let lie = self.tree.lie_at(origin(&points[0]));
                let complexity = lie.complexity_with(&region, settings.crowd)
                    + open.count() * settings.crowd as usize;
                let is_complex =
                    region.bounds.is_empty() || complexity > settings.split_threshold as usize;
                if is_complex && points.len() >= dense && self.tree.split(key) {
                    left.extend(points);
                    next.insert(key, region);
                } else if !region.bounds.is_empty() {
                    self.tree.settle(key, region);
                }
            }
            above = next;
        }
    }

    /// Takes in what audits found, which the next batch reports as changes. Gives how many answers
    /// were wrong: one that has been learnt since, or that is wrong on purpose since others mask
    /// the light, does not count.
    pub fn mend(&mut self, found: &[Mismatch]) -> u64 {
        mend::mend(&self.world, &mut self.tree, found)
    }

    /// What is known of these views without another sample. Those that converged before have
    /// converged still.
    pub fn look(&mut self, views: &[View]) -> BatchReport {
        self.look_at(views);
        self.report()
    }

    /// Samples the views until they have converged, if they have not yet, or until `max_samples`
    /// are recorded in all. `progress` is called after every batch.
    pub fn converge(
        &mut self,
        views: &[View],
        max_samples: u64,
        mut progress: impl FnMut(&BatchReport),
    ) -> BatchReport {
        let before = self.taken;
        let mut report = self.look(views);
        while !report.converged {
            report = self.batch(views);
            progress(&report);
            if self.taken - before >= max_samples {
                break;
            }
        }
        report
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
        let mut report = self.look(views);
        while self.taken - before < samples && !views.is_empty() {
            report = self.batch(views);
            progress(&report);
        }
        report
    }

    /// Keeps the progress of views that stay, and of the others only if they have converged.
    fn look_at(&mut self, views: &[View]) {
        let mut before = std::mem::take(&mut self.views);
        for view in views {
            let known = before.iter().position(|progress| progress.view == *view);
            let progress = match known {
                Some(index) => before.swap_remove(index),
                None => self.recall(view),
            };
            self.views.push(progress);
        }
        self.keep(before);
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
