use std::collections::{BTreeSet, HashSet};

use glam::Vec3;
use lie_geom::Aabb;

use crate::{
    Between, CellBody, CellKey, CellState, Lie, LightEvidence, Observation, PackedLie, Proof,
    Region,
    tree::{Cell, Cube, Octree},
};

/// How the tree grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LieSettings {
    /// Levels below the root that cells may reach; at most [`CellKey::MAX_DEPTH`].
    pub max_depth: u32,
    /// A cell with more occluders than this, summed over its lights, splits.
    pub split_threshold: u32,
    /// Observations that must come together from a cell for it to split: cells of a few
    /// pixels would never see enough of their lights. 1 is the paper.
    pub split_samples: u32,
    /// Samples that must agree on a light in a cell before shaders rely on it, if it gives
    /// all of a pixel's light; in proportion fewer if it gives less. Until then shaders
    /// trace its shadow rays. By the rule of three, what n samples agree on is wrong for
    /// fewer than 3/n of the rays (at 95 %). 0 is the paper: cells are relied on from the
    /// start, empty ones as well.
    pub trust: u32,
    /// Whether the children of a cell that splits start with what is known of it, until
    /// they know better. Without, they start from nothing, as in the paper.
    pub inherit: bool,
    /// Occluders of one light in one cell above which they are not listed any more: its
    /// shadow rays go through the scene, which is cheaper then, and right. The paper lists
    /// them all: [`u32::MAX`].
    pub crowd: u32,
    /// Share of the darkest sample of a cell, in `[0, 1]`, that lights may give which shaders
    /// leave out since the others outshine them (LIE §5, where it is 0.02). 0 masks none.
    pub masking: f32,
}

impl Default for LieSettings {
    fn default() -> Self {
        Self {
            max_depth: 9,
            split_threshold: 24,
            split_samples: 64,
            trust: 512,
            inherit: true,
            crowd: 256,
            masking: 0.0,
        }
    }
}

/// Sizes of a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LieStats {
    /// Leaves with at least one sample.
    pub cells: u64,
    /// Lights that reach them, by samples or by proof, summed over the leaves.
    pub entries: u64,
    /// Those of them that are masked.
    pub masked: u64,
    /// Occluders summed over the leaves.
    pub occluders: u64,
    /// Memory of the leaves' contents, evidence included.
    pub bytes: u64,
}

/// The constructor's tree: an octree of [`Lie`]s, packed, that grows by observations.
///
/// A clone is a snapshot: it shares everything and never changes.
#[derive(Clone, Debug, PartialEq)]
pub struct LieTree {
    pub(crate) tree: Octree<PackedLie>,
    pub(crate) settings: LieSettings,
    /// Lights of the scene.
    pub(crate) lights: u32,
    pub(crate) version: u64,
    pub(crate) changed: BTreeSet<CellKey>,
    pub(crate) samples: u64,
}

impl LieTree {
    /// An empty tree over the bounds of a scene with so many lights. Settings are clamped to
    /// what is possible.
    #[must_use]
    pub fn new(bounds: Aabb, lights: u32, settings: LieSettings) -> Self {
        Self {
            tree: Octree::new(Cube::around(bounds), PackedLie::default()),
            settings: LieSettings {
                max_depth: settings.max_depth.min(CellKey::MAX_DEPTH),
                masking: settings.masking.clamp(0.0, 1.0),
                ..settings
            },
            lights,
            version: 0,
            changed: BTreeSet::new(),
            samples: 0,
        }
    }

    /// How it grows.
    #[must_use]
    pub fn settings(&self) -> LieSettings {
        self.settings
    }

    /// The cube that it divides.
    #[must_use]
    pub fn cube(&self) -> Cube {
        self.tree.cube()
    }

    /// Counts commits that changed anything.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Observations recorded.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The LIE of the smallest cell around a point, unpacked.
    #[must_use]
    pub fn lie_at(&self, point: Vec3) -> Lie {
        self.packed_at(point).unpack()
    }

    /// The same as it is held; of points in one cell it is the same one.
    #[must_use]
    pub fn packed_at(&self, point: Vec3) -> &PackedLie {
        self.tree.leaf_at(point)
    }

    /// The smallest cell around a point.
    #[must_use]
    pub fn key_at(&self, point: Vec3) -> CellKey {
        self.tree.key_at(point)
    }

    /// The same evidence, with another share of light masked ([`LieSettings::masking`]):
    /// what these observations would have come to with it. Masks are conclusions alone and
    /// change nothing that is learnt.
    #[must_use]
    pub fn with_masking(&self, masking: f32) -> Self {
        let mut other = self.clone();
        other.settings.masking = masking.clamp(0.0, 1.0);
        for key in self.keys() {
            if let Some(leaf) = other.tree.leaf_mut(key) {
                let mut lie = leaf.unpack();
                lie.mask(&other.settings);
                *leaf = PackedLie::of(&lie);
            }
        }
        other
    }

