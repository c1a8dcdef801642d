use lie_accel::RayPacket;
use lie_octree::{LieTree, Proof, Standing};
use lie_render::{Mismatch, World};

/// Takes in what audits found. Every ray is traced again, so that nobody's word counts and what has
/// been learnt since is not unlearnt. Gives how many answers were wrong.
pub(super) fn mend(world: &World, tree: &mut LieTree, found: &[Mismatch]) -> u64 {
    let is_sound = |wrong: &&Mismatch| {
        let ends = [wrong.ray.origin, wrong.ray.at(1.0)];
        let reach = world.reach();
        let is_end = |end: &glam::Vec3| end.distance(wrong.point) <= 1.0e-4 * reach;
        (wrong.light as usize) < world.scene().lights.len()
            && wrong.ray.is_defined()
            && wrong.point.is_finite()
            && ends.iter().any(is_end)
    };
    let mut mended = 0;
    for wrong in found.iter().filter(is_sound) {
        let listed = listed(tree, wrong);
        let packet = RayPacket::new(&[wrong.ray]);
        let blocks = |triangle: &u32| world.blocked_by(*triangle, &packet, &[wrong.ray]) != 0;
        let known = listed.iter().copied().find(blocks);
        let blocker = known.or_else(|| world.accel().blocker(&wrong.ray));
        mended += u64::from(tree.contradict(wrong.point, wrong.light, blocker));
    }
    mended
}

/// What the tree has in a light's way now.
fn listed(tree: &LieTree, wrong: &Mismatch) -> Vec<u32> {
    let lie = tree.lie_at(wrong.point);
    match lie.standing(wrong.light, tree.settings().trust) {
        Standing::Lit(entry) => entry.occluders.iter().map(|own| own.triangle()).collect(),
        Standing::Certain => match lie.region().proof(wrong.light) {
            Some(Proof::Behind(list)) => list.iter().collect(),
            _ => vec![],
        },
        Standing::Hidden | Standing::Crowded | Standing::Doubtful => vec![],
    }
}

#[cfg(test)]
mod tests;
