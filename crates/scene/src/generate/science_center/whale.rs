//! The skeleton of a whale, hung under the glass roof with its head to the front.

use std::f32::consts::PI;

use glam::{Quat, Vec2, Vec3};

use super::{CEILING, Site};
use crate::generate::{
    mesh::Mesh,
    shapes::{rod, sweep},
};

const VERTEBRAE: u32 = 24;
const RIBS: u32 = 10;
/// Where the neck is.
const NECK: Vec3 = Vec3::new(0.35, 8.3, 3.4);

/// The spine from the neck to the tail: `t` from 0 to 1.
fn spine(t: f32) -> Vec3 {
    let sway = 0.55 * (2.2 * t * PI).sin() * t;
    NECK + Vec3::new(
        sway - 0.9 * t,
        0.35 * (PI * t).sin() - 0.9 * t * t,
        -11.2 * t,
    )
}

/// Half the size of the vertebra at `t`.
fn vertebra_half(t: f32) -> f32 {
    0.19 * (1.0 - t).powf(0.8) + 0.028
}

impl Site {
    pub(super) fn add_whale(&mut self) {
        let mut bones = Mesh::default();
        add_spine(&mut bones);
        self.add_ribs(&mut bones);
        self.add_head(&mut bones);
        self.add_flippers(&mut bones);
        self.part("whale", self.palette.bone, bones);
        // The rod that carries it, through all vertebrae.
        let armature = bone(|t| spine(0.99 * t), self.fine(10), [0.03, 0.02], 4);
        self.part("whale armature", self.palette.steel, armature);
        let mut wires = Mesh::default();
        for t in [0.02, 0.3, 0.62, 0.9] {
            let low = spine(t) + 0.1 * Vec3::Y;
            let high = Vec3::new(low.x, CEILING + 0.95, low.z);
            wires.add(&rod(low, high, 0.012, 4), Quat::IDENTITY, Vec3::ZERO);
        }
        self.part("whale wires", self.palette.steel, wires);
    }

    fn add_ribs(&self, bones: &mut Mesh) {
        for rib in 0..RIBS {
            let t = 0.03 + 0.40 * rib as f32 / RIBS as f32;
            let root = spine(t);
            // Largest a third of the way down the chest.
            let swell = (PI * (0.18 + 0.72 * rib as f32 / (RIBS - 1) as f32)).sin();
            let (wide, deep) = (0.55 + 0.62 * swell, 0.75 + 1.05 * swell);
            for side in [-1.0, 1.0] {
                let curve = move |s: f32| {
                    let angle = 0.86 * PI * s;
                    let out = wide * angle.sin();
                    let down = 0.5 * deep * (1.0 - angle.cos()) - 0.16 * (PI * s).sin();
                    root + Vec3::new(side * out, -down, -0.55 * s)
                };
                bones.add(
                    &bone(curve, self.fine(4), [0.055, 0.03], 3),
                    Quat::IDENTITY,
                    Vec3::ZERO,
                );
            }
        }
    }

    /// A long flat skull, and two bows of a jaw below it.
    fn add_head(&self, bones: &mut Mesh) {
        let skull = [
            // How far before the neck, half width, lower and upper side.
            [-0.1, 0.30, -0.30, 0.25],
            [0.5, 0.62, -0.34, 0.34],
            [1.1, 0.52, -0.22, 0.26],
            [2.2, 0.26, -0.10, 0.12],
            [3.5, 0.07, -0.16, -0.06],
        ];
        let ring = |[ahead, half, low, high]: [f32; 4]| {
            let at = |x: f32, y: f32| NECK + Vec3::new(x, y + 0.05, ahead);
            [
                at(half, 0.5 * (low + high)),
                at(0.6 * half, high),
                at(-0.6 * half, high),
                at(-half, 0.5 * (low + high)),
                at(-0.6 * half, low),
                at(0.6 * half, low),
            ]
        };
        for pair in skull.windows(2) {
            let (near, far) = (ring(pair[0]), ring(pair[1]));
            for index in 0..6 {
                let next = (index + 1) % 6;
                bones.triangle([near[index], far[index], far[next]]);
                bones.triangle([near[index], far[next], near[next]]);
            }
        }
        for (end, is_front) in [(skull[0], false), (skull[4], true)] {
            let rim = ring(end);
            for index in 1..5 {
                let (b, c) = (rim[index], rim[index + 1]);
                bones.triangle(if is_front {
                    [rim[0], b, c]
                } else {
                    [rim[0], c, b]
                });
            }
        }
        for side in [-1.0, 1.0] {
            let jaw = move |s: f32| {
                let out = 0.62 * (PI * (0.25 + 0.72 * s)).sin();
                NECK + Vec3::new(side * out, -0.45 - 0.35 * (PI * s).sin(), 0.25 + 3.2 * s)
            };
            bones.add(
                &bone(jaw, self.fine(5), [0.10, 0.05], 4),
                Quat::IDENTITY,
                Vec3::ZERO,
            );
        }
    }

