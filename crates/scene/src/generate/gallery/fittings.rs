//! Pictures, columns, benches: what stands in more than one room.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};
use lie_geom::RandomKey;

use super::{Site, palette::painting};
use crate::{
    Material, TextureRef,
    generate::{
        bitmaps::add_texture,
        frame::frame,
        mesh::Mesh,
        shapes::{lathe, parametric},
    },
};

/// Where a picture hangs.
pub(super) struct Hanging {
    /// Middle of the canvas, on the wall.
    pub(super) center: Vec3,
    /// Unit vector out of the wall.
    pub(super) normal: Vec3,
    /// Width and height of the canvas.
    pub(super) size: Vec2,
}

impl Site {
    /// A painting with a bevelled gilt frame, and a spot for it on the ceiling.
    pub(super) fn add_picture(
        &mut self,
        number: u32,
        hanging: &Hanging,
        ceiling: f32,
        intensity: f32,
    ) {
        let Hanging {
            center,
            normal,
            size,
        } = *hanging;
        let side = Vec3::Y.cross(normal);
        let height_px = (128.0 * size.y / size.x).round().clamp(32.0, 256.0) as u32;
        let canvas = painting(
            RandomKey::new(self.seed).mix(1000 + u64::from(number)),
            128,
            height_px,
        );
        let texture = add_texture(&mut self.draft, canvas);
        let material = self.draft.add_material(Material {
            base_color_texture: Some(TextureRef::plain(texture)),
            ..Material::diffuse(format!("painting {number}"), Vec3::ONE)
        });
        let (right, up) = (size.x * side, size.y * Vec3::Y);
        let mut mesh = Mesh::default();
        let upper_left = center + 0.03 * normal - 0.5 * right + 0.5 * up;
        // The image's first row is on top.
        let lower_left = upper_left - up;
        mesh.textured_quad(lower_left, right, up, Vec2::ONE);
        for vertex in &mut mesh.vertices {
            vertex.uv.y = 1.0 - vertex.uv.y;
        }
        self.part(format!("painting {number}"), material, mesh);
        let frame = frame(center, [side, Vec3::Y, normal], 0.5 * size);
        self.part(format!("frame {number}"), self.palette.gold, frame);

        let lamp = Vec3::new(center.x, ceiling - 0.28, center.z) + 1.35 * normal;
        let half_angle = (0.62 * size.length() / (lamp - center).length())
            .atan()
            .to_degrees();
        self.add_spot(
            &format!("picture spot {number}"),
            lamp,
            center + 0.03 * normal,
            intensity * super::NEUTRAL,
            [0.72 * half_angle, half_angle + 5.0],
            lamp + 0.28 * Vec3::Y - 0.02 * normal,
        );
    }

