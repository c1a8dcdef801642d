use glam::Vec3;
use lie_geom::Ray;

use crate::{LieTree, Occluder, Standing};

/// What construction needs to know of the world.
pub trait Visibility: Sync {
    /// Some triangle of the whole scene that blocks a ray.
    fn blocker(&self, ray: &Ray) -> Option<u32>;

    /// Whether this triangle blocks a ray.
    fn blocks(&self, triangle: u32, ray: &Ray) -> bool;
}

/// A ray from a surface point to a random point on a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowRay {
    /// Number of the light.
    pub light: u32,
    /// The segment from the point to the light.
    pub ray: Ray,
    /// What the light would add to the pixel if nothing blocked it, as luminance.
    pub weight: f32,
}

/// One sample of LIE §4.1: what a point sees of the lights that could light it.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// The point.
    pub point: Vec3,
    /// Seen or blocked, for each light that could light the point.
    pub outcomes: Vec<Outcome>,
    /// Luminance of the pixel as the tree stood when it was observed.
    pub predicted: f32,
    /// Luminance of the pixel as it is.
    pub actual: f32,
    /// How many of the lights shaders do not ask the scene for.
    pub trusted: u32,
    /// Rays that had to go through the whole scene.
    pub scene_rays: u32,
}

/// What one shadow ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Number of the light.
    pub light: u32,
    /// What is in the way, if anything.
    pub blocker: Option<u32>,
    /// What the light would give, unoccluded, as a share of what the pixel or a typical
    /// one shows; in `[0, 1]`.
    pub importance: f32,
}

/// Known occluders that are asked before the scene: the first that were found are those
/// that block most.
const ASKED_FIRST: usize = 8;

/// Traces one sample's shadow rays.
///
/// A list grows only where no known occluder blocks the ray, so it stays short. (The paper
/// adds whatever obstructing triangle its ray finds; here as there, only triangles that
/// blocked a ray are in it.) A few known occluders are asked before the scene, the others
/// only if the scene names a blocker that is new.
///
/// Beside what was seen, the observation tells what the tree would have shown: the
/// difference is an unbiased estimate of the picture's error. `typical` is the luminance of
/// a typical pixel, below which differences count less; 0 if that is not known.
#[must_use]
pub fn observe(
    tree: &LieTree,
    point: Vec3,
    rays: &[ShadowRay],
    typical: f32,
    world: &dyn Visibility,
) -> Observation {
    let lie = tree.lie_at(point);
    let trust = tree.settings().trust;
    let mut observation = Observation {
        point,
        outcomes: Vec::with_capacity(rays.len()),
        predicted: 0.0,
        actual: 0.0,
        trusted: 0,
        scene_rays: 0,
    };
    for ShadowRay { light, ray, weight } in rays {
        let list = lie.light(*light).map_or(&[][..], |entry| &entry.occluders);
        let (first, rest) = list.split_at(list.len().min(ASKED_FIRST));
        let among = |list: &[Occluder]| {
            list.iter()
                .map(|occluder| occluder.triangle)
                .find(|&triangle| world.blocks(triangle, ray))
        };
        let mut listed = among(first);
        let mut blocker = listed;
        if listed.is_none() {
            observation.scene_rays += 1;
            blocker = world.blocker(ray);
            if let Some(found) = blocker {
                let is_known = rest.iter().any(|occluder| occluder.triangle == found);
                listed = if is_known { blocker } else { among(rest) };
                blocker = listed.or(blocker);
            }
        }
        let shown = match lie.standing(*light, trust) {
            Standing::Lit(_) => listed.is_none(),
            Standing::Hidden => false,
            // The shader asks the scene, and is right.
            Standing::Doubtful => blocker.is_none(),
        };
        observation.trusted += u32::from(lie.standing(*light, trust) != Standing::Doubtful);
        observation.predicted += if shown { *weight } else { 0.0 };
        observation.actual += if blocker.is_none() { *weight } else { 0.0 };
        observation.outcomes.push(Outcome {
            light: *light,
            blocker,
            importance: *weight,
        });
    }
    let shown = observation.actual + typical;
    for outcome in &mut observation.outcomes {
        // Black beside black: what would give anything would give all.
        let share = if shown > 0.0 {
            outcome.importance / shown
        } else {
            1.0
        };
        outcome.importance = share.clamp(0.0, 1.0);
    }
    observation
}
