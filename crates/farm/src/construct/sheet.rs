//! Which surface points of a part of a view are worth a sample, and in which order.

use lie_octree::{CellKey, Doubt, LieTree, PackedLie};
use lie_render::World;
use rayon::prelude::*;

use super::{
    Order,
    pass_rays::PassRays,
    place::{Place, places},
    prove::Prover,
    square::Square,
};

/// Surface points of one neighbourhood: those of some whole cells, unless a cell has very many.
#[derive(Debug)]
pub(super) struct Cluster {
    pub(super) places: Vec<Place>,
    /// How much of these pixels' light is in doubt, in steps.
    rank: u32,
}

/// What is left to learn of some squares of a view.
#[derive(Default)]
pub(super) struct Sheet {
    /// What is worth a sample, the most worthwhile last.
    pub(super) clusters: Vec<Cluster>,
    /// The other pixels: without surface, or where nothing is in doubt.
    pub(super) rest: u64,
    /// Evaluations of lights in these, as far as they are known.
    pub(super) evaluated: u64,
    /// How many of them are answered for.
    pub(super) answered: u64,
}

/// What points are weighed by.
#[derive(Clone, Copy)]
pub(super) struct Weighing<'a> {
    pub(super) world: &'a World,
    pub(super) tree: &'a LieTree,
    pub(super) order: Order,
    /// What settles lights without samples; a first pass asks no others that it serves.
    pub(super) prover: Option<&'a Prover>,
}

/// Points that a cluster has at most.
const MOST: usize = 256;

/// Share of a pixel's light that must be in doubt for the pixel to be worth a sample.
const WORTH: f32 = 1.0 / 64.0;

/// Steps that doubt is told apart by.
const RANKS: f32 = 8.0;

impl Sheet {
    /// Looks at some squares: one camera ray for each pixel, and what the tree knows of what it
    /// met. In the paper's mode, and in the order of space, every point is worth a sample.
    pub(super) fn new(weighing: Weighing<'_>, rays: PassRays<'_>, squares: &[Square]) -> Self {
        let squares_in_parallel = squares.par_iter().with_min_len(4);
        let mut places: Vec<Place> = squares_in_parallel
            .flat_map_iter(|&square| places(weighing.world, weighing.tree.cube(), rays, square))
            .collect();
        places.par_sort_by_key(|place| place.code);
        let mut neighbourhoods = vec![];
        divide(&places, 0, &mut neighbourhoods);
        let is_survey = weighing.is_survey(rays);
        let weighed: Vec<(Cluster, [u64; 2])> = neighbourhoods
            .into_par_iter()
            .with_min_len(16)
            .map(|places| weighing.weigh(is_survey, places))
            .collect();
        let pixels: u64 = squares.iter().map(Square::pixels).sum();
        let mut sheet = Self {
            rest: pixels,
            ..Self::default()
        };
        for (cluster, [evaluated, answered]) in weighed {
            sheet.rest -= cluster.places.len() as u64;
            sheet.evaluated += evaluated;
            sheet.answered += answered;
            if !cluster.places.is_empty() {
                sheet.clusters.push(cluster);
            }
        }
        // Stable: what is as much in doubt comes in the order of its place.
        sheet.clusters.reverse();
        sheet.clusters.sort_by_key(|cluster| cluster.rank);
        sheet
    }
}

/// Puts clusters into the order of their places, and joins small neighbours: what is observed
/// together.
pub(super) fn join(mut clusters: Vec<Cluster>) -> Vec<Vec<Place>> {
    clusters.sort_by_key(|cluster| cluster.places[0].code);
    let mut joined: Vec<Vec<Place>> = vec![];
    for Cluster { places, .. } in clusters {
        match joined.last_mut() {
            Some(last) if last.len() + places.len() <= MOST => last.extend(places),
            _ => joined.push(places),
        }
    }
    joined
}

/// Divides points in the order of their codes by the cells around them, until few are left.
fn divide<'p>(places: &'p [Place], depth: u32, found: &mut Vec<&'p [Place]>) {
    if places.len() <= MOST || depth == CellKey::MAX_DEPTH {
        found.extend((!places.is_empty()).then_some(places));
        return;
    }
    let cell = |place: &Place| place.code.raw() >> (3 * (CellKey::MAX_DEPTH - depth - 1));
    for part in places.chunk_by(|a, b| cell(a) == cell(b)) {
        divide(part, depth + 1, found);
    }
}

impl Weighing<'_> {
    /// Whether a pass settles lights by geometry and asks none that it could not settle.
    pub(super) fn is_survey(self, rays: PassRays<'_>) -> bool {
        rays.pass == 0 && self.prover.is_some_and(Prover::serves_any)
    }

    /// Keeps the points where something is in doubt. Of the others, how many evaluations of
    /// lights there are, and how many are answered for.
    fn weigh<'p>(self, is_survey: bool, places: &'p [Place]) -> (Cluster, [u64; 2]) {
        if self.order == Order::Space {
            let places = places.to_vec();
            return (Cluster { places, rank: 0 }, [0; 2]);
        }
        let trust = self.tree.settings().trust;
        let lights = self.world.scene().lights.len() as u32;
        let serves = |light| self.prover.is_some_and(|prover| prover.serves(light));
        let mut kept = Cluster {
            places: Vec::with_capacity(places.len()),
            rank: 0,
        };
        let (mut sum, mut passed_over) = (0.0, [0; 2]);
        let in_cell = |place: &'p Place| (place, self.tree.packed_at(place.origin));
        let placed: Vec<(&Place, &PackedLie)> = places.iter().map(in_cell).collect();
        for part in placed.chunk_by(|a, b| std::ptr::eq(a.1, b.1)) {
            let lie = part[0].1.unpack();
            let known = lie.doubt(trust, lights, |light| !(is_survey && serves(light)));
            for &(place, _) in part {
                // What is known of a cell is known of its region.
                let is_told = trust == 0 || lie.region().bounds.contains(place.origin);
                let doubt = if is_told { known } else { Doubt::WHOLE };
                if trust == 0 || doubt.share >= WORTH {
                    sum += doubt.share;
                    kept.places.push(*place);
                } else {
                    passed_over[0] += u64::from(doubt.evaluated);
                    passed_over[1] += u64::from(doubt.answered);
                }
            }
        }
        let mean = sum / kept.places.len().max(1) as f32;
        kept.rank = (RANKS * mean).ceil() as u32;
        (kept, passed_over)
    }
}

#[cfg(test)]
mod tests;
