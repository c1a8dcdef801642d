mod aim;

use std::ops::Range;

use glam::Vec3;
use lie_geom::{RandomKey, Ray};

use crate::{
    GROUP, Lie, LieTree, LightEvidence, Observation, Occluder, Outcome, PackedLie, Proof,
    ShadowRay, Standing, TriangleSet, Visibility,
};

/// Known occluders that are asked before the scene: the first that were found are those
/// that block most.
pub(crate) const ASKED_FIRST: usize = 8;

/// Known occluders that are asked once the scene has named a new one: a longer list need not
/// be the shortest.
const ASKED_THEN: usize = 32;

/// Observes a handful of neighbouring points together, one light after the other.
///
/// A list grows only where no known occluder blocks the ray, so it stays short. (The paper
/// adds whatever obstructing triangle its ray finds; here as there, only triangles that
/// blocked a ray are in it.) What the points teach is known at once to those that follow in
/// the same cell, though not to the tree.
///
/// Beside what was seen, an observation tells what the tree would have shown: the
/// difference is an unbiased estimate of the picture's error.
pub struct Observer<'a, V: Visibility> {
    world: &'a V,
    tree: &'a LieTree,
    trust: u32,
    typical: f32,
    /// The cells that the points lie in.
    cells: Vec<Lie>,
    /// The same as the tree holds them.
    packed: Vec<&'a PackedLie>,
    /// Each point's cell.
    places: Vec<u32>,
    observations: Vec<Observation>,
    random: RandomKey,
    scratch: Scratch,
}

/// Buffers for one light.
#[derive(Default)]
struct Scratch {
    /// New occluders of each cell.
    found: Vec<Vec<u32>>,
    /// What became of each ray.
    fates: Vec<Fate>,
    /// Rays that no known occluder blocks.
    open: Vec<u32>,
    /// New occluders that nothing has been aimed past yet: cell and triangle.
    fresh: Vec<(usize, u32)>,
    neighbours: Vec<u32>,
    /// For each cell whether some ray from it has reached the light.
    reached: Vec<bool>,
    /// For each cell the rays that start in it.
    sources: Vec<Range<usize>>,
}

/// What became of a ray.
#[derive(Clone, Copy, Default)]
struct Fate {
    blocker: Option<u32>,
    /// Whether the blocker is in the tree's list.
    is_listed: bool,
}

impl<'a, V: Visibility> Observer<'a, V> {
    /// Starts with these points; those in one cell should follow each other. `typical` is
    /// the luminance of a typical pixel, below which differences count less; 0 if that is
    /// not known.
    pub fn new(
        tree: &'a LieTree,
        points: &[Vec3],
        typical: f32,
        random: RandomKey,
        world: &'a V,
    ) -> Self {
        let mut packed: Vec<&PackedLie> = vec![];
        let place = |&point: &Vec3| {
            let leaf = tree.packed_at(point);
            let known = packed.iter().rposition(|other| std::ptr::eq(*other, leaf));
            known.unwrap_or_else(|| {
                packed.push(leaf);
                packed.len() - 1
            }) as u32
        };
        let places = points.iter().map(place).collect();
        let cells: Vec<Lie> = packed.iter().map(|leaf| leaf.unpack()).collect();
        Self {
            world,
            tree,
            trust: tree.settings().trust,
            typical,
            scratch: Scratch {
                found: vec![vec![]; cells.len()],
                sources: vec![0..0; cells.len()],
                reached: vec![false; cells.len()],
                ..Scratch::default()
            },
            cells,
            packed,
            places,
            observations: points.iter().map(|&point| Observation::at(point)).collect(),
            random,
        }
    }

    /// Traces the shadow rays to one light, those of one point together and the points in
    /// their order.
    pub fn light(&mut self, light: u32, rays: &[ShadowRay]) {
        self.scratch.found.iter_mut().for_each(Vec::clear);
        self.scratch.fates.clear();
        self.scratch.fates.resize(rays.len(), Fate::default());
        self.scratch.open.clear();
        self.scratch.sources.fill(0..0);
        for (reached, cell) in self.scratch.reached.iter_mut().zip(&self.cells) {
            *reached = cell.evidence(light).is_some_and(LightEvidence::is_lit);
        }
        let mut start = 0;
        while start < rays.len() {
            let rest = &rays[start..rays.len().min(start + GROUP)];
            let place = self.place(&rest[0]);
            let same = rest.iter().take_while(|ray| self.place(ray) == place);
            let count = same.count();
            if self.is_past_listing(place, light) {
                // Shaders ask the scene, and nothing is left to learn.
                start += count;
                continue;
            }
            self.ask_known(light, start, &rest[..count]);
            let source = &mut self.scratch.sources[place];
            *source = if source.end == start && source.start < start {
                source.start..start + count
            } else {
                start..start + count
            };
            start += count;
            while self.scratch.open.len() >= GROUP {
                self.ask_scene(light, rays);
            }
        }
        while !self.scratch.open.is_empty() {
            self.ask_scene(light, rays);
        }
        self.conclude(light, rays);
        self.aim_past_new(light, rays);
    }

