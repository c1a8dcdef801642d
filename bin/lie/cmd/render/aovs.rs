use std::path::Path;

use glam::Vec3;
use lie_farm::inspect;
use lie_octree::{LieTree, Mask};
use lie_render::{
    AovLies, Aovs, CellFacts, Film, FrameSettings, LieLookup, RayOdds, World, luminance,
};
use lie_scene::Camera;

use super::{Constructed, progress_bar};
use crate::failure::{Usage, usage};

/// Checks the name before anything is rendered.
pub(super) fn check(path: &Path, out: &Path) -> Result<(), Usage> {
    let ending = path.extension();
    if !ending.is_some_and(|ending| ending.eq_ignore_ascii_case("exr")) {
        let expected = "--aovs expects a name that ends in .exr";
        return Err(usage(format!("{}: {expected}", path.display())));
    }
    if path == out {
        let problem = "--aovs and --out name the same file; --aovs holds the picture as well";
        return Err(usage(format!("{}: {problem}", path.display())));
    }
    Ok(())
}

/// Finds a frame's output variables on rayon's current threads.
pub(super) fn find(
    world: &World,
    camera: &Camera,
    settings: &FrameSettings,
    constructed: Option<&Constructed>,
) -> Aovs {
    let lies = constructed.map(|constructed| constructed.replica.publish());
    let facts = |point| constructed.map_or_else(CellFacts::default, |it| of_tree(&it.tree, point));
    let lights = 0..world.scene().lights.len() as u32;
    let odds = |point, all: &mut Vec<RayOdds>| {
        let Some(tree) = constructed.map(|constructed| &constructed.tree) else {
            return;
        };
        let (lie, trust) = (tree.lie_at(point), tree.settings().trust);
        all.extend(
            lights
                .clone()
                .map(|light| inspect::odds(&lie, light, trust)),
        );
    };
    let asked = lies.as_ref().map(|lies| AovLies {
        lookup: lies as &dyn LieLookup,
        facts: &facts,
        odds: Some(&odds),
    });
    let bar = progress_bar("aovs", 1000);
    let mut tell = |share: f32| bar.set_position((1000.0 * share) as u64);
    let aovs = Aovs::render(world, asked, camera, settings, &mut tell);
    bar.finish_and_clear();
    aovs
}

/// Root mean square of the error to be expected of a frame, by its mean luminance: a relative
/// RMSE. Against a black picture any error is infinitely large, and none is none.
pub(super) fn expected_error(aovs: &Aovs, film: &Film) -> f64 {
    let luminances = film.radiance().iter();
    let sum: f64 = luminances.map(|&value| f64::from(luminance(value))).sum();
    match aovs.expected_rmse() {
        0.0 => 0.0,
        rmse => rmse * film.radiance().len() as f64 / sum,
    }
}

/// What the constructor knows of the cell around a point.
fn of_tree(tree: &LieTree, point: Vec3) -> CellFacts {
    let lie = tree.lie_at(point);
    CellFacts {
        depth: tree.key_at(point).depth(),
        samples: lie.samples(),
        masked: lie
            .lights()
            .filter(|entry| entry.mask == Some(Mask::LeftOut))
            .count() as u32,
    }
}