    /// Takes over what has become certain of a leaf, and where. Nothing happens if there is no
    /// such leaf.
    pub fn settle(&mut self, key: CellKey, region: Region) {
        let version = self.version + 1;
        let Some(leaf) = self.tree.leaf_mut(key) else {
            return;
        };
        let mut lie = leaf.unpack();
        if *lie.region() != region {
            lie.settle(region);
            lie.version = version;
            *leaf = PackedLie::of(&lie);
            self.changed.insert(key);
        }
    }

    /// What the cell around a point says of a light turned out to be wrong: a ray from there met
    /// `blocker`, or nothing. The cell learns that, and whatever made it sure of the
    /// light counts no more. Nothing happens where shaders do not rely on the cell, or where
    /// the light is masked and the cell wrong on purpose; says whether anything did.
    pub fn contradict(&mut self, point: Vec3, light: u32, blocker: Option<u32>) -> bool {
        let (settings, version) = (self.settings, self.version + 1);
        let key = self.tree.key_at(point);
        let Some(leaf) = self.tree.leaf_mut(key) else {
            return false;
        };
        let mut lie = leaf.unpack();
        let is_told = settings.trust == 0 || lie.region().bounds.contains(point);
        let is_wrong =
            light < self.lights && is_told && lie.is_contradicted(light, blocker, settings.trust);
        if is_wrong {
            lie.contradict(light, blocker, &settings);
            lie.version = version;
            *leaf = PackedLie::of(&lie);
            self.changed.insert(key);
        }
        is_wrong
    }

    /// Splits a leaf, as far as cells may be divided: its parts start with its evidence, and with
    /// nothing that is certain. Says whether it did.
    pub fn split(&mut self, key: CellKey) -> bool {
        let version = self.version + 1;
        let Some(Cell::Leaf(leaf)) = self.tree.get(key) else {
            return false;
        };
        if key.depth() >= self.settings.max_depth {
            return false;
        }
        let part = if self.settings.inherit {
            leaf.unpack().part(version)
        } else {
            Lie::empty(version)
        };
        self.tree.split(key, &PackedLie::of(&part));
        self.changed.insert(key);
        self.changed.extend((0..8).map(|octant| key.child(octant)));
        true
    }

    /// Takes in observations, and splits the cells that have become too complex (LIE §4.1):
    /// their children start from nothing but these observations. They may have been made
    /// against an older state of the tree; those of one neighbourhood belong together.
    pub fn record(&mut self, observations: &[Observation]) {
        self.record_between(observations, &());
    }

    /// The same, where the geometry is known: of the occluders that a cell inherits it keeps
    /// those that may block its own rays.
    pub fn record_between(&mut self, observations: &[Observation], geometry: &impl Between) {
        let mut placed: Vec<(CellKey, &Observation)> = observations
            .iter()
            .map(|observation| (self.tree.key_at(observation.point), observation))
            .collect();
        // Stable: within a cell, the order stays.
        placed.sort_by_key(|&(key, _)| key);
        for group in placed.chunk_by(|a, b| a.0 == b.0) {
            self.record_in(group[0].0, group, geometry);
        }
        self.samples += observations.len() as u64;
    }

    /// Takes in observations from one leaf.
    fn record_in(
        &mut self,
        key: CellKey,
        group: &[(CellKey, &Observation)],
        geometry: &impl Between,
    ) {
        let (settings, lights, version) = (self.settings, self.lights, self.version);
        let bounds = self.cube().cell_bounds(key);
        let Some(leaf) = self.tree.leaf_mut(key) else {
            return;
        };
        let mut lie = leaf.unpack();
        let told = lie.state(settings.trust, lights);
        if lie.samples() == 0 {
            lie.narrow(bounds, geometry);
            *leaf = PackedLie::of(&lie);
        }
        lie.record(group.iter().map(|(_, seen)| *seen), &settings);
        if told != lie.state(settings.trust, lights) {
            lie.version = version + 1;
            self.changed.insert(key);
        }
        let too_complex = lie.complexity(settings.crowd) > settings.split_threshold as usize;
        let dense = group.len() >= settings.split_samples as usize;
        // Where something was to be proven, whoever tried it splits.
        let is_free = !lie.region().lights().any(|entry| entry.1 == Proof::Open);
        // Its parts start from what was known before.
        if is_free && too_complex && dense && key.depth() < settings.max_depth {
            self.split(key);
            let points = group.iter().map(|(_, seen)| *seen);
            let mut children: Vec<(CellKey, &Observation)> = points
                .map(|seen| (self.tree.key_at(seen.point), seen))
                .collect();
            children.sort_by_key(|&(key, _)| key);
            for group in children.chunk_by(|a, b| a.0 == b.0) {
                self.record_in(group[0].0, group, geometry);
            }
        } else {
            *leaf = PackedLie::of(&lie);
        }
    }

