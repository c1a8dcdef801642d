//! A hundred lamps: crowns of light along the nave, small rings in the other aisles. The light
//! is a point in the middle of the ring, with nothing around it but cups and chains.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

use super::{BAY, BAYS, CEILING, Site, place, side_aisle_x};
use crate::{
    Light, LightKind,
    generate::{
        mesh::Mesh,
        shapes::{lathe, rod, torus},
    },
};

/// Light of an oil lamp: relative to white, at equal luminance or so.
const FLAME: Vec3 = Vec3::new(1.32, 0.94, 0.55);
const NAVE_INTENSITY: f32 = 26.0;
const SIDE_INTENSITY: f32 = 3.4;
const NAVE_HEIGHT: f32 = 5.1;
const SIDE_HEIGHT: f32 = 4.35;

/// The measures of a ring of cups on chains.
struct Crown {
    radius: f32,
    tube: f32,
    cups: u32,
    chains: u32,
    /// From the light to where the chains meet.
    apex: f32,
}

impl Site {
    pub(super) fn add_lamps(&mut self) {
        let large = Crown {
            radius: 0.62,
            tube: 0.022,
            cups: 12,
            chains: 6,
            apex: 1.0,
        };
        let crown = self.crown(&large, NAVE_HEIGHT);
        for index in 0..BAYS {
            let place = Vec3::new(0.0, NAVE_HEIGHT, -BAY * (index as f32 + 0.5));
            self.add_lamp(&format!("nave lamp {index}"), &crown, place, NAVE_INTENSITY);
        }
        let small = Crown {
            radius: 0.34,
            tube: 0.014,
            cups: 6,
            chains: 3,
            apex: 0.6,
        };
        let ring = self.crown(&small, SIDE_HEIGHT);
        for (aisle, x) in side_aisle_x().enumerate() {
            for index in 1..BAYS {
                let place = Vec3::new(x, SIDE_HEIGHT, -BAY * index as f32);
                let own = self.key.mix(77).mix(aisle as u64).mix(u64::from(index));
                // No two wicks are alike.
                let intensity = SIDE_INTENSITY * (0.85 + 0.3 * own.uniform(0));
                self.add_lamp(&format!("lamp {aisle}.{index}"), &ring, place, intensity);
            }
        }
    }

    fn add_lamp(&mut self, name: &str, crown: &[Mesh; 2], position: Vec3, intensity: f32) {
        let [metal, glass] = crown;
        for (what, material, piece) in [
            ("crown", self.palette.brass, metal),
            ("cups", self.palette.glass, glass),
        ] {
            let mut mesh = Mesh::default();
            place(&mut mesh, piece, position);
            self.part(format!("{name} {what}"), material, mesh);
        }
        self.draft.lights.push(Light {
            name: name.into(),
            kind: LightKind::Point {
                position,
                radiant_intensity: intensity * FLAME,
            },
        });
    }

    /// Metal and cups about a light at the origin that hangs `height` above the floor. The
    /// ring is a little below the light.
    fn crown(&self, crown: &Crown, height: f32) -> [Mesh; 2] {
        let ring_y = -0.16;
        let mut metal = Mesh::default();
        let counts = [self.fine(24), self.fine(5)];
        place(
            &mut metal,
            &torus(crown.radius, crown.tube, counts),
            ring_y * Vec3::Y,
        );
        let apex = crown.apex * Vec3::Y;
        for chain in 0..crown.chains {
            let turn = chain as f32 / crown.chains as f32 * TAU;
            let foot = Vec3::new(crown.radius * turn.cos(), ring_y, crown.radius * turn.sin());
            place(
                &mut metal,
                &rod(foot, apex, 0.35 * crown.tube, 5),
                Vec3::ZERO,
            );
        }
        let boss = [
            [0.012, -0.08],
            [0.05, -0.03],
            [0.065, 0.0],
            [0.03, 0.05],
            [0.01, 0.12],
        ];
        let boss = lathe(&boss.map(Vec2::from), self.fine(12));
        place(&mut metal, &boss, apex);
        let roof = (CEILING - height) * Vec3::Y;
        place(&mut metal, &rod(apex, roof, 0.011, 6), Vec3::ZERO);

        let cup = [
            [0.0, -0.15],
            [0.038, -0.09],
            [0.030, -0.02],
            [0.042, 0.02],
            [0.036, 0.02],
            [0.024, -0.02],
            [0.030, -0.09],
            [0.0, -0.13],
        ];
        let cup = lathe(&cup.map(Vec2::from), self.fine(6));
        let mut glass = Mesh::default();
        for index in 0..crown.cups {
            let turn = Quat::from_rotation_y((index as f32 + 0.5) / crown.cups as f32 * TAU);
            let out = crown.radius + crown.tube;
            glass.add(&cup, turn, turn * Vec3::new(out, ring_y + 0.03, 0.0));
        }
        [metal, glass]
    }
}
