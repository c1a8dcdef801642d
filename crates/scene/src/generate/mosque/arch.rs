//! Arches of wedge-shaped stones, light and red by turns, and the wall above an arch. An arch
//! spans along z, with its middle at z = 0.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::place;
use crate::generate::{mesh::Mesh, shapes::sweep};

/// A ring of stones about a centre.
#[derive(Clone, Copy)]
pub(super) struct Arch {
    /// Height of the centre.
    pub(super) center: f32,
    /// Radius of the opening.
    pub(super) inner: f32,
    /// Radius of the ring's outside.
    pub(super) outer: f32,
    /// Half the depth through the wall.
    pub(super) half_depth: f32,
    /// How far the ring goes on below its centre, in radians: more than 0 is a horseshoe.
    pub(super) below: f32,
    /// An odd number, so that both feet are alike.
    pub(super) stones: u32,
}

/// How much the red stones stand back.
const RECESS: f32 = 0.012;

impl Arch {
    /// The light stones and the red ones.
    pub(super) fn stones(&self, steps: u32) -> [Mesh; 2] {
        let mut meshes = [Mesh::default(), Mesh::default()];
        for stone in 0..self.stones {
            let is_red = stone % 2 == 1;
            let piece = self.stone(stone, if is_red { RECESS } else { 0.0 }, steps);
            place(&mut meshes[usize::from(is_red)], &piece, Vec3::ZERO);
        }
        meshes
    }

    /// One stone; with a single step it keeps its edges, else they are taken off.
    fn stone(&self, index: u32, recess: f32, steps: u32) -> Mesh {
        const CHAMFER: f32 = 0.018;
        let (half, inner, outer) = (
            self.half_depth - recess,
            self.inner + recess,
            self.outer - recess,
        );
        // Radius against depth.
        let mut profile = Vec::with_capacity(8);
        for (depth, radius) in [(1.0, inner), (1.0, outer), (-1.0, outer), (-1.0, inner)] {
            let inwards = if radius == inner { CHAMFER } else { -CHAMFER };
            let on_face = Vec2::new(-depth * half, radius + inwards);
            let on_ring = Vec2::new(-depth * (half - CHAMFER), radius);
            match (steps, (depth > 0.0) == (radius == outer)) {
                (1, _) => profile.push(Vec2::new(-depth * half, radius)),
                (_, true) => profile.extend([on_face, on_ring]),
                (_, false) => profile.extend([on_ring, on_face]),
            }
        }
        let span = (PI + 2.0 * self.below) / self.stones as f32;
        let start = index as f32 * span - self.below;
        sweep(&profile, steps, |t, p| {
            let (sin, cos) = (start + t * span).sin_cos();
            Vec3::new(-p.x, self.center + p.y * sin, p.y * cos)
        })
    }

    /// The two faces of the wall above the arch: `half_width` to each side, up to `top`. Its
    /// lower edge, at `radius`, hides in the ring.
    pub(super) fn spandrel(
        &self,
        half_width: f32,
        top: f32,
        half_depth: f32,
        radius: f32,
        steps: u32,
    ) -> Mesh {
        let mut outline = vec![Vec2::new(half_width, self.center)];
        outline.extend((0..=steps).map(|step| {
            let (sin, cos) = (step as f32 / steps as f32 * PI).sin_cos();
            Vec2::new(radius * cos, self.center + radius * sin)
        }));
        outline.push(Vec2::new(-half_width, self.center));
        let mut mesh = Mesh::default();
        for pair in outline.windows(2) {
            for side in [1.0, -1.0] {
                let at = |point: Vec2, y: f32| Vec3::new(side * half_depth, y, point.x);
                let (mut a, mut b) = (pair[0], pair[1]);
                if side < 0.0 {
                    (a, b) = (b, a);
                }
                mesh.quadrangle([at(a, a.y), at(b, b.y), at(b, top), at(a, top)]);
            }
        }
        mesh
    }
}