    /// What is certain of how a light reaches a point; `None` if nobody has tried to settle it.
    #[must_use]
    pub fn proof(&self, point: u32, light: u32) -> Option<Proof<&TriangleSet>> {
        let place = self.places[point as usize] as usize;
        self.cells[place].region().proof(light)
    }

    /// Counts for every point the lights that are settled there, and need no rays; and those that
    /// could not be settled and get none, since `passes_over` says so.
    pub fn count_settled(&mut self, passes_over: impl Fn(u32) -> bool) {
        let counts = |cell: &Lie| {
            let (mut settled, mut passed_over) = (0, 0);
            for (light, proof) in cell.region().lights() {
                match proof {
                    Proof::Open => passed_over += u32::from(passes_over(light)),
                    _ => settled += 1,
                }
            }
            (settled, passed_over)
        };
        let counts: Vec<(u32, u32)> = self.cells.iter().map(counts).collect();
        for (seen, place) in self.observations.iter_mut().zip(&self.places) {
            let (settled, passed_over) = counts[*place as usize];
            seen.evaluations += settled + passed_over;
            seen.trusted += settled;
        }
    }

    /// Whether a light could not be settled in some cell, or nobody has tried.
    #[must_use]
    pub fn is_open(&self, light: u32) -> bool {
        let mut cells = self.cells.iter();
        cells.any(|cell| matches!(cell.region().proof(light), None | Some(Proof::Open)))
    }

    /// The observations, in the order of the points.
    #[must_use]
    pub fn finish(mut self) -> Vec<Observation> {
        for seen in &mut self.observations {
            let shown = seen.actual + self.typical;
            for outcome in &mut seen.outcomes {
                // Black beside black: what would give anything would give all.
                let share = if shown > 0.0 {
                    outcome.importance / shown
                } else {
                    1.0
                };
                outcome.importance = share.clamp(0.0, 1.0);
            }
        }
        self.observations
    }

    fn place(&self, ray: &ShadowRay) -> usize {
        self.places[ray.point as usize] as usize
    }

    /// Asks the occluders that are known to block the light in the rays' cell; what they let
    /// through is left open. `start` is the first ray's index.
    fn ask_known(&mut self, light: u32, start: usize, chunk: &[ShadowRay]) {
        let place = self.place(&chunk[0]);
        let listed = listed(&self.cells[place], light);
        let gathered = gather(self.world, chunk.iter());
        let mut open = (1u32 << chunk.len()) - 1;
        let first = listed.iter().take(ASKED_FIRST);
        let found = self.scratch.found[place].iter().take(ASKED_FIRST);
        let known = first
            .map(|occluder| (occluder.triangle(), true))
            .chain(found.map(|&triangle| (triangle, false)));
        for (triangle, is_listed) in known {
            if open == 0 {
                return;
            }
            let blocked = self.world.blocked_by(triangle, &gathered) & open;
            open &= !blocked;
            for lane in lanes(blocked) {
                self.scratch.fates[start + lane] = Fate {
                    blocker: Some(triangle),
                    is_listed,
                };
            }
        }
        let left = lanes(open).map(|lane| (start + lane) as u32);
        self.scratch.open.extend(left);
    }

    /// Asks the scene for the last open rays. A new blocker counts only where no known one
    /// does as well.
    fn ask_scene(&mut self, light: u32, rays: &[ShadowRay]) {
        let rest = self.scratch.open.len().saturating_sub(GROUP);
        let indices = self.scratch.open.split_off(rest);
        let chosen = indices.iter().map(|&index| &rays[index as usize]);
        let gathered = gather(self.world, chosen);
        let blockers = self.world.blockers(&gathered);
        for (&index, blocker) in indices.iter().zip(blockers) {
            let Some(blocker) = blocker else { continue };
            let ray = &rays[index as usize];
            self.scratch.fates[index as usize] = self.credit(light, ray, blocker);
        }
    }