    /// A bench with a padded seat, `length` along `along`.
    pub(super) fn add_bench(&mut self, name: &str, center: Vec3, along: Vec3, length: f32) {
        let across = along.cross(Vec3::Y);
        let block = |mesh: &mut Mesh, at: [f32; 2], size: [f32; 2], up: [f32; 2]| {
            let corner =
                center + (at[0] - 0.5 * size[0]) * along + (at[1] - 0.5 * size[1]) * across;
            mesh.block(
                corner + up[0] * Vec3::Y,
                size[0] * along,
                (up[1] - up[0]) * Vec3::Y,
                size[1] * across,
            );
        };
        let mut seat = Mesh::default();
        let cushions = (length / 0.6).round().max(1.0);
        for index in 0..cushions as u32 {
            let at = (index as f32 + 0.5) / cushions * length - 0.5 * length;
            block(
                &mut seat,
                [at, 0.0],
                [length / cushions - 0.015, 0.46],
                [0.40, 0.47],
            );
        }
        self.part(format!("{name} seat"), self.palette.leather, seat);
        let mut frame = Mesh::default();
        block(&mut frame, [0.0, 0.0], [length, 0.48], [0.35, 0.40]);
        for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            block(
                &mut frame,
                [x * (0.5 * length - 0.08), z * 0.19],
                [0.05, 0.05],
                [0.0, 0.35],
            );
        }
        self.part(format!("{name} frame"), self.palette.wood, frame);
    }

    /// A fluted column with base and capital, from the floor to `height`.
    pub(super) fn add_column(&mut self, name: &str, foot: Vec3, height: f32) {
        let (radius, flutes) = (0.27, 20.0);
        let mut mesh = Mesh::default();
        let turned = |radius: f32, up: f32| Vec2::new(radius, up);
        let base = [
            turned(0.36, 0.12),
            turned(0.375, 0.15),
            turned(0.38, 0.18),
            turned(0.37, 0.21),
            turned(0.33, 0.23),
            turned(0.32, 0.26),
            turned(0.335, 0.29),
            turned(0.33, 0.32),
            turned(0.285, 0.34),
            turned(0.0, 0.34),
        ];
        let segments = self.fine(40);
        mesh.add(&lathe(&base, segments), Quat::IDENTITY, foot);
        let top = height - 0.34;
        let capital = [
            turned(0.0, top),
            turned(0.26, top),
            turned(0.28, top + 0.02),
            turned(0.26, top + 0.05),
            turned(0.27, top + 0.08),
            turned(0.33, top + 0.14),
            turned(0.37, top + 0.20),
            turned(0.0, top + 0.20),
        ];
        mesh.add(&lathe(&capital, segments), Quat::IDENTITY, foot);
        let shaft = parametric([self.fine(120), self.fine(10)], |u, v| {
            let angle = u * TAU;
            // Thinner towards the top, with a slight swelling on the way.
            let swell = radius * (1.0 - 0.14 * v * v);
            let flute = 1.0 - 0.055 * (0.5 * angle * flutes).sin().abs();
            let (sin, cos) = angle.sin_cos();
            Vec3::new(
                swell * flute * cos,
                0.34 + v * (top - 0.34),
                -swell * flute * sin,
            )
        });
        mesh.add(&shaft, Quat::IDENTITY, foot);
        mesh.cuboid(
            foot + Vec3::new(-0.4, 0.0, -0.4),
            foot + Vec3::new(0.4, 0.12, 0.4),
        );
        let abacus = height - 0.14;
        mesh.cuboid(
            foot + Vec3::new(-0.4, abacus, -0.4),
            foot + Vec3::new(0.4, height, 0.4),
        );
        self.part(name, self.palette.limestone, mesh);
    }

    /// A vase; `shape` picks one of a few outlines.
    pub(super) fn add_vase(&mut self, name: &str, foot: Vec3, shape: u32, material: u32) {
        let outlines: [&[[f32; 2]]; 3] = [
            &[
                [0.0, 0.0],
                [0.08, 0.0],
                [0.09, 0.02],
                [0.15, 0.12],
                [0.18, 0.24],
                [0.16, 0.36],
                [0.09, 0.46],
                [0.06, 0.52],
                [0.065, 0.58],
                [0.09, 0.62],
                [0.08, 0.62],
                [0.05, 0.57],
                [0.045, 0.5],
            ],
            &[
                [0.0, 0.0],
                [0.10, 0.0],
                [0.10, 0.03],
                [0.06, 0.07],
                [0.10, 0.14],
                [0.19, 0.24],
                [0.21, 0.32],
                [0.19, 0.38],
                [0.18, 0.38],
                [0.19, 0.32],
                [0.1, 0.2],
            ],
            &[
                [0.0, 0.0],
                [0.09, 0.0],
                [0.13, 0.06],
                [0.15, 0.2],
                [0.12, 0.33],
                [0.06, 0.40],
                [0.045, 0.55],
                [0.05, 0.66],
                [0.07, 0.70],
                [0.06, 0.70],
                [0.035, 0.64],
            ],
        ];
        let profile: Vec<Vec2> = outlines[shape as usize % 3]
            .iter()
            .map(|&p| Vec2::from(p))
            .collect();
        let vase = lathe(&profile, self.fine(36));
        self.put(name, material, &vase, foot);
    }
}
