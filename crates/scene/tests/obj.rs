//! OBJ and MTL, feature by feature.

#![allow(clippy::unwrap_used)]

use lie_scene::{AlphaMode, AreaShape, LightKind, Loaded, load};

fn load_obj(obj: &str, files: &[(&str, &str)]) -> Result<Loaded, String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    let path = folder.path().join("model.obj");
    std::fs::write(&path, obj).unwrap();
    load(&path).map_err(|error| error.to_string())
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\n";

#[test]
fn a_group_that_shines_is_one_light_and_stays_visible() {
    let obj = format!(
        "mtllib m.mtl\n{SQUARE}o lamp\nusemtl glow\nf 4 3 2 1\no floor\nusemtl plain\nf 1 2 3 4\n"
    );
    let mtl = "newmtl glow\nKe 3 4 5\nnewmtl plain\nKd 0.2 0.3 0.4\nKs 0 0 0\nNs 10\n";
    let scene = load_obj(&obj, &[("m.mtl", mtl)]).unwrap().scene;
    let [light] = &scene.lights[..] else {
        panic!("one light");
    };
    let LightKind::Area(area) = &light.kind else {
        panic!("an area light");
    };
    assert_eq!(light.name, "lamp");
    assert!(matches!(area.shape(), AreaShape::Rectangle { .. }));
    assert!(area.triangles()[0].normal.y < -0.999);
    assert_eq!(scene.geometry.len(), 4);
    let plain = &scene.materials[1];
    assert_eq!((plain.base_color.y, plain.specular), (0.3, 0.0));
    assert!((plain.roughness.powi(4) - 2.0 / 12.0).abs() < 1.0e-4);
}

#[test]
fn a_missing_library_is_a_warning_and_keeps_the_names() {
    let loaded = load_obj(
        &format!("mtllib none here.mtl\n{SQUARE}usemtl oak\nf 1 2 3 4\n"),
        &[],
    )
    .unwrap();
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.contains("none here.mtl"))
    );
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.contains("'oak'"))
    );
    assert_eq!(loaded.scene.materials[0].name, "oak");
}

#[test]
fn corners_with_and_without_attributes_do_not_mix_up() {
    let obj = format!(
        "{SQUARE}vt 0.25 0.75\nvn 0 2 0\nf 1 2 3\nf 1/1/1 3/1/1 4/1/1\nf 1/1 3 4\nf 2//1 3//1 4//1\n"
    );
    let geometry = load_obj(&obj, &[]).unwrap().scene.geometry;
    assert_eq!(geometry.len(), 4);
    let mut textured = 0;
    for index in 0..4 {
        let [corner, ..] = geometry.corners(index);
        let is_textured = corner.uv == glam::Vec2::new(0.25, 0.25);
        assert!(is_textured || corner.uv == glam::Vec2::ZERO);
        textured += u32::from(is_textured);
    }
    assert_eq!(textured, 1);
    let smooth = (0..4)
        .filter(|&i| geometry.corners(i)[0].normal == glam::Vec3::Y)
        .count();
    assert_eq!(smooth, 2);
}

#[test]
fn what_mtl_files_hold_in_practice_is_read() {
    let mtl = "newmtl a\nKd 0.5 0.5 0.5 # grey\nKd spectral file.rfl 1\nd -halo 0.25\nmap_Kd -s 2 2 2 no such file.png\n\
               newmtl b\nKd 0.7\nPr 0.3\nPm 1\nKs 0.9 0.6 0.3\nTr 0\nillum nonsense\nmap_bump\n";
    let loaded = load_obj(
        &format!("mtllib m.mtl\n{SQUARE}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n"),
        &[("m.mtl", mtl)],
    )
    .unwrap();
    let [a, b] = &loaded.scene.materials[..] else {
        panic!("two materials");
    };
    assert_eq!(
        (a.base_color.x, a.alpha, a.alpha_mode),
        (0.5, 0.25, AlphaMode::Mask { cutoff: 0.5 })
    );
    assert_eq!(
        (b.base_color.z, b.roughness, b.metallic, b.alpha_mode),
        (0.7, 0.3, 1.0, AlphaMode::Opaque)
    );
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.contains("no such file.png"))
    );
    for (bad, place) in [
        ("newmtl a\nKd 1 2\n", "m.mtl:2:1:"),
        ("newmtl a\nNs x1 nan\nKe 1 nan 1", "m.mtl:3:6:"),
    ] {
        let message = load_obj(
            &format!("mtllib m.mtl\n{SQUARE}f 1 2 3\n"),
            &[("m.mtl", bad)],
        )
        .unwrap_err();
        assert!(message.contains(place), "{message}");
    }
}

#[test]
fn lines_may_go_on_and_names_may_be_anything() {
    let obj = format!("{SQUARE}g  two words \r\nf 1 2 \\\n 3 4\r\ng\nf -1 -2 -3\n");
    let scene = load_obj(&obj, &[]).unwrap().scene;
    let names: Vec<_> = scene
        .geometry
        .parts()
        .iter()
        .map(|part| part.name.as_str())
        .collect();
    assert_eq!(names, ["two words", "unnamed"]);
    assert_eq!(scene.geometry.len(), 3);
}
