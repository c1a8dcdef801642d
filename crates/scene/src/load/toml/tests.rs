use super::super::load;
use crate::{AreaShape, LightKind, Loaded};

/// What becomes of a scene.toml with this text, beside a triangle in `triangle.obj`.
fn outcome(text: &str) -> Result<Loaded, String> {
    let folder = tempfile::tempdir().unwrap();
    let obj = "usemtl paint\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path().join("triangle.obj"), obj).unwrap();
    std::fs::write(folder.path().join("scene.toml"), text).unwrap();
    load(folder.path()).map_err(|error| error.to_string())
}

fn scene(text: &str) -> crate::Scene {
    outcome(text).unwrap().scene
}

const TRIANGLE: &str = "[[geometry]]\nfile = \"triangle.obj\"\n";

#[test]
fn errors_name_the_line_and_column() {
    for (text, place, piece) in [
        ("name = 3", ":1:8:", "string"),
        (
            "name = \"a\"\ncolour = 2",
            ":2:1:",
            "unknown field `colour`",
        ),
        ("\n\n[[light]]\nkind = \"lamp\"", ":4:8:", "found \"lamp\""),
        (
            "[[light]]\nkind = \"point\"\nposition = [0, 0]",
            ":3:12:",
            "",
        ),
        (
            "[[light]]\nkind = \"point\"\nposition = [0, 0, nan]",
            ":3:12:",
            "finite",
        ),
        (
            "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]",
            ":1:1:",
            "needs a radiant_intensity",
        ),
        (
            "[[light]]\nkind = \"point\"\nradiance = [1, 1, 1]",
            ":1:1:",
            "has no radiance",
        ),
        (
            "[[light]]\nkind = \"point\"\nradiant_intensity = [1, -1, 1]",
            ":3:21:",
            "negative",
        ),
        (
            "[[light]]\nemissive_material = \"glow\"\nradiance = [1, 1, 1]",
            ":2:21:",
            "no material is named \"glow\"",
        ),
        (
            "[[camera]]\neye = [0, 0, 0]\ntarget = [0, 0, 0]",
            ":1:1:",
            "the same",
        ),
        (
            "[[camera]]\neye = [0, 0, 0]\ntarget = [1, 0, 0]\nvertical_fov_degrees = 180",
            ":4:24:",
            "between 0 and 180",
        ),
        ("[[walkthrough]]\nname = \"w\"", ":1:1:", "at least one"),
        ("[settings]\nsize = [0, 5]", ":1:1:", "1 to 16384"),
        (
            "[[geometry]]\ngenerator = \"castle\"",
            ":2:13:",
            "\"science-center\"",
        ),
        (
            "[[geometry]]\ngenerator = \"bar\"\ndetail = 5",
            ":3:10:",
            "at most 4",
        ),
        (
            "[[geometry]]\ngenerator = \"cornell-box\"\nseed = 5",
            ":2:13:",
            "always the same",
        ),
        ("[[geometry]]\nfile = \"/etc/passwd\"", ":1:1:", "relative"),
        (
            "[[geometry]]\nfile = \"none.glb\"",
            ":1:1:",
            "none.glb: cannot be read",
        ),
        (
            "[[geometry]]\nfile = \"triangle.obj\"\nscale = 0",
            ":1:1:",
            "other than 0",
        ),
        (
            "[[geometry]]\nfile = \"triangle.obj\"\nscale = \"big\"",
            ":3:9:",
            "a number, or three",
        ),
        ("x = [", ":1:6:", ""),
    ] {
        let message = outcome(text).unwrap_err();
        let found = message.find("scene.toml").map_or("", |at| &message[at..]);
        assert!(
            found.contains(place) && found.contains(piece),
            "{text}\n→ {message}"
        );
    }
}

#[test]
fn parameters_of_generators_out_of_range_are_placed() {
    for generator in ["gallery", "bar", "mosque", "science-center"] {
        for (parameter, place, piece) in [
            ("detail = 4.01", ":3:10:", "above 0 and at most 4"),
            ("detail = 0", ":3:10:", "above 0 and at most 4"),
            ("detail = -1.0", ":3:10:", "above 0 and at most 4"),
            ("detail = nan", ":3:10:", "above 0 and at most 4"),
            ("detail = inf", ":3:10:", "above 0 and at most 4"),
            ("detail = \"fine\"", ":3:10:", "expected f32"),
            ("seed = -1", ":3:8:", "expected u64"),
            ("seed = 0.5", ":3:8:", "expected u64"),
            ("columns = 9", ":3:1:", "unknown field `columns`"),
        ] {
            let text = format!("[[geometry]]\ngenerator = \"{generator}\"\n{parameter}");
            let message = outcome(&text).unwrap_err();
            let found = message.find("scene.toml").map_or("", |at| &message[at..]);
            assert!(
                found.contains(place) && found.contains(piece),
                "{text}\n→ {message}"
            );
        }
    }
}