    /// Ends a batch: the cells whose [`Self::state`] differs from the last commit's, in
    /// order of their keys, so parents come before their children. The version counts up
    /// if there are any.
    pub fn commit(&mut self) -> Vec<CellKey> {
        let changed: Vec<CellKey> = std::mem::take(&mut self.changed).into_iter().collect();
        if !changed.is_empty() {
            self.version += 1;
        }
        changed
    }

    /// What shaders see of a cell; `None` if there is no such cell.
    #[must_use]
    pub fn state(&self, key: CellKey) -> Option<CellState> {
        Some(match self.tree.get(key)? {
            Cell::Inner => CellState {
                key,
                version: self.version,
                body: CellBody::Inner,
            },
            Cell::Leaf(leaf) => {
                let lie = leaf.unpack();
                CellState {
                    key,
                    version: lie.version,
                    body: CellBody::Leaf(lie.state(self.settings.trust, self.lights)),
                }
            }
        })
    }

    /// Every cell, parents before children: what a snapshot must send. Leaves that nothing
    /// is known of are left out, since splitting their parent makes them.
    #[must_use]
    pub fn keys(&self) -> Vec<CellKey> {
        let mut keys = vec![];
        self.tree.for_each(|key, cell| match cell {
            Cell::Leaf(leaf) if leaf.unpack().is_untold(self.settings.trust) => {}
            _ => keys.push(key),
        });
        keys
    }

    /// Counts everything; takes time in proportion to the number of cells.
    #[must_use]
    pub fn stats(&self) -> LieStats {
        let mut stats = LieStats::default();
        let mut shared = HashSet::new();
        self.tree.for_each(|_, cell| {
            let Cell::Leaf(leaf) = cell else { return };
            let counts = leaf.counts();
            // Parts of a cell that nobody has sampled yet are one.
            if counts.samples == 0 && !shared.insert(std::ptr::from_ref(leaf)) {
                return;
            }
            stats.cells += u64::from(counts.samples > 0);
            stats.entries += u64::from(counts.entries);
            stats.masked += u64::from(counts.masked);
            stats.occluders += u64::from(counts.occluders);
            stats.bytes += leaf.bytes() as u64;
        });
        stats
    }

    /// Checks every cell's invariants; for tests.
    ///
    /// # Errors
    /// The first broken one.
    pub fn validate(&self) -> Result<(), String> {
        let mut broken = Ok(());
        let may_be_listed = |listed: usize| listed <= self.settings.crowd as usize;
        self.tree.for_each(|key, cell| {
            let Cell::Leaf(leaf) = cell else { return };
            let lie = leaf.unpack();
            let region = lie.region();
            let is_certain = |entry: &LightEvidence| region.is_settled(entry.light);
            let one_verdict =
                region.is_valid() && !lie.lights().chain(lie.hidden()).any(is_certain);
            let rising = lie.lights().is_sorted_by(|a, b| a.light < b.light)
                && lie.hidden().is_sorted_by(|a, b| a.light < b.light);
            let counted = |entry: &LightEvidence| {
                let confirmed = entry.occluders.iter().filter(|own| own.is_confirmed());
                let confirmed = confirmed.count();
                let listed = may_be_listed(entry.occluders.len());
                confirmed <= usize::from(entry.blocked) && (listed || entry.inherited)
            };
            let masked: f64 = lie.lights().map(LightEvidence::masked_error).sum();
            let allowed = f64::from(self.settings.masking) * f64::from(lie.shown.least());
            let inherited = |entry: &LightEvidence| entry.inherited && self.settings.inherit;
            let holds = rising
                && one_verdict
                && lie
                    .lights()
                    .all(|entry| entry.clear >= 1 || inherited(entry))
                && lie
                    .hidden()
                    .all(|entry| entry.clear == 0 && entry.mask.is_none())
                && masked <= allowed * (1.0 + 1.0e-9)
                && lie.lights().chain(lie.hidden()).all(counted)
                && key.depth() <= self.settings.max_depth
                && lie.version <= self.version + 1;
            if !holds && broken.is_ok() {
                broken = Err(format!("cell {key:?} breaks an invariant: {lie:?}"));
            }
        });
        broken
    }
}
