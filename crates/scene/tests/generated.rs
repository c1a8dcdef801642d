//! The scenes that are made by rule are the same ones, to a thousandth, from one run and one
//! commit to the next.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use lie_scene::{LightKind, Scene, load};

/// FNV-1a, 64 bits: small, and the same for ever.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Numbers in thousandths: the last digits of sines and powers are the compiler's and the
    /// system's. Nothing is designed to be three tenths of a thousandth off, where this cuts.
    fn add_all(&mut self, numbers: &[f32]) {
        for number in numbers {
            let thousandths = (1000.0 * f64::from(*number) + 0.3).floor();
            self.add(thousandths as i32 as u32);
        }
    }
}

/// Of all corners with their texture coordinates, and of the order of triangles. Normals follow
/// from the same numbers, and lose more digits on their way.
fn geometry_hash(scene: &Scene) -> u64 {
    let mut hash = Hash::new();
    for vertex in scene.geometry.vertices() {
        hash.add_all(&vertex.position.to_array());
        hash.add_all(&vertex.uv.to_array());
    }
    for triangle in scene.geometry.triangles() {
        triangle.iter().for_each(|corner| hash.add(*corner));
    }
    for part in scene.geometry.parts() {
        hash.add(part.triangles.end);
        hash.add(part.material);
    }
    hash.0
}

/// Of what the lights are.
fn light_hash(scene: &Scene) -> u64 {
    let mut hash = Hash::new();
    for light in &scene.lights {
        match &light.kind {
            LightKind::Point {
                position,
                radiant_intensity,
            } => {
                hash.add_all(&position.to_array());
                hash.add_all(&radiant_intensity.to_array());
            }
            LightKind::Spot {
                position,
                direction,
                radiant_intensity,
                cos_inner,
                cos_outer,
            } => {
                hash.add_all(&position.to_array());
                hash.add_all(&direction.to_array());
                hash.add_all(&radiant_intensity.to_array());
                hash.add_all(&[*cos_inner, *cos_outer]);
            }
            LightKind::Area(area) => {
                hash.add_all(&area.radiance.to_array());
                for triangle in area.triangles() {
                    for corner in [triangle.a, triangle.b, triangle.c] {
                        hash.add_all(&corner.to_array());
                    }
                }
            }
            LightKind::Directional { .. } => panic!("no generator makes these"),
        }
    }
    hash.0
}

fn shipped(name: &str) -> Scene {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    load(&scenes.join(name)).unwrap().scene
}

#[test]
fn the_shipped_scenes_are_what_they_were() {
    let mut changed = vec![];
    for (name, geometry, lights) in [
        (
            "science-center",
            0xf2c3_02dd_b220_d4d6,
            0x1a7f_c24b_eeb5_1ea1,
        ),
        ("bar", 0x1044_e82b_b79d_d944, 0xfb9b_e5d6_671a_5af8),
        ("mosque", 0x1040_0c06_3fd2_1105, 0x044c_4db4_3e12_9d59),
    ] {
        let scene = shipped(name);
        let found = (geometry_hash(&scene), light_hash(&scene));
        if found != (geometry, lights) {
            changed.push(format!(
                "(\"{name}\", {:#018x}, {:#018x}),",
                found.0, found.1
            ));
        }
    }
    // A generator was changed on purpose? Then these belong above.
    assert!(changed.is_empty(), "{}", changed.join("\n"));
}
