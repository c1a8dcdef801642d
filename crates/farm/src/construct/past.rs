use lie_octree::LieTree;

use super::{Builder, View, tally::Finding, view::ViewProgress};

/// What stays of a view that is not looked at any more, or was not when it was saved.
#[derive(Clone, Debug, PartialEq)]
pub struct PastView {
    /// What was looked at.
    pub(crate) view: View,
    /// What its random numbers depend on, beside the seed.
    pub(crate) epoch: u64,
    /// Passes that were begun.
    pub(crate) passes: u32,
    /// The last two whole passes through the pixels' centres, the later one first.
    pub(crate) last: [Option<Finding>; 2],
    /// Mean luminance of a pixel.
    pub(crate) typical: f32,
    /// The tree's version when it was last looked at.
    pub(crate) version: u64,
}

/// All that a [`Builder`] knows: another one in the same scene goes on from there.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// What was learnt.
    pub tree: LieTree,
    /// What was looked at to learn it, and how far that came; the latest last.
    pub(crate) views: Vec<PastView>,
    /// Whether lights were settled by geometry.
    pub(crate) proofs: bool,
}

/// Most views that are remembered.
pub(crate) const MOST_VIEWS: usize = 1024;

impl PastView {
    /// Whether it is what somebody looks at, whatever the cameras are called.
    fn is_of(&self, view: &View) -> bool {
        let what = |view: &View| {
            let camera = &view.camera;
            let place = (camera.eye, camera.orientation);
            (place, camera.vertical_fov, view.size)
        };
        what(&self.view) == what(view)
    }
}

impl ViewProgress {
    /// A view that is looked at again. Its last pass counts as done, with nothing found.
    fn resume(view: View, past: &PastView, seed: u64) -> Self {
        let mut progress = Self::new(view, seed, past.epoch);
        progress.passes = u64::from(past.passes);
        progress.last = past.last;
        progress.typical = past.typical;
        progress.is_typical_known = past.typical > 0.0;
        progress
    }

    /// What is to be kept of it, as the tree is at this version.
    fn past(&self, version: u64) -> PastView {
        PastView {
            view: self.view.clone(),
            epoch: self.epoch,
            passes: u32::try_from(self.begun()).unwrap_or(u32::MAX),
            last: self.last,
            typical: self.typical,
            version,
        }
    }
}

impl Builder {
    /// All that is known; costs next to nothing, since the tree is shared.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let version = self.tree.version();
        let now = self.views.iter().map(|progress| progress.past(version));
        let views: Vec<PastView> = self.past.iter().cloned().chain(now).collect();
        let surplus = views.len().saturating_sub(MOST_VIEWS);
        Snapshot {
            tree: self.tree.clone(),
            views: views[surplus..].to_vec(),
            proofs: self.prover.is_some(),
        }
    }

    /// Goes on from what another builder knew, of the same scene and settings.
    pub(crate) fn restore(&mut self, snapshot: Snapshot) {
        self.tree = snapshot.tree;
        // Whoever comes gets all of it.
        self.tree.commit();
        self.past = snapshot.views.into();
        self.views.clear();
        self.epoch = self.tree.samples();
    }

    /// Whether lights are settled by geometry.
    pub(crate) fn has_proofs(&self) -> bool {
        self.prover.is_some()
    }

    /// The progress of a view that was not looked at just now.
    pub(super) fn recall(&mut self, view: &View) -> ViewProgress {
        let seed = self.settings.seed;
        let known = self.past.iter().position(|past| past.is_of(view));
        let Some(mut past) = known.and_then(|index| self.past.remove(index)) else {
            return ViewProgress::new(view.clone(), seed, self.epoch);
        };
        // Doubt is traced. But without it, a cell that was split since may be wrong.
        if self.settings.lie.trust == 0 && past.version != self.tree.version() {
            past.last = [None; 2];
        }
        ViewProgress::resume(view.clone(), &past, seed)
    }

    /// Remembers views that are left, if they have converged.
    pub(super) fn keep(&mut self, left: Vec<ViewProgress>) {
        let version = self.tree.version();
        for progress in left {
            if progress.has_converged(&self.settings) {
                self.past.push_back(progress.past(version));
            }
        }
        while self.past.len() > MOST_VIEWS {
            self.past.pop_front();
        }
    }
}
