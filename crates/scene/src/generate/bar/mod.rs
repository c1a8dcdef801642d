//! The bar, thing by thing. Metres, y up, the floor at 0; −z is the wall with the bottles.
//!
//! ```text
//!      −7                                      7
//!       ┌──────────────────────────────────────┐ −4.5
//!       │ barrels  shelves and bottles │       │
//!       │      ┌───────────────────────┤  high │
//!       │      │        counter        │ tables│
//!       │      └───────────────────────┘       │
//!       │ ┌─┐    o  o  o stools o  o           │
//!       │ │ │ piano                         door
//!       │ └─┘     tables and chairs            │
//!       │   bench with tables                  │
//!       └──────────────────────────────────────┘ 4.5
//! ```

mod back_bar;
mod counter;
mod decor;
mod joinery;
mod lamps;
mod model;
mod palette;
mod paths;
mod room;
mod seats;
mod tables;
mod vessels;

use glam::{Quat, Vec3};
use lie_geom::RandomKey;

use self::{model::Model, palette::Palette};
use super::{Bar, mesh::Mesh};
use crate::draft::Draft;

/// Inside of the room: half its length and half its depth, and its height.
const HALF: [f32; 2] = [7.0, 4.5];
const HEIGHT: f32 = 3.6;
/// Middles of the fans, on the floor below them.
const FANS: [Vec3; 2] = [Vec3::new(-3.0, 0.0, 0.75), Vec3::new(3.0, 0.0, 0.75)];

/// The whole bar.
pub(crate) fn draft(parameters: &Bar) -> Draft {
    let mut site = Site::new(parameters);
    site.add_room();
    site.add_back_bar();
    site.add_counter();
    site.add_tables();
    site.add_bench();
    site.add_decor();
    site.add_lamps();
    site.add_paths();
    site.draft
}

/// The bar while it is built.
struct Site {
    draft: Draft,
    palette: Palette,
    key: RandomKey,
    detail: f32,
}

impl Site {
    fn new(parameters: &Bar) -> Self {
        let mut draft = Draft::default();
        let key = RandomKey::new(parameters.seed);
        let palette = Palette::new(&mut draft, key.mix(1));
        Self {
            draft,
            palette,
            key,
            detail: parameters.detail.clamp(0.05, super::MAX_DETAIL),
        }
    }

    /// A usual number of segments, at this bar's detail.
    fn fine(&self, usual: u32) -> u32 {
        ((usual as f32 * self.detail).round() as u32).max(4)
    }

    /// A usual number of pieces between the knots of a profile.
    fn steps(&self, usual: u32) -> u32 {
        ((usual as f32 * self.detail).round() as u32).max(1)
    }

    fn part(&mut self, name: impl Into<String>, material: u32, mut mesh: Mesh) {
        drop_degenerate(&mut mesh);
        mesh.into_part(&mut self.draft, name, material);
    }

    /// Puts a model where it stands in the room, as a part for each material.
    fn put(&mut self, name: &str, model: Model) {
        for (material, mesh) in model.into_meshes() {
            self.part(name, material, mesh);
        }
    }
}

/// A turn about the upright axis.
fn turn(radians: f32) -> Quat {
    Quat::from_rotation_y(radians)
}

/// Takes out triangles without area, such as a lathe makes at its axis.
fn drop_degenerate(mesh: &mut Mesh) {
    let Mesh {
        vertices,
        triangles,
    } = mesh;
    triangles.retain(|triangle| {
        let [a, b, c] = triangle.map(|index| vertices[index as usize].position);
        let longest = [b - a, c - b, a - c]
            .map(Vec3::length_squared)
            .into_iter()
            .fold(0.0, f32::max);
        (b - a).cross(c - a).length() > 1.0e-5 * longest
    });
}

#[cfg(test)]
mod tests;