#[test]
fn all_kinds_of_light_are_read() {
    let scene = scene(&format!(
        "{TRIANGLE}\
        [[light]]\nname = \"bulb\"\nkind = \"point\"\nposition = [0, 1, 2]\nradiant_intensity = [1, 2, 3]\n\
        [[light]]\nkind = \"spot\"\nposition = [0, 5, 0]\ntarget = [0, 0, 0]\nouter_degrees = 60\nradiant_intensity = [9, 9, 9]\n\
        [[light]]\nkind = \"directional\"\ndirection = [0, -3, 0]\nirradiance = [1, 1, 1]\n\
        [[light]]\nkind = \"rectangle\"\nposition = [0, 3, 0]\ndirection = [0, -1, 0]\nsize_m = [2, 1]\nradiance = [5, 5, 5]\n\
        [[light]]\nkind = \"rectangle\"\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nradiance = [5, 5, 5]\nvisible = false\n\
        [[light]]\nemissive_material = \"paint\"\nradiance = [7, 7, 7]\n"
    ));
    assert_eq!(scene.lights.len(), 6);
    assert_eq!(scene.lights[0].name, "bulb");
    assert!(
        matches!(scene.lights[1].kind, LightKind::Spot { direction, cos_outer, .. }
        if direction.y < -0.999 && (cos_outer - 0.5).abs() < 1.0e-6)
    );
    let facing: Vec<_> = scene
        .lights
        .iter()
        .filter_map(|light| match &light.kind {
            LightKind::Area(area) => Some((
                area.triangles()[0].normal,
                area.area(),
                area.shape().clone(),
            )),
            _ => None,
        })
        .collect();
    // The unseen one first, then what has a surface, in the order of the parts.
    assert!(facing[0].0.z > 0.999 && (facing[0].1 - 1.0).abs() < 1.0e-6);
    assert!(matches!(facing[1].2, AreaShape::Mesh { .. }));
    assert!(facing[2].0.y < -0.999 && (facing[2].1 - 2.0).abs() < 1.0e-5);
    assert_eq!(scene.geometry.len(), 3);
}

#[test]
fn geometry_is_placed_and_painted() {
    let scene = scene(
        "[[geometry]]\nfile = \"triangle.obj\"\ntranslation = [10, 0, 0]\nrotation_degrees = [0, 90, 0]\nscale = [2, 1, 1]\n\
        [[material]]\nname = \"paint\"\nbase_color = [0.1, 0.2, 0.3]\nroughness = 0.5\n\
        [background]\nradiance = [0.1, 0.1, 0.2]\n[settings]\nsamples_per_pixel = 3\n",
    );
    let [a, b, _] = scene.geometry.corners(0).map(|corner| corner.position);
    assert!((a - glam::Vec3::new(10.0, 0.0, 0.0)).length() < 1.0e-5);
    assert!((b - glam::Vec3::new(10.0, 0.0, -2.0)).length() < 1.0e-5);
    assert_eq!(
        (
            scene.materials[0].base_color.y,
            scene.materials[0].roughness
        ),
        (0.2, 0.5)
    );
    assert_eq!(scene.settings.samples_per_pixel, 3);
    assert_eq!(scene.background.radiance.z, 0.2);
    assert_eq!(scene.cameras[0].name, "framed");
}

#[test]
fn lights_and_cameras_of_the_geometry_can_be_left_out() {
    let with = scene("[[geometry]]\ngenerator = \"cornell-box\"");
    assert_eq!(
        (with.lights.len(), with.cameras[0].name.as_str()),
        (1, "front")
    );
    let without = outcome(
        "[[geometry]]\ngenerator = \"cornell-box\"\nkeep_lights = false\nkeep_cameras = false",
    )
    .unwrap();
    assert_eq!(without.scene.cameras[0].name, "framed");
    assert!(
        without
            .warnings
            .iter()
            .any(|warning| warning.contains("no light"))
    );
    assert!(
        !without
            .scene
            .materials
            .iter()
            .any(crate::Material::is_emissive)
    );
}

#[test]
fn the_shipped_scenes_load() {
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    for name in ["cornell", "gallery", "bar", "mosque", "science-center"] {
        let loaded = load(&scenes.join(name)).unwrap();
        assert_eq!(
            (loaded.scene.name.as_str(), loaded.warnings),
            (name, vec![])
        );
    }
}
