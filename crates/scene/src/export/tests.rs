use std::path::Path;

use glam::Vec3;
use proptest::prelude::*;

use super::*;
use crate::{AreaLight, AreaShape, Gallery, Light, LightKind, Loaded, Scene, load};

fn reload_glb(scene: &Scene) -> (Loaded, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.glb");
    let exported = export_glb(scene).unwrap();
    std::fs::write(&path, exported.content).unwrap();
    (load(&path).unwrap(), exported.warnings)
}

fn reload_obj(scene: &Scene, folder: &Path) -> Loaded {
    let exported = export_obj(scene, "my scene.mtl");
    std::fs::write(folder.join("scene.obj"), exported.content.obj).unwrap();
    std::fs::write(folder.join("my scene.mtl"), exported.content.mtl).unwrap();
    load(&folder.join("scene.obj")).unwrap()
}

fn near(a: Vec3, b: Vec3) -> bool {
    (a - b).length() <= 1.0e-5 * (1.0 + a.length())
}

fn assert_same_geometry(a: &Scene, b: &Scene) {
    assert_eq!(a.geometry.len(), b.geometry.len());
    for index in 0..a.geometry.len() as u32 {
        let (p, q) = (a.geometry.corners(index), b.geometry.corners(index));
        for (p, q) in p.iter().zip(&q) {
            assert!(near(p.position, q.position) && near(p.normal, q.normal));
            assert!((p.uv - q.uv).length() < 1.0e-5 * (1.0 + p.uv.length()));
        }
    }
}

fn assert_same_light(a: &Light, b: &Light) {
    assert_eq!(a.name, b.name);
    match (&a.kind, &b.kind) {
        (
            LightKind::Spot {
                position,
                direction,
                radiant_intensity,
                cos_inner,
                cos_outer,
            },
            LightKind::Spot {
                position: p,
                direction: d,
                radiant_intensity: i,
                cos_inner: ci,
                cos_outer: co,
            },
        ) => {
            assert!(near(*position, *p) && near(*direction, *d) && near(*radiant_intensity, *i));
            assert!((cos_inner - ci).abs() < 1.0e-5 && (cos_outer - co).abs() < 1.0e-5);
            assert!(ci >= co);
        }
        (
            LightKind::Point {
                position,
                radiant_intensity,
            },
            LightKind::Point {
                position: p,
                radiant_intensity: i,
            },
        ) => assert!(near(*position, *p) && near(*radiant_intensity, *i)),
        (
            LightKind::Directional {
                direction,
                irradiance,
            },
            LightKind::Directional {
                direction: d,
                irradiance: i,
            },
        ) => assert!(near(*direction, *d) && near(*irradiance, *i)),
        (LightKind::Area(a), LightKind::Area(b)) => {
            assert!(near(a.radiance, b.radiance) && a.double_sided == b.double_sided);
            assert_eq!(
                std::mem::discriminant(a.shape()),
                std::mem::discriminant(b.shape())
            );
            assert!((a.area() - b.area()).abs() <= 1.0e-4 * a.area());
        }
        (a, b) => panic!("{a:?} became {b:?}"),
    }
}

#[test]
fn the_gallery_survives_a_glb() {
    let scene = crate::gallery(&Gallery {
        detail: 0.3,
        ..Gallery::default()
    });
    let (loaded, _) = reload_glb(&scene);
    // Flat and smooth surfaces share a part here, which is worth a warning and nothing else.
    let others = loaded
        .warnings
        .iter()
        .filter(|warning| !warning.ends_with("flat there"));
    assert_eq!(others.count(), 0);
    assert_same_geometry(&scene, &loaded.scene);
    assert_eq!(scene.lights.len(), loaded.scene.lights.len());
    for (a, b) in scene.lights.iter().zip(&loaded.scene.lights) {
        assert_same_light(a, b);
    }
    assert_eq!(scene.textures, loaded.scene.textures);
    for (a, b) in scene.materials.iter().zip(&loaded.scene.materials) {
        assert!(near(a.emission, b.emission));
        assert_eq!(
            (&a.name, a.base_color, a.roughness, a.metallic, a.specular),
            (&b.name, b.base_color, b.roughness, b.metallic, b.specular)
        );
        let (a, b) = (a.base_color_texture, b.base_color_texture);
        assert_eq!(a.map(|t| t.texture), b.map(|t| t.texture));
        if let (Some(a), Some(b)) = (a, b) {
            assert!((a.map(glam::Vec2::ONE) - b.map(glam::Vec2::ONE)).length() < 1.0e-5);
        }
    }
    for (a, b) in scene.cameras.iter().zip(&loaded.scene.cameras) {
        assert_eq!((&a.name, a.vertical_fov), (&b.name, b.vertical_fov));
        assert!(near(a.eye, b.eye) && near(a.forward(), b.forward()));
    }
}

