//! Good scene files: what this program ships and exports, and one of everything else.

use std::io::Cursor;

use image::{ImageFormat, RgbImage};
use lie_scene::{Rooms, Scene, cornell_box, export_glb, export_obj, load, rooms};

use super::Files;

const EVERY_KIND: &str = include_str!("every_kind.toml");
const BOX_OBJ: &str = include_str!("box.obj");
const BOX_MTL: &str = include_str!("box.mtl");
const TRIANGLE_GLTF: &str = include_str!("triangle.gltf");
const CORNELL: &str = include_str!("../../../../scenes/cornell/scene.toml");

/// The scene of the first seed of [`toml`].
pub(crate) fn of_every_kind() -> Scene {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in every_kind().0 {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    load(folder.path()).unwrap().scene
}

fn every_kind() -> Files {
    let mut files = boxes("box.obj");
    files.push(("scene.toml", EVERY_KIND.into()));
    Files(files)
}

/// A box with pictures on it.
fn boxes(name: &'static str) -> Vec<(&'static str, Vec<u8>)> {
    vec![
        (name, BOX_OBJ.into()),
        ("main.mtl", BOX_MTL.into()),
        ("wood.png", picture(ImageFormat::Png)),
        ("wood.jpg", picture(ImageFormat::Jpeg)),
    ]
}

fn picture(format: ImageFormat) -> Vec<u8> {
    let texel = |x: u32, y: u32| image::Rgb([(x * 37) as u8, (y * 61) as u8, (x * y) as u8]);
    let mut bytes = Cursor::new(Vec::new());
    let picture = RgbImage::from_fn(8, 8, texel);
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn small() -> Scene {
    rooms(&Rooms {
        rooms: 1,
        lights_in_each: 2,
    })
}

pub(super) fn toml() -> Vec<Vec<u8>> {
    let cornell = Files(vec![("scene.toml", CORNELL.into())]);
    [every_kind(), cornell].iter().map(Files::joined).collect()
}

pub(super) fn obj() -> Vec<Vec<u8>> {
    let exported = [cornell_box(), small()].map(|scene| {
        let text = export_obj(&scene, "main.mtl").content;
        Files(vec![
            ("main.obj", text.obj.into()),
            ("main.mtl", text.mtl.into()),
        ])
    });
    let mut seeds = vec![Files(boxes("main.obj"))];
    seeds.extend(exported);
    seeds.iter().map(Files::joined).collect()
}

pub(super) fn gltf() -> Vec<Vec<u8>> {
    let triangle = Files(vec![
        ("main.gltf", TRIANGLE_GLTF.into()),
        ("main.bin", triangle_buffer()),
        ("wood.png", picture(ImageFormat::Png)),
    ]);
    let mut seeds = vec![triangle];
    for scene in [of_every_kind(), cornell_box(), small()] {
        let glb = export_glb(&scene).unwrap().content;
        seeds.push(Files(vec![("main.gltf", glb)]));
    }
    seeds.iter().map(Files::joined).collect()
}

/// Positions, then indices, then one other position and its index (sparse).
fn triangle_buffer() -> Vec<u8> {
    let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend([1.0f32, 1.0, 0.5].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend([2, 0, 0, 0]);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_load_and_have_one_of_everything() {
        for (main, seeds) in [
            ("main.obj", obj()),
            ("main.gltf", gltf()),
            ("scene.toml", toml()),
        ] {
            for seed in &seeds {
                let folder = tempfile::tempdir().unwrap();
                for (name, content) in Files::split(seed).0 {
                    std::fs::write(folder.path().join(name), content).unwrap();
                }
                let loaded = load(&folder.path().join(main)).unwrap();
                assert!(!loaded.scene.geometry.is_empty());
            }
        }
        let scene = of_every_kind();
        let kinds: std::collections::HashSet<_> = scene
            .lights
            .iter()
            .map(|light| std::mem::discriminant(&light.kind))
            .collect();
        assert_eq!(kinds.len(), 4);
        assert!(!scene.textures.is_empty() && !scene.walkthroughs.is_empty());
    }
}