    fn add_flippers(&self, bones: &mut Mesh) {
        for side in [-1.0, 1.0] {
            let shoulder = spine(0.06) + Vec3::new(side * 0.85, -0.9, 0.0);
            let elbow = shoulder + Vec3::new(side * 0.45, -0.35, -0.25);
            let wrist = elbow + Vec3::new(side * 0.5, -0.35, -0.5);
            let arm = move |s: f32| shoulder.lerp(elbow, s);
            bones.add(&bone(arm, 1, [0.10, 0.08], 4), Quat::IDENTITY, Vec3::ZERO);
            for (offset, spread) in [(0.06, -0.16), (-0.06, 0.0)] {
                let from = elbow + Vec3::new(0.0, 0.0, offset);
                let to = wrist + Vec3::new(0.0, 0.0, 2.0 * offset + 0.3 * spread);
                let forearm = move |s: f32| from.lerp(to, s);
                bones.add(
                    &bone(forearm, 1, [0.055, 0.05], 4),
                    Quat::IDENTITY,
                    Vec3::ZERO,
                );
            }
            for finger in 0..4 {
                let fan = finger as f32 - 1.5;
                let from = wrist + Vec3::new(0.0, 0.0, -0.08 * fan);
                let way = Vec3::new(side * (0.75 - 0.08 * fan.abs()), -0.45, -0.45 - 0.28 * fan);
                let curve = move |s: f32| from + s * way - 0.12 * side * s * s * Vec3::X;
                bones.add(
                    &bone(curve, self.fine(2), [0.03, 0.02], 3),
                    Quat::IDENTITY,
                    Vec3::ZERO,
                );
            }
        }
    }
}

/// Bodies with a crest each, turned along the spine.
fn add_spine(bones: &mut Mesh) {
    for index in 0..VERTEBRAE {
        let t = (index as f32 + 0.2) / VERTEBRAE as f32;
        let half = vertebra_half(t);
        let way = (spine(t + 0.01) - spine(t - 0.01)).normalize_or(Vec3::NEG_Z);
        let side = way.cross(Vec3::Y).normalize_or(Vec3::X);
        let up = side.cross(way);
        let length = 0.33;
        let block = |bones: &mut Mesh, center: Vec3, size: [f32; 3]| {
            let corner = center - 0.5 * (size[0] * side + size[1] * up + size[2] * way);
            bones.block(corner, size[0] * side, size[1] * up, size[2] * way);
        };
        block(bones, spine(t), [2.0 * half, 1.7 * half, length]);
        let crest = 0.10 + 1.5 * half;
        let root = spine(t) + 0.8 * half * up;
        let tip = root + crest * up - 0.1 * way;
        let foot = [0.04 * side, 0.12 * way, -0.04 * side, -0.12 * way].map(|at| root + at);
        for corner in 0..4 {
            bones.triangle([foot[corner], tip, foot[(corner + 1) % 4]]);
        }
    }
}

/// A bone along a curve, tapering from the first radius to the second.
fn bone(curve: impl Fn(f32) -> Vec3, steps: u32, radius: [f32; 2], sides: u32) -> Mesh {
    let profile: Vec<Vec2> = (0..sides)
        .map(|index| Vec2::from_angle(std::f32::consts::TAU * index as f32 / sides as f32))
        .collect();
    sweep(&profile, steps, |s, p| {
        let along = (curve(s + 1.0e-2) - curve(s - 1.0e-2)).normalize_or(Vec3::NEG_Y);
        let first = along.any_orthogonal_vector().normalize_or(Vec3::X);
        let second = first.cross(along);
        let reach = radius[0] + s * (radius[1] - radius[0]);
        curve(s) + reach * (p.x * first + p.y * second)
    })
}
