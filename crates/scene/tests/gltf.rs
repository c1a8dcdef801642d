//! glTF, feature by feature.

#![allow(clippy::unwrap_used)]

use glam::Vec3;
use lie_scene::{AlphaMode, LightKind, Loaded, load};
use serde_json::{Value, json};

/// A unit square in the plane z = 0 that faces +z, as two triangles, in one mesh and node.
fn square() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "square"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "paint"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "buffers": [{"byteLength": 72, "uri": "square%20data.bin"}],
    })
}

fn load_value(document: &Value) -> Result<Loaded, String> {
    let folder = tempfile::tempdir().unwrap();
    let positions: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
    let indices: [u32; 6] = [0, 1, 2, 0, 2, 3];
    let bytes: Vec<u8> = positions
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .chain(indices.iter().flat_map(|i| i.to_le_bytes()))
        .collect();
    std::fs::write(folder.path().join("square data.bin"), bytes).unwrap();
    let path = folder.path().join("model.gltf");
    std::fs::write(&path, document.to_string()).unwrap();
    load(&path).map_err(|error| error.to_string())
}

fn normal(loaded: &Loaded) -> Vec3 {
    loaded.scene.geometry.triangle(0).normal
}

#[test]
fn transforms_multiply_and_mirrors_keep_the_front() {
    let mut document = square();
    document["nodes"] = json!([
        {"translation": [5, 0, 0], "children": [1]},
        {"mesh": 0, "scale": [-2, 1, 1]},
    ]);
    let loaded = load_value(&document).unwrap();
    let bounds = loaded.scene.geometry.bounds();
    assert_eq!(
        (bounds.min, bounds.max),
        (Vec3::new(3.0, 0.0, 0.0), Vec3::new(5.0, 1.0, 0.0))
    );
    assert_eq!(normal(&loaded), Vec3::Z);
    assert!(
        loaded
            .scene
            .geometry
            .vertices()
            .iter()
            .all(|vertex| vertex.normal == Vec3::ZERO)
    );
}

#[test]
fn each_instance_of_an_emissive_primitive_is_one_light() {
    let mut document = square();
    document["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 3]}]);
    document["scenes"] = json!([{"nodes": [0, 1]}]);
    document["materials"][0] = json!({
        "emissiveFactor": [1, 0.5, 0.25], "doubleSided": true,
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
    });
    let scene = load_value(&document).unwrap().scene;
    assert_eq!((scene.lights.len(), scene.geometry.len()), (2, 4));
    let LightKind::Area(area) = &scene.lights[0].kind else {
        panic!("an area light");
    };
    assert_eq!(
        (area.radiance, area.double_sided),
        (Vec3::new(8.0, 4.0, 2.0), true)
    );
    assert!((area.area() - 1.0).abs() < 1.0e-6);
}

#[test]
fn primitive_modes_make_the_same_square() {
    for (mode, indices, triangles) in [(4, 6, 2), (5, 4, 2), (6, 4, 2), (0, 6, 0), (3, 6, 0)] {
        let mut document = square();
        let primitive = &mut document["meshes"][0]["primitives"][0];
        primitive["mode"] = json!(mode);
        if indices == 4 {
            primitive.as_object_mut().unwrap().remove("indices");
        }
        let loaded = load_value(&document).unwrap();
        assert_eq!(loaded.scene.geometry.len(), triangles, "mode {mode}");
        assert_eq!(
            loaded.warnings.iter().any(|w| w.contains("left out")),
            triangles == 0
        );
        if triangles > 0 {
            assert_eq!(normal(&loaded), Vec3::Z);
        }
    }
}

#[test]
fn blending_becomes_a_mask_and_says_so() {
    let mut document = square();
    document["materials"][0]["alphaMode"] = json!("BLEND");
    let loaded = load_value(&document).unwrap();
    assert_eq!(
        loaded.scene.materials[0].alpha_mode,
        AlphaMode::Mask { cutoff: 0.5 }
    );
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.contains("paint"))
    );
    document["materials"][0] = json!({"alphaMode": "MASK", "alphaCutoff": 0.25});
    let scene = load_value(&document).unwrap().scene;
    assert_eq!(
        scene.materials[0].alpha_mode,
        AlphaMode::Mask { cutoff: 0.25 }
    );
}

#[test]
fn a_missing_texture_leaves_the_factor() {
    let mut document = square();
    document["images"] = json!([{"uri": "none.png"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"][0]["pbrMetallicRoughness"] =
        json!({"baseColorFactor": [0.1, 0.2, 0.3, 1], "baseColorTexture": {"index": 0}});
    let loaded = load_value(&document).unwrap();
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.contains("none.png"))
    );
    assert_eq!(loaded.scene.materials[0].base_color_texture, None);
    assert!((loaded.scene.materials[0].base_color.z - 0.3).abs() < 1.0e-6);
}

#[test]
fn lights_and_cameras_follow_their_nodes() {
    let mut document = square();
    document["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    document["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 10, "color": [1, 0.5, 0], "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.4}},
    ]}});
    document["cameras"] =
        json!([{"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = json!([0, half, 0, half]);
    document["nodes"] = json!([
        {"mesh": 0, "children": [1, 2]},
        {"translation": [1, 2, 3], "rotation": turn, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"name": "eye", "translation": [0, 0, 4], "rotation": turn, "camera": 0},
    ]);
    let scene = load_value(&document).unwrap().scene;
    let LightKind::Spot {
        position,
        direction,
        radiant_intensity,
        cos_inner,
        ..
    } = scene.lights[0].kind
    else {
        panic!("a spot");
    };
    assert_eq!(
        (position, radiant_intensity),
        (Vec3::new(1.0, 2.0, 3.0), Vec3::new(10.0, 5.0, 0.0))
    );
    assert!(
        (direction - Vec3::NEG_X).length() < 1.0e-5 && (cos_inner - 0.2f32.cos()).abs() < 1.0e-6
    );
    let camera = &scene.cameras[0];
    assert_eq!((camera.name.as_str(), camera.vertical_fov), ("eye", 0.9));
    assert!((camera.forward() - Vec3::NEG_X).length() < 1.0e-5);
}

#[test]
fn without_a_scene_all_roots_are_shown_and_without_a_light_one_stands_in() {
    let mut document = square();
    document.as_object_mut().unwrap().remove("scenes");
    document.as_object_mut().unwrap().remove("scene");
    let loaded = load_value(&document).unwrap();
    assert_eq!(loaded.scene.geometry.len(), 2);
    assert_eq!(
        (
            loaded.scene.lights[0].name.as_str(),
            loaded.scene.cameras[0].name.as_str()
        ),
        ("default", "framed")
    );
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.contains("scene.toml"))
    );
}
