use std::path::Path;

use glam::Vec3;
use lie_octree::{LieTree, Mask};
use lie_render::{AovLies, Aovs, CellFacts, FrameSettings, LieLookup, World};
use lie_scene::Camera;

use super::{Constructed, Frame, Render, progress_bar};
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

/// Finds a frame's output variables on rayon's current threads, and writes them with it.
pub(super) fn write(
    path: &Path,
    arguments: &Render,
    world: &World,
    camera: &Camera,
    settings: &FrameSettings,
    constructed: Option<&Constructed>,
    frame: &Frame,
) -> anyhow::Result<()> {
    let lies = constructed.map(|constructed| constructed.replica.publish());
    let facts = |point| constructed.map_or_else(CellFacts::default, |it| of_tree(&it.tree, point));
    let asked = lies.as_ref().map(|lies| AovLies {
        lookup: lies as &dyn LieLookup,
        facts: &facts,
    });
    let bar = progress_bar("aovs", 1000);
    let mut tell = |share: f32| bar.set_position((1000.0 * share) as u64);
    let aovs = Aovs::render(world, asked, camera, settings, &mut tell);
    bar.finish_and_clear();
    lie_render::write_aovs(path, &frame.film, arguments.precision.into(), &aovs)?;
    Ok(())
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
