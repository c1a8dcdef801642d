//! Lamps: each is a light and the thing it sits in, clear of each other.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec2, Vec3};

use super::Site;
use crate::{
    Light, LightKind, Material,
    generate::{
        mesh::Mesh,
        shapes::{lathe, parametric, rod, sphere, torus},
    },
};

/// Distance from a spot's light to its housing, so that the two never touch.
const CLEARANCE: f32 = 0.02;

impl Site {
    /// A lamp on a cable, its shade open above and below, with the light in the middle.
    pub(super) fn add_pendant(
        &mut self,
        name: &str,
        position: Vec3,
        ceiling: f32,
        intensity: Vec3,
    ) {
        let shade = lathe(
            &[
                Vec2::new(0.29, -0.07),
                Vec2::new(0.295, -0.07),
                Vec2::new(0.25, 0.02),
                Vec2::new(0.20, 0.10),
                Vec2::new(0.195, 0.10),
                Vec2::new(0.243, 0.02),
                Vec2::new(0.29, -0.07),
            ],
            self.fine(40),
        );
        self.put(
            format!("{name} shade"),
            self.palette.brass,
            &shade,
            position,
        );
        let mut iron = Mesh::default();
        let cable = rod(
            Vec3::new(0.0, 0.16, 0.0),
            (ceiling - position.y) * Vec3::Y,
            0.008,
            8,
        );
        iron.add(&cable, Quat::IDENTITY, position);
        let canopy = rod(Vec3::ZERO, 0.03 * Vec3::Y, 0.06, self.fine(20));
        iron.add(
            &canopy,
            Quat::IDENTITY,
            Vec3::new(position.x, ceiling - 0.03, position.z),
        );
        for spoke in 0..3 {
            let (sin, cos) = (spoke as f32 / 3.0 * TAU).sin_cos();
            let arm = rod(
                0.16 * Vec3::Y,
                Vec3::new(0.197 * cos, 0.1, 0.197 * sin),
                0.004,
                6,
            );
            iron.add(&arm, Quat::IDENTITY, position);
        }
        self.part(format!("{name} cable"), self.palette.black, iron);
        self.point(name, position, intensity);
    }

    /// A lamp within a drum of slats: it throws rays of light and shadow all round.
    pub(super) fn add_lantern(
        &mut self,
        name: &str,
        position: Vec3,
        ceiling: f32,
        intensity: Vec3,
    ) {
        const SLATS: u32 = 14;
        let mut brass = Mesh::default();
        for slat in 0..SLATS {
            let (sin, cos) = (slat as f32 / SLATS as f32 * TAU).sin_cos();
            let (out, side) = (Vec3::new(cos, 0.0, sin), Vec3::new(-sin, 0.0, cos));
            let corner = position + 0.22 * out - 0.012 * side - 0.2 * Vec3::Y;
            brass.block(corner, 0.024 * side, 0.4 * Vec3::Y, 0.006 * out);
        }
        for height in [-0.2, 0.2] {
            let ring = torus(0.223, 0.014, [self.fine(40), self.fine(10)]);
            brass.add(&ring, Quat::IDENTITY, position + height * Vec3::Y);
        }
        for spoke in 0..3 {
            let (sin, cos) = (spoke as f32 / 3.0 * TAU).sin_cos();
            let arm = rod(
                0.42 * Vec3::Y,
                Vec3::new(0.22 * cos, 0.2, 0.22 * sin),
                0.006,
                6,
            );
            brass.add(&arm, Quat::IDENTITY, position);
        }
        self.part(format!("{name} drum"), self.palette.brass, brass);
        let mut iron = Mesh::default();
        let cable = rod(0.42 * Vec3::Y, (ceiling - position.y) * Vec3::Y, 0.008, 8);
        iron.add(&cable, Quat::IDENTITY, position);
        self.part(format!("{name} cable"), self.palette.black, iron);
        self.point(name, position, intensity);
    }

    /// A spot in a small cylinder that hangs from a stem, or stands on one if `stem` is below.
    pub(super) fn add_spot(
        &mut self,
        name: &str,
        position: Vec3,
        target: Vec3,
        radiant_intensity: Vec3,
        degrees: [f32; 2],
        stem: Vec3,
    ) {
        let direction = (target - position).normalize_or(Vec3::NEG_Y);
        let mouth = position - CLEARANCE * direction;
        let mut iron = rod(mouth, mouth - 0.13 * direction, 0.038, self.fine(16));
        iron.add(
            &rod(mouth - 0.08 * direction, stem, 0.009, 8),
            Quat::IDENTITY,
            Vec3::ZERO,
        );
        self.part(format!("{name} housing"), self.palette.black, iron);
        self.draft.lights.push(Light {
            name: name.into(),
            kind: LightKind::Spot {
                position,
                direction,
                radiant_intensity,
                cos_inner: degrees[0].to_radians().cos(),
                cos_outer: degrees[1].to_radians().cos(),
            },
        });
    }

    /// A lamp before a wall, behind a half cylinder that is open above and below.
    pub(super) fn add_sconce(&mut self, name: &str, on_wall: Vec3, normal: Vec3, intensity: Vec3) {
        let side = Vec3::Y.cross(normal);
        let mut shell = Mesh::default();
        for (radius, flip) in [(0.16, 1.0), (0.154, -1.0)] {
            let bowl = parametric([self.fine(20), 1], |u, v| {
                let (sin, cos) = (PI * u).sin_cos();
                on_wall + radius * (flip * cos * side + sin * normal) + (0.34 * v - 0.17) * Vec3::Y
            });
            shell.add(&bowl, Quat::IDENTITY, Vec3::ZERO);
        }
        self.part(format!("{name} shade"), self.palette.brass, shell);
        self.point(name, on_wall + 0.08 * normal, intensity);
    }

    /// A glowing ball on a foot: one light of many triangles.
    pub(super) fn add_globe(&mut self, name: &str, center: Vec3, radius: f32, radiance: Vec3) {
        let material = self.draft.add_material(Material {
            emission: radiance,
            ..Material::diffuse(name, Vec3::splat(0.8))
        });
        let ball = sphere(radius, self.fine(24));
        self.put(name, material, &ball, center);
    }
}
