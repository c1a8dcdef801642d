use glam::{Affine2, UVec2, Vec2, Vec3};
use lie_scene::{
    AlphaMode, AreaLight, AreaShape, Background, Camera, Geometry, KeyFrame, Light, LightKind,
    Material, MeshPart, RenderSettings, Scene, Texture, TextureRef, Vertex, Walkthrough,
};
use proptest::prelude::*;

use super::*;

/// A scene with one of everything.
pub(crate) fn full_scene() -> Scene {
    let vertex = |position: Vec3| Vertex {
        position,
        normal: Vec3::Z,
        uv: position.truncate(),
    };
    let part = |name: &str, triangles| MeshPart {
        name: name.into(),
        triangles,
        material: 1,
    };
    let light = |name: &str, kind| Light {
        name: name.into(),
        kind,
    };
    let area = |shape| LightKind::Area(AreaLight::new(shape, Vec3::splat(3.0), true));
    let key = |time| KeyFrame::look_at(time, Vec3::splat(time), Vec3::NEG_Z, 1.0);
    let mut textured = Material::diffuse("textured", Vec3::splat(0.25));
    textured.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
    textured.base_color_texture = Some(TextureRef {
        texture: 1,
        texture_from_uv: Affine2::from_scale(Vec2::new(2.0, 3.0)),
    });
    let texture = |side: u32| Texture::new(side, 1, true, vec![[1, 2, 3, 4]; side as usize]);
    Scene {
        name: "with 'ümläuts'".into(),
        geometry: Geometry::new(
            [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE]
                .map(vertex)
                .to_vec(),
            vec![[0, 1, 2], [1, 2, 3], [0, 2, 3]],
            vec![part("a", 0..1), part("b", 1..3)],
        )
        .unwrap(),
        materials: vec![Material::default(), textured],
        textures: vec![texture(1).unwrap(), texture(3).unwrap()],
        lights: vec![
            light(
                "point",
                LightKind::Point {
                    position: Vec3::Y,
                    radiant_intensity: Vec3::splat(2.0),
                },
            ),
            light(
                "spot",
                LightKind::Spot {
                    position: Vec3::Y,
                    direction: Vec3::NEG_Y,
                    radiant_intensity: Vec3::ONE,
                    cos_inner: 0.9,
                    cos_outer: 0.8,
                },
            ),
            light(
                "sun",
                LightKind::Directional {
                    direction: Vec3::NEG_Y,
                    irradiance: Vec3::ONE,
                },
            ),
            light(
                "panel",
                area(AreaShape::Rectangle {
                    corner: Vec3::Y,
                    edge_u: Vec3::X,
                    edge_v: Vec3::Z,
                }),
            ),
            light(
                "mesh",
                area(AreaShape::Mesh {
                    triangles: vec![[Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::X, Vec3::Y, Vec3::Z]],
                }),
            ),
        ],
        cameras: vec![Camera::look_at("eye", Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0)],
        walkthroughs: vec![Walkthrough {
            name: "walk".into(),
            key_frames: vec![key(0.0), key(1.5)],
        }],
        background: Background {
            radiance: Vec3::new(0.1, 0.2, 0.3),
        },
        settings: RenderSettings {
            size: UVec2::new(64, 48),
            ..RenderSettings::default()
        },
    }
}

#[test]
fn a_scene_comes_back_equal() {
    let scene = full_scene();
    scene.validate().unwrap();
    let bytes = encode(&scene).unwrap();
    assert_eq!(decode(&bytes).unwrap(), scene);
    assert_eq!(encode(&decode(&bytes).unwrap()).unwrap(), bytes);
}

#[test]
fn every_truncation_and_every_addition_is_refused() {
    let bytes = encode(&full_scene()).unwrap();
    for length in 0..bytes.len() {
        assert!(decode(&bytes[..length]).is_err(), "{length} bytes");
    }
    let mut longer = bytes;
    longer.push(0);
    assert!(decode(&longer).is_err());
}

#[test]
fn a_count_beyond_the_bytes_is_refused_before_it_is_allocated() {
    let mut bytes = encode(&full_scene()).unwrap();
    // The description begins at 20 with the name (a length byte and the text); then comes
    // the number of vertices, here made 2⁶⁰.
    let name = usize::from(bytes[20]);
    let count = 21 + name;
    assert_eq!(bytes[count], 4);
    bytes.splice(count..=count, [253, 0, 0, 0, 0, 0, 0, 0, 16]);
    let length = u64::from_le_bytes(bytes[12..20].try_into().unwrap()) + 8;
    bytes[12..20].copy_from_slice(&length.to_le_bytes());
    assert_eq!(decode(&bytes), Err(BlobError::Array { array: "vertices" }));
}

proptest! {
    #[test]
    fn changed_bytes_do_no_harm(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = encode(&full_scene()).unwrap();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(scene) = decode(&bytes) {
            prop_assert!(scene.validate().is_ok());
        }
    }
}
