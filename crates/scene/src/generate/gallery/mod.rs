//! The gallery, room by room. Metres, y up, the floor at 0; the visitor enters at +z and
//! walks towards −z.
//!
//! ```text
//!            ┌───────────────────────────┐ −18
//!            │      sculpture court      │
//!        ┌───┴──────┐  ┌─┐  ┌────────────┴ −8.3
//!        │ west     door│ │door     east  │
//!        │ gallery      │c│       gallery │
//!        └──────────┐ ┌─┘o└─┐ ┌──────────┘ −1
//!                   │ entrance│             0
//!                   │   hall  │
//!                   └─────────┘             7
//! ```

mod court;
mod fittings;
mod galleries;
mod hall;
mod lamps;
mod palette;
mod paths;
mod walls;

use glam::{Quat, Vec3};

use self::palette::Palette;
use super::{Gallery, mesh::Mesh};
use crate::{Light, LightKind, Material, draft::Draft};

/// The whole gallery.
pub(crate) fn draft(parameters: &Gallery) -> Draft {
    let mut site = Site::new(parameters);
    site.add_hall();
    site.add_corridor();
    site.add_galleries();
    site.add_court();
    site.add_paths();
    site.draft
}

/// The gallery while it is built.
struct Site {
    draft: Draft,
    palette: Palette,
    seed: u64,
    detail: f32,
}

impl Site {
    fn new(parameters: &Gallery) -> Self {
        let mut draft = Draft::default();
        let palette = Palette::new(&mut draft, parameters.seed);
        Self {
            draft,
            palette,
            seed: parameters.seed,
            detail: parameters.detail.clamp(0.05, super::MAX_DETAIL),
        }
    }

    /// A usual number of segments, at this gallery's detail.
    fn fine(&self, usual: u32) -> u32 {
        ((usual as f32 * self.detail).round() as u32).max(4)
    }

    fn part(&mut self, name: impl Into<String>, material: u32, mesh: Mesh) {
        mesh.into_part(&mut self.draft, name, material);
    }

    fn put(&mut self, name: impl Into<String>, material: u32, mesh: &Mesh, at: Vec3) {
        let mut moved = Mesh::default();
        moved.add(mesh, Quat::IDENTITY, at);
        self.part(name, material, moved);
    }

    fn point(&mut self, name: impl Into<String>, position: Vec3, radiant_intensity: Vec3) {
        self.draft.lights.push(Light {
            name: name.into(),
            kind: LightKind::Point {
                position,
                radiant_intensity,
            },
        });
    }

    /// A rectangle that shines along `edge_u × edge_v`, as a surface of its own.
    fn panel(&mut self, name: &str, corner: Vec3, edge_u: Vec3, edge_v: Vec3, radiance: Vec3) {
        let material = self.draft.add_material(Material {
            emission: radiance,
            ..Material::diffuse(name, Vec3::splat(0.8))
        });
        let mut mesh = Mesh::default();
        mesh.quad(corner, edge_u, edge_v);
        self.part(name, material, mesh);
    }
}

/// Lamp colours: relative to white, at equal luminance or so.
const WARM: Vec3 = Vec3::new(1.25, 0.95, 0.62);
const NEUTRAL: Vec3 = Vec3::new(1.1, 0.98, 0.84);
const COOL: Vec3 = Vec3::new(0.93, 1.0, 1.1);

#[cfg(test)]
mod tests;