#[test]
fn a_light_without_a_surface_gets_one() {
    let mut scene = crate::cornell_box();
    scene.lights.push(Light {
        name: "hidden".into(),
        kind: LightKind::Area(AreaLight::new(
            AreaShape::Rectangle {
                corner: Vec3::ONE,
                edge_u: Vec3::X,
                edge_v: Vec3::Y,
            },
            Vec3::new(0.5, 2.0, 0.0),
            true,
        )),
    });
    let (loaded, warnings) = reload_glb(&scene);
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("'hidden'"));
    assert_eq!(loaded.scene.geometry.len(), scene.geometry.len() + 2);
    for (a, b) in scene.lights.iter().zip(&loaded.scene.lights) {
        assert_same_light(a, b);
    }
}

#[test]
fn geometry_and_emission_survive_an_obj() {
    let folder = tempfile::tempdir().unwrap();
    let scene = crate::gallery(&Gallery {
        detail: 0.2,
        ..Gallery::default()
    });
    let loaded = reload_obj(&scene, folder.path());
    assert_eq!(scene.geometry.len(), loaded.scene.geometry.len());
    let is_area = |light: &&Light| matches!(light.kind, LightKind::Area(_));
    let areas: Vec<_> = scene.lights.iter().filter(is_area).collect();
    assert_eq!(areas.len(), loaded.scene.lights.len());
    let power = |lights: &mut dyn Iterator<Item = &Light>| lights.map(Light::power).sum::<Vec3>();
    let (before, after) = (
        power(&mut areas.into_iter()),
        power(&mut loaded.scene.lights.iter()),
    );
    assert!((before - after).length() < 1.0e-3 * before.length());
    let warnings = export_obj(&scene, "x.mtl").warnings;
    assert!(
        warnings
            .iter()
            .any(|warning| warning.contains("lights without a surface"))
    );
}

fn vector() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-1.0e3f32..1.0e3).prop_map(Vec3::from)
}

fn lights() -> impl Strategy<Value = LightKind> {
    let power = || prop::array::uniform3(0.0f32..1.0e4).prop_map(Vec3::from);
    let unit = || vector().prop_map(|v| v.normalize_or(Vec3::NEG_Z));
    prop_oneof![
        (vector(), power()).prop_map(|(position, radiant_intensity)| LightKind::Point {
            position,
            radiant_intensity
        }),
        (unit(), power()).prop_map(|(direction, irradiance)| LightKind::Directional {
            direction,
            irradiance
        }),
        (vector(), unit(), power(), 0.0f32..1.57, 0.0f32..=1.0).prop_map(
            |(position, direction, radiant_intensity, outer, share)| LightKind::Spot {
                position,
                direction,
                radiant_intensity,
                cos_inner: (outer * share).cos(),
                cos_outer: outer.cos(),
            }
        ),
    ]
}

proptest! {
    #[test]
    fn any_light_survives_a_glb(kinds in prop::collection::vec(lights(), 1..8)) {
        let mut scene = crate::cornell_box();
        let lamp = scene.lights.remove(0);
        scene.lights = kinds.into_iter().map(|kind| Light { name: "light".into(), kind }).collect();
        scene.lights.push(lamp);
        let (loaded, _) = reload_glb(&scene);
        prop_assert_eq!(scene.lights.len(), loaded.scene.lights.len());
        for (a, b) in scene.lights.iter().zip(&loaded.scene.lights) {
            assert_same_light(a, b);
        }
    }
}
