//! A science centre: three storeys of balconies round an atrium, and one light, a flat skylight
//! that leans over the atrium's front. Metres, y up, the floor at 0; the skylight is at +z, the
//! entrance below the balconies at −z.
//!
//! ```text
//!    ┌──────────────────────────╲            12.6
//!    ╞═══ gallery                 ╲ skylight  8.4
//!    ╞══════ balcony                │         4.2
//!    └── entrance ─ stairs ─────────┘         0
//!   z −15       −9.5      0        13
//! ```
//!
//! What stands in the light is made of few large faces, so that each point's way to it is past
//! a handful of triangles; most of them are in floors and walls, where they shade nothing.

mod exhibits;
mod furniture;
mod palette;
mod paths;
mod planting;
mod railings;
mod roof;
mod shell;
mod stairs;
mod tiling;

use glam::Vec3;
use lie_geom::RandomKey;

use self::palette::Palette;
use super::{ScienceCenter, mesh::Mesh};
use crate::draft::Draft;

/// Inner faces of the walls.
const SIDE: f32 = 11.0;
const BACK: f32 = -15.0;
const FRONT: f32 = 13.0;
/// Heights of the two upper floors and of the ceiling over them.
const BALCONY: f32 = 4.2;
const GALLERY: f32 = 8.4;
const CEILING: f32 = 12.6;
/// How thick the walls are.
const WALL: f32 = 0.3;
/// How thick the upper floors are.
const SLAB: f32 = 0.4;
/// Where the balcony ends: half its opening's width, and its edge at the back.
const BALCONY_EDGE: [f32; 2] = [6.0, -9.5];
/// The same of the gallery above, which stands back.
const GALLERY_EDGE: [f32; 2] = [7.4, -11.0];

/// The whole science centre.
pub(crate) fn draft(parameters: &ScienceCenter) -> Draft {
    let mut site = Site::new(parameters);
    site.add_shell();
    site.add_roof();
    site.add_daylight();
    site.add_columns();
    site.add_stairs();
    site.add_railings();
    site.add_exhibits();
    site.add_furniture();
    site.add_planting();
    site.add_paths();
    site.draft
}

/// The science centre while it is built.
struct Site {
    draft: Draft,
    palette: Palette,
    key: RandomKey,
    detail: f32,
}

impl Site {
    fn new(parameters: &ScienceCenter) -> Self {
        let mut draft = Draft::default();
        let key = RandomKey::new(parameters.seed);
        let palette = Palette::new(&mut draft, key.mix(1));
        Self {
            draft,
            palette,
            key: key.mix(2),
            detail: parameters.detail.clamp(0.05, super::MAX_DETAIL),
        }
    }

    /// A usual number of segments, at this building's detail.
    fn fine(&self, usual: u32) -> u32 {
        ((usual as f32 * self.detail).round() as u32).max(3)
    }

    fn part(&mut self, name: impl Into<String>, material: u32, mut mesh: Mesh) {
        mesh.drop_slivers();
        mesh.fill_normals();
        mesh.into_part(&mut self.draft, name, material);
    }
}

/// A box from the least to the greatest of two corners.
fn cuboid(mesh: &mut Mesh, a: [f32; 3], b: [f32; 3]) {
    let (a, b) = (Vec3::from(a), Vec3::from(b));
    mesh.cuboid(a.min(b), a.max(b));
}

#[cfg(test)]
mod tests;
