//! What can be settled about a cell's lights without samples.

use std::sync::Arc;

use glam::Vec3;
use lie_accel::{MeshEdges, Shaft};
use lie_geom::{Aabb, Ray};
use lie_octree::{Lie, Proof, Region};
use lie_render::World;
use lie_scene::Light;

use super::{
    point::Point,
    shafts::{LightShaft, Shafts, Target},
};

/// Settles lights by geometry alone, wherever nothing is in the way of a cell, or few enough
/// triangles to list; or everything, if the light is a point or a spot.
pub(super) struct Prover {
    edges: MeshEdges,
    shafts: Arc<Shafts>,
    /// Triangles that a list can have.
    longest: usize,
}

/// Triangles that a list of all that may be in the way can have at most. A longer one costs as much as
/// asking the scene, and samples find a shorter one.
const LONGEST: usize = 128;

/// The same of lights that have an extent: their shafts are wide, and most of what is in them
/// blocks little. Samples find shorter lists.
const LONGEST_TO_AREA: usize = 4;

/// Triangles that a proof of a hidden light may take.
const COVER: usize = 128;

/// Surfaces that are tried to hide a light, beside the first.
const STARTS: usize = 4;

impl Prover {
    /// Makes ready for a scene: finds the neighbours of its triangles. No list gets longer than
    /// `crowd`.
    pub(super) fn new(world: &World, shafts: Arc<Shafts>, crowd: u32) -> Self {
        let edges = if shafts.has_places() {
            MeshEdges::new(world.scene().geometry.shapes())
        } else {
            MeshEdges::default()
        };
        Self {
            edges,
            shafts,
            longest: LONGEST.min(crowd as usize),
        }
    }

    /// The region that takes in these points as well, and what is certain there; `None` if that is
    /// what is known already. `cell` is the cell's box; `above` is what is certain of a cell
    /// around it.
    pub(super) fn settle(
        &self,
        world: &World,
        lie: &Lie,
        above: Option<&Region>,
        cell: Aabb,
        points: &[&Point],
    ) -> Option<Region> {
        let known = lie.region();
        let facing = Facing::new(points);
        let holds = contains(&known.bounds, &facing.bounds);
        let bounds = if holds {
            known.bounds
        } else {
            widened(known.bounds.union(facing.bounds), cell)
        };
        let above = above.filter(|above| contains(&above.bounds, &bounds));
        let mut is_news = !holds;
        let mut lights = vec![];
        for (light, form) in (0..).zip(&world.scene().lights) {
            let target = self.shafts.target(light);
            let before = known.proof(light);
            if before.is_none() && !facing.is_reached(form, target) {
                continue;
            }
            // Of a light that has an extent nothing is kept that is not certain.
            if before.is_none() && holds && !self.serves(light) {
                continue;
            }
            let proof = match (before, above.and_then(|above| above.proof(light))) {
                (Some(before), _) if holds => before.cloned(),
                // What holds of the whole holds of its parts.
                (_, Some(proof @ (Proof::Unoccluded | Proof::Hidden))) => proof.cloned(),
                _ => {
                    is_news = true;
                    self.prove(world, light, bounds)
                }
            };
            if proof != Proof::Open || self.serves(light) {
                lights.push((light, proof));
            }
        }
        is_news.then(|| Region::new(bounds, lights))
    }

    /// Whether a light is one that cells are told of whenever it may reach them.
    pub(super) fn serves(&self, light: u32) -> bool {
        matches!(self.shafts.target(light), Target::Place(_))
    }

    /// Whether there is any such light.
    pub(super) fn serves_any(&self) -> bool {
        self.shafts.has_places()
    }

    /// What is certain between a light and a box.
    fn prove(&self, world: &World, light: u32, ends: Aabb) -> Proof {
        let target = self.shafts.target(light);
        let shaft = self.shafts.to(target, ends);
        let own = self.shafts.own(light);
        let mut found = vec![];
        match (target, &shaft) {
            (Target::Place(place), LightShaft::Place(shaft)) => {
                self.prove_point(world, place, shaft, ends)
            }
            _ => {
                let longest = match target {
                    Target::Box(_) => self.longest.min(LONGEST_TO_AREA),
                    _ => self.longest,
                };
                let is_all = shaft.inside(world, longest + own.len(), &mut found);
                found.retain(|triangle| !own.contains(triangle));
                if is_all { listed(found) } else { Proof::Open }
            }
        }
    }

