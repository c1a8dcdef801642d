//! The scenes that are made by rule are the same ones, bit for bit, from one run and one commit
//! to the next.

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

    fn add_all(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|number| self.add(number.to_bits()));
    }
}

/// Of all corners, with normals and texture coordinates, and of the order of triangles.
fn geometry_hash(scene: &Scene) -> u64 {
    let mut hash = Hash::new();
    for vertex in scene.geometry.vertices() {
        hash.add_all(&vertex.position.to_array());
        hash.add_all(&vertex.normal.to_array());
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

/// Sines come from the system's library, whose last digit may differ elsewhere.
#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
#[test]
fn the_shipped_scenes_are_what_they_were() {
    let mut changed = vec![];
    for (name, geometry, lights) in [
        (
            "science-center",
            0xd7ba_20df_c499_acc3,
            0x910f_e4f9_5cb4_9217,
        ),
        ("bar", 0xe82d_c483_fa4e_9c65, 0x3271_f540_fc29_7662),
        ("mosque", 0x055a_f372_87f7_a3ba, 0xda9c_55fb_eb13_5e62),
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
