use glam::UVec2;
use lie_geom::RandomKey;
use lie_octree::{LieSettings, Observation};
use lie_scene::Camera;

use super::{
    ConstructSettings,
    pass_rays::PassRays,
    place::Place,
    sheet::{self, Sheet, Weighing},
    square::Square,
    tally::{Finding, Tally},
};

/// What somebody looks at: samples are taken where it shows the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// From where.
    pub camera: Camera,
    /// Columns and rows of the picture.
    pub size: UVec2,
}

/// How far one view has come.
pub(super) struct ViewProgress {
    pub(super) view: View,
    pub(super) epoch: u64,
    key: RandomKey,
    /// The picture's squares, in the order in which they are looked at.
    squares: Vec<Square>,
    /// Whole passes so far.
    pub(super) passes: u64,
    /// Squares that this pass has looked at.
    looked_at: usize,
    /// What is left to learn of those looked at last.
    sheet: Sheet,
    /// Whether this pass leaves lights for later ones to ask.
    pub(super) is_survey: bool,
    /// Pixels done in this batch that were not sampled.
    passed_over: u64,
    tally: Tally,
    /// The last two whole passes through the pixels' centres, the later one first.
    pub(super) last: [Option<Finding>; 2],
    /// Mean luminance of a pixel, without the brightest, as far as samples answer for it; 0
    /// before there are any.
    pub(super) typical: f32,
    /// Whether a whole pass has shown that.
    pub(super) is_typical_known: bool,
}

/// Share of a view's light evaluations that may be in doubt when it counts as converged; and
/// which less must have come out of doubt by two passes for the rest to be left as it is.
const DOUBTFUL: f32 = 0.01;

/// Squares that are looked at together.
const SHEET: usize = 1024;

impl ViewProgress {
    /// A view that nobody has looked at yet. Of views that are sampled twice, each in its own
    /// epoch, the samples are different ones.
    pub(super) fn new(view: View, seed: u64, epoch: u64) -> Self {
        let mut squares: Vec<Square> = Square::all(view.size).collect();
        // Sheets are spread over all of a large picture.
        squares.sort_by_key(Square::spread);
        let key = RandomKey::new(seed).mix(CONSTRUCTION);
        Self {
            view,
            epoch,
            key: if epoch == 0 { key } else { key.mix(epoch) },
            squares,
            passes: 0,
            looked_at: 0,
            sheet: Sheet::default(),
            is_survey: false,
            passed_over: 0,
            tally: Tally::default(),
            typical: 0.0,
            is_typical_known: false,
            last: [None; 2],
        }
    }

    /// This pass's camera rays.
    pub(super) fn rays(&self) -> PassRays<'_> {
        PassRays {
            camera: &self.view.camera,
            size: self.view.size,
            key: self.key,
            pass: self.passes,
        }
    }

    /// What is random of a neighbourhood but not of its pixels.
    pub(super) fn random(&self, places: &[Place]) -> RandomKey {
        let key = self.key.mix(self.passes).mix(u64::MAX);
        places.first().map_or(key, |place| key.mix(place.code()))
    }

    /// The next points that are worth a sample, about so many, by their neighbourhoods; none if
    /// what is left of this pass is not.
    pub(super) fn plan(&mut self, weighing: Weighing<'_>, points: u64) -> Vec<Vec<Place>> {
        let mut planned = vec![];
        let mut count = 0;
        while count < points {
            match self.sheet.clusters.pop() {
                Some(cluster) => {
                    count += cluster.places.len() as u64;
                    planned.push(cluster);
                }
                // What one sheet teaches is known before the next is looked at.
                None if !planned.is_empty() => break,
                None if self.looked_at == self.squares.len() => break,
                None => self.look(weighing),
            }
        }
        sheet::join(planned)
    }

    /// Looks at the next squares. What was left to learn of those before is done.
    fn look(&mut self, weighing: Weighing<'_>) {
        self.end_sheet();
        let end = self.squares.len().min(self.looked_at + SHEET);
        let squares = &self.squares[self.looked_at..end];
        self.sheet = Sheet::new(weighing, self.rays(), squares);
        self.is_survey = weighing.is_survey(self.rays());
        self.looked_at = end;
    }

    /// Relative RMSE of the picture, as the last whole pass through the pixels' centres showed
    /// it.
    pub(super) fn error(&self) -> Option<f32> {
        self.last[0].map(|last| last.error)
    }

    /// Whether more construction would make the picture neither better nor much cheaper. What
    /// is traced is right: of doubt it matters alone whether there will be less of it soon.
    pub(super) fn has_converged(&self, settings: &ConstructSettings) -> bool {
        let [Some(last), before] = self.last else {
            return false;
        };
        let LieSettings {
            trust,
            split_samples,
            ..
        } = settings.lie;
        let gained = before.map(|before| Finding {
            error: before.error - last.error,
            doubtful: before.doubtful - last.doubtful,
        });
        // With doubt an error is what samples in a row did not show, and stays.
        let is_right = last.error <= settings.tolerance
            || trust > 0 && gained.is_some_and(|gained| gained.error < settings.tolerance);
        // Two rays to each light from every sample: no cell can be known earlier.
        let patience = u64::from(trust / (2 * split_samples.max(1)));
        let is_cheap = last.doubtful <= DOUBTFUL
            || self.passes >= patience.max(3)
                && gained.is_some_and(|gained| gained.doubtful < DOUBTFUL);
        is_right && is_cheap
    }

    /// Takes in what some points showed.
    pub(super) fn count(&mut self, observations: &[Observation]) {
        self.tally.count(observations);
    }

    /// Ends a batch, and the pass if nothing is left of it: how many pixels are done beside those
    /// that were sampled.
    pub(super) fn end_batch(&mut self) -> u64 {
        if self.sheet.clusters.is_empty() {
            self.end_sheet();
            if self.looked_at == self.squares.len() {
                self.end_pass();
            }
        }
        // The first pass has no other to know the picture's luminance from.
        if !self.is_typical_known && self.tally.pixels > 0 {
            self.typical = self.tally.mean();
        }
        std::mem::take(&mut self.passed_over)
    }

    /// Counts the pixels of a sheet that were not worth a sample.
    fn end_sheet(&mut self) {
        let sheet = std::mem::take(&mut self.sheet);
        self.tally.skip(sheet.rest, sheet.evaluated, sheet.answered);
        self.passed_over += sheet.rest;
    }

    fn end_pass(&mut self) {
        let tally = std::mem::take(&mut self.tally);
        // Later passes see less of it, where less is in doubt.
        self.typical = match tally.mean() {
            mean if self.is_typical_known => self.typical.max(mean),
            mean => mean,
        };
        self.is_typical_known = self.typical > 0.0;
        let found = tally.finding(self.typical);
        // Of lights that it leaves for later, a survey does not know how wrong they will be.
        let is_known = !self.is_survey || found.doubtful <= DOUBTFUL;
        if self.rays().goes_through_centres() && is_known {
            self.last = [Some(found), self.last[0]];
        }
        self.passes += 1;
        self.looked_at = 0;
    }

    /// Passes that were begun.
    pub(super) fn begun(&self) -> u64 {
        self.passes + u64::from(self.looked_at > 0)
    }
}

/// Keeps construction's random numbers apart from the frames'.
const CONSTRUCTION: u64 = 0x6c69_6573;