    /// What is certain between a place and a box, with the shaft between them.
    fn prove_point(&self, world: &World, place: Vec3, shaft: &Shaft, ends: Aabb) -> Proof {
        let scene = world.scene();
        let through = Ray::segment_from(place, ends.center());
        let shapes = scene.geometry.shapes();
        let is_solid = |triangle| !world.has_holes(triangle);
        let covers = |start| shaft.is_covered(start, shapes, &self.edges, is_solid, COVER);
        let blocker = world.accel().blocker(&through);
        if blocker.is_some_and(covers) {
            return Proof::Hidden;
        }
        let mut found = vec![];
        let is_all = world.accel().inside(shaft, self.longest, &mut found);
        if let Some(blocker) = blocker {
            // Another surface on the way may cover what this one does not.
            let others = found.iter().copied().filter(|&other| {
                other != blocker && shapes[other as usize].intersect(&through).is_some()
            });
            if others.take(STARTS).any(covers) {
                return Proof::Hidden;
            }
        }
        if !is_all {
            return Proof::Open;
        }
        listed(found)
    }
}

/// Nothing but these triangles is in the way.
fn listed(found: Vec<u32>) -> Proof {
    if found.is_empty() {
        return Proof::Unoccluded;
    }
    Proof::Behind(found.into())
}

fn contains(outer: &Aabb, inner: &Aabb) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

/// Somewhat more than what was seen, so that the next points close by are inside: all of the cell
/// along an axis that the surface runs along.
fn widened(seen: Aabb, cell: Aabb) -> Aabb {
    let (mut min, mut max) = (seen.min, seen.max);
    let sides = cell.size();
    for axis in 0..3 {
        let extent = seen.max[axis] - seen.min[axis];
        if extent > 0.25 * sides[axis] {
            min[axis] = min[axis].min(cell.min[axis]);
            max[axis] = max[axis].max(cell.max[axis]);
        } else {
            min[axis] -= 0.1 * extent;
            max[axis] += 0.1 * extent;
        }
    }
    Aabb { min, max }
}

/// Points of a cell, as far as it matters which lights reach them if nothing is in between.
struct Facing {
    /// Where their shadow rays start.
    bounds: Aabb,
    /// Each normal that occurs, and the least distance along it that a point has.
    sides: Vec<(Vec3, f32)>,
}

impl Facing {
    fn new(points: &[&Point]) -> Self {
        let mut sides: Vec<(Vec3, f32)> = vec![];
        for point in points {
            let normal = point.surface.geometric_normal;
            let along = normal.dot(point.surface.position);
            // Neighbours mostly share a triangle.
            match sides.iter_mut().rfind(|side| side.0 == normal) {
                Some(side) => side.1 = side.1.min(along),
                None => sides.push((normal, along)),
            }
        }
        Self {
            bounds: Aabb::around(points.iter().map(|point| point.surface.shadow_origin)),
            sides,
        }
    }

    /// Whether a light at a place may reach any of the points; in doubt it does.
    fn is_reached(&self, light: &Light, target: Target) -> bool {
        let faces = |&(normal, least): &(Vec3, f32)| most_along(normal, target, least) > 0.0;
        self.sides.iter().any(faces) && light.may_reach(self.bounds)
    }
}

/// By how much a light's targets are at most in front of a plane with this normal and offset, with
/// some room.
fn most_along(normal: Vec3, target: Target, offset: f32) -> f32 {
    let room = |place: Vec3| 1.0e-5 * (1.0 + place.abs().max_element());
    match target {
        Target::Place(place) => normal.dot(place) - offset + room(place),
        Target::Box(bounds) => {
            let (center, half) = (bounds.center(), 0.5 * bounds.size());
            normal.dot(center) + normal.abs().dot(half) - offset + room(bounds.max.max(-bounds.min))
        }
        Target::Away(way) => normal.dot(way) + room(way),
    }
}
