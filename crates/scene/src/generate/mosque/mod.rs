//! A hall of columns after the mosque of Córdoba, piece by piece. Metres, y up, the floor at 0;
//! the visitor enters at z = 0 and walks towards −z, along the aisles.
//!
//! Twelve arcades of ten bays part eleven aisles; the outermost two stand against the walls.
//!
//! ```text
//!   ┌───────────mihrab───────────┐ −32
//!   │ o  o  o  o      o  o  o  o │
//!   │ o  o  o  o nave o  o  o  o │      o: a column; arches from one to the next along z
//!   │ o  o  o  o      o  o  o  o │
//!   └───────────door─────────────┘ 0
//! ```

mod arcade;
mod arch;
mod capital;
mod column;
mod hall;
mod lamps;
mod mihrab;
mod palette;
mod paths;
mod portals;

use glam::{Quat, Vec3};
use lie_geom::RandomKey;

use self::palette::Palette;
use super::{Mosque, mesh::Mesh};
use crate::draft::Draft;

/// Bays along an arcade.
const BAYS: u32 = 10;
/// From one column of an arcade to the next.
const BAY: f32 = 3.2;
/// From one arcade to the next, but for the nave.
const AISLE: f32 = 4.4;
/// Half the way between the two arcades of the nave.
const NAVE_HALF: f32 = 2.8;
/// Aisles on each side of the nave.
const SIDE_AISLES: u32 = 5;
/// Where an arcade ends and the roof's beams begin.
const ARCADE_TOP: f32 = 8.3;
/// The underside of the roof's boards.
const CEILING: f32 = 8.95;
/// The inner face of the wall behind the last arcade.
const SIDE_WALL: f32 = NAVE_HALF + SIDE_AISLES as f32 * AISLE + 0.26;
/// The inner faces of the two end walls.
const FRONT_WALL: f32 = 0.3;
const MIHRAB_WALL: f32 = -(BAYS as f32 * BAY) - 0.3;

/// The whole mosque.
pub(crate) fn draft(parameters: &Mosque) -> Draft {
    let mut site = Site::new(parameters);
    site.add_shell();
    site.add_roof();
    site.add_arcades();
    site.add_portals();
    site.add_mihrab();
    site.add_lamps();
    site.add_paths();
    site.draft
}

/// The mosque while it is built.
struct Site {
    draft: Draft,
    palette: Palette,
    key: RandomKey,
    detail: f32,
}

impl Site {
    fn new(parameters: &Mosque) -> Self {
        let mut draft = Draft::default();
        let key = RandomKey::new(parameters.seed);
        let palette = Palette::new(&mut draft, key.mix(1));
        Self {
            draft,
            palette,
            key: key.mix(2),
            detail: parameters.detail.clamp(0.05, Mosque::MAX_DETAIL),
        }
    }

    /// A usual number of segments, at this mosque's detail.
    fn fine(&self, usual: u32) -> u32 {
        ((usual as f32 * self.detail).round() as u32).max(4)
    }

    /// The same for what may be as coarse as one piece.
    fn steps(&self, usual: u32) -> u32 {
        ((usual as f32 * self.detail).round() as u32).max(1)
    }

    fn part(&mut self, name: impl Into<String>, material: u32, mut mesh: Mesh) {
        mesh.drop_slivers();
        mesh.fill_normals();
        mesh.into_part(&mut self.draft, name, material);
    }
}

/// Where the arcades are along x, from one wall to the other.
fn arcade_x() -> impl Iterator<Item = f32> {
    let side = |sign: f32| move |index: u32| sign * (NAVE_HALF + index as f32 * AISLE);
    let left = (0..=SIDE_AISLES).rev().map(side(-1.0));
    left.chain((0..=SIDE_AISLES).map(side(1.0)))
}

/// The middle of each aisle but the nave along x.
fn side_aisle_x() -> impl Iterator<Item = f32> {
    let middle = |index: u32| NAVE_HALF + (index as f32 + 0.5) * AISLE;
    let left = (0..SIDE_AISLES).rev().map(move |index| -middle(index));
    left.chain((0..SIDE_AISLES).map(middle))
}

/// Adds a mesh moved, not turned.
fn place(mesh: &mut Mesh, piece: &Mesh, at: Vec3) {
    mesh.add(piece, Quat::IDENTITY, at);
}

/// A box about a vertical axis: half sizes along x and z, from one height to another.
fn slab(mesh: &mut Mesh, center: Vec3, half: [f32; 2], up: [f32; 2]) {
    let reach = |y: f32, sign: f32| center + Vec3::new(sign * half[0], y, sign * half[1]);
    mesh.cuboid(reach(up[0], -1.0), reach(up[1], 1.0));
}

#[cfg(test)]
mod tests;