    /// Which triangle a blocked ray is put down to: the one that the scene named, unless one
    /// that was known, or has just been found, blocks it as well.
    fn credit(&mut self, light: u32, ray: &ShadowRay, blocker: u32) -> Fate {
        let place = self.place(ray);
        let listed = listed(&self.cells[place], light);
        let fate = |triangle, is_listed| Fate {
            blocker: Some(triangle),
            is_listed,
        };
        if listed.iter().any(|occluder| occluder.triangle() == blocker) {
            return fate(blocker, true);
        }
        let alone = self.world.gather(&[ray.ray]);
        let blocks = |triangle: u32| self.world.blocked_by(triangle, &alone) != 0;
        let rest = listed.iter().skip(ASKED_FIRST).take(ASKED_THEN);
        if let Some(known) = rest
            .map(|known| known.triangle())
            .find(|&known| blocks(known))
        {
            return fate(known, true);
        }
        let found = &mut self.scratch.found[place];
        let mut asked = found.iter().take(ASKED_THEN);
        if let Some(&known) = asked.find(|&&known| known == blocker || blocks(known)) {
            return fate(known, false);
        }
        if found.contains(&blocker) {
            return fate(blocker, false);
        }
        found.push(blocker);
        self.scratch.fresh.push((place, blocker));
        fate(blocker, false)
    }

    fn is_past_listing(&self, place: usize, light: u32) -> bool {
        let evidence = self.cells[place].evidence(light);
        evidence.is_some_and(LightEvidence::is_past_listing)
    }

    /// Adds what became of the rays to the points' observations.
    fn conclude(&mut self, light: u32, rays: &[ShadowRay]) {
        let mut start = 0;
        for group in rays.chunk_by(|a, b| a.point == b.point) {
            let fates = &self.scratch.fates[start..start + group.len()];
            start += group.len();
            let place = self.places[group[0].point as usize] as usize;
            let standing = self.cells[place].standing(light, self.trust);
            let seen = &mut self.observations[group[0].point as usize];
            seen.evaluations += 1;
            seen.trusted += u32::from(standing != Standing::Doubtful);
            let mut weight = 0.0;
            for (ray, fate) in group.iter().zip(fates) {
                let shown = match standing {
                    Standing::Lit(_) => !fate.is_listed,
                    Standing::Hidden => false,
                    // The shader asks the scene, or has no need to, and is right.
                    Standing::Doubtful | Standing::Crowded | Standing::Certain => {
                        fate.blocker.is_none()
                    }
                };
                weight += ray.weight;
                self.scratch.reached[place] |= fate.blocker.is_none();
                seen.predicted += if shown { ray.weight } else { 0.0 };
                seen.actual += if fate.blocker.is_none() {
                    ray.weight
                } else {
                    0.0
                };
            }
            if !self.cells[place]
                .evidence(light)
                .is_some_and(LightEvidence::is_past_listing)
            {
                count(&mut seen.outcomes, light, group, fates, weight);
            }
        }
    }
}

/// What is known to be in the way of a light.
fn listed(cell: &Lie, light: u32) -> &[Occluder] {
    let evidence = cell.evidence(light);
    evidence.map_or(&[], |evidence| &evidence.occluders)
}

/// Adds one outcome for each different fate.
fn count(
    outcomes: &mut Vec<Outcome>,
    light: u32,
    rays: &[ShadowRay],
    fates: &[Fate],
    importance: f32,
) {
    let first = outcomes.len();
    for (ray, fate) in rays.iter().zip(fates) {
        let (luminance, withheld) = match fate.blocker {
            None => (ray.weight, 0.0),
            Some(_) => (0.0, ray.weight),
        };
        let same = outcomes[first..]
            .iter_mut()
            .find(|outcome| outcome.blocker == fate.blocker);
        match same {
            Some(outcome) => {
                outcome.rays += 1;
                outcome.luminance += luminance;
                outcome.withheld += withheld;
            }
            None => outcomes.push(Outcome {
                blocker: fate.blocker,
                importance,
                luminance,
                withheld,
                beside: ray.beside,
                ..Outcome::of(light)
            }),
        }
    }
}

fn gather<'r, V: Visibility>(world: &V, rays: impl Iterator<Item = &'r ShadowRay>) -> V::Rays {
    let mut group = [Ray::new(Vec3::ZERO, Vec3::X); GROUP];
    let mut len = 0;
    for (place, shadow_ray) in group.iter_mut().zip(rays) {
        *place = shadow_ray.ray;
        len += 1;
    }
    world.gather(&group[..len])
}

/// Indices of the bits that are set.
fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros();
        (mask != 0).then(|| {
            mask &= mask - 1;
            lane as usize
        })
    })
}
