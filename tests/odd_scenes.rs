//! Scenes at the edges of what there is, through the real binary: a camera in solid matter, one
//! light, a thousand lights, geometry that is hardly there, parameters out of range. What is known of
//! odd scenes is tested more closely in `crates/farm/tests/odd_scenes.rs`.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::{
    fmt::Write,
    path::{Path, PathBuf},
};

use lie_render::Film;

const INTEGRATORS: [&str; 3] = ["standard", "ward", "lie"];

/// Writes a scene.toml that begins with the Cornell box without its lamp.
fn scene(home: &Path, text: &str) -> PathBuf {
    let path = home.join("scene.toml");
    let bare = "[[geometry]]\ngenerator = \"cornell-box\"\nkeep_lights = false\n";
    std::fs::write(&path, format!("{bare}{text}")).unwrap();
    path
}

/// What an integrator makes of a scene, in few pixels: read back, so that all are numbers.
fn render(scene: &Path, integrator: &str, more: &[&str]) -> Film {
    let out = scene.with_file_name("frame.exr");
    let mut command = support::lie();
    command.arg("render").arg(scene).args(["--log", "error"]);
    command.args(["--integrator", integrator, "--size", "40x40"]);
    command.args(["--samples", "20000"]).args(more);
    command.arg("--out").arg(&out);
    support::succeeds(&mut command);
    let film = lie_render::read_image(&out).unwrap();
    let is_sound = |radiance: &glam::Vec3| radiance.is_finite() && radiance.min_element() >= 0.0;
    assert!(film.radiance().iter().all(is_sound), "{integrator}");
    film
}

fn brightest(film: &Film) -> f32 {
    let channels = film
        .radiance()
        .iter()
        .map(|radiance| radiance.max_element());
    channels.fold(0.0, f32::max)
}

/// Points of light in rows and columns below the ceiling, as bright together as one of 60 W/sr.
fn points(count: usize) -> String {
    let side = (count as f32).sqrt().ceil() as usize;
    let step = 5.0 / side as f32;
    let mut text = String::new();
    for number in 0..count {
        let at = |index: usize| step * (index as f32 + 0.5) - 2.5;
        let (x, z) = (at(number % side), at(number / side) - 2.8);
        let each = 60.0 / count as f32;
        writeln!(text, "[[light]]\nkind = \"point\"").unwrap();
        writeln!(text, "position = [{x:?}, 5.3, {z:?}]").unwrap();
        writeln!(text, "radiant_intensity = [{each:?}, {each:?}, {each:?}]").unwrap();
    }
    text
}

#[test]
fn a_camera_in_solid_matter_sees_something_or_nothing_but_numbers() {
    let home = tempfile::tempdir().unwrap();
    // Inside the tall block, in the plane of the floor, and behind the back wall.
    for (eye, target) in [
        ("[-0.93, 1.0, -3.5]", "[0.0, 1.0, 0.0]"),
        ("[0.0, 0.0, -1.0]", "[0.0, 0.0, -5.0]"),
        ("[0.0, 1.0, -5.7]", "[0.0, 1.0, 0.0]"),
    ] {
        let camera = format!("[[camera]]\nname = \"in\"\neye = {eye}\ntarget = {target}\n");
        let path = scene(home.path(), &(camera + &points(2)));
        for integrator in INTEGRATORS {
            render(&path, integrator, &["--camera", "in"]);
        }
    }
}

#[test]
fn one_light_is_enough() {
    let home = tempfile::tempdir().unwrap();
    let path = scene(home.path(), &points(1));
    let [standard, ward, lie] = INTEGRATORS.map(|integrator| render(&path, integrator, &[]));
    assert!(brightest(&standard) > 0.0);
    for film in [ward, lie] {
        let figures = lie_render::compare(&film, &standard, 0.0).unwrap();
        assert!(figures.relative_rmse < 0.01, "{figures:?}");
    }
}

#[test]
fn a_thousand_lights_are_not_too_many() {
    let home = tempfile::tempdir().unwrap();
    let path = scene(home.path(), &points(1000));
    let [standard, ward, lie] = INTEGRATORS.map(|integrator| render(&path, integrator, &[]));
    assert!(brightest(&standard) > 0.0);
    // Ward may be wrong by its threshold of 5 %, LIEs with trust by a tenth of that.
    for (film, most) in [(ward, 0.05), (lie, 0.005)] {
        let figures = lie_render::compare(&film, &standard, 0.0).unwrap();
        assert!(figures.relative_rmse < most, "{figures:?}");
    }
}

/// An OBJ file with wires thinner than a pixel, a sheet that is there twice, a box, and triangles
/// without area.
fn hardly_there(home: &Path) {
    let mut text = String::from("v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\nf 1 1 1\n");
    let mut polygon = |corners: &[[f32; 3]]| {
        for [x, y, z] in corners {
            writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
        }
        let numbers: Vec<String> = (1..=corners.len()).map(|back| format!("-{back}")).collect();
        writeln!(text, "f {}", numbers.join(" ")).unwrap();
    };
    for wire in 0..200 {
        let x = 0.02 * wire as f32 - 2.0;
        polygon(&[
            [x, 0.5, -3.0],
            [x + 1.0e-4, 0.5, -3.0],
            [x + 0.3, 2.5, -1.5],
        ]);
    }
    for _ in 0..2 {
        polygon(&[
            [-1.0, 3.0, -4.0],
            [1.0, 3.0, -4.0],
            [1.0, 3.0, -2.0],
            [-1.0, 3.0, -2.0],
        ]);
    }
    // A box, from one corner along three edges and back from the other.
    for [at, u, v] in [
        [[1.0, 0.2, -2.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[1.0, 0.2, -2.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.2, -2.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        [[2.0, 1.2, -1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
        [[2.0, 1.2, -1.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        [[2.0, 1.2, -1.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]],
    ] {
        let [at, u, v] = [at, u, v].map(glam::Vec3::from_array);
        polygon(&[at, at + u, at + u + v, at + v].map(|corner| corner.to_array()));
    }
    std::fs::write(home.join("thin.obj"), text).unwrap();
}

#[test]
fn thin_and_coincident_geometry_under_odd_lights_looks_as_it_is() {
    let home = tempfile::tempdir().unwrap();
    hardly_there(home.path());
    let mut text = String::from("[[geometry]]\nfile = \"thin.obj\"\n");
    // One that is seen, one in the sheet, in the box, at its corner, very far away, behind the
    // back wall; one of no power, and one of next to none.
    for (position, power) in [
        ([0.0f32, 5.0, -1.0], 40.0f32),
        ([0.2, 3.0, -3.0], 4.0),
        ([1.5, 0.7, -1.5], 50.0),
        ([2.0, 1.2, -1.0], 4.0),
        ([1.0e4, 2.0e4, 1.0e5], 1.0e10),
        ([0.0, 2.0, -9.0], 50.0),
        ([-1.0, 4.0, 0.0], 0.0),
        ([1.0, 4.0, 0.0], 4.0e-8),
    ] {
        let radiant_intensity = [power; 3];
        writeln!(text, "[[light]]\nkind = \"point\"\nposition = {position:?}").unwrap();
        writeln!(text, "radiant_intensity = {radiant_intensity:?}").unwrap();
    }
    let path = scene(home.path(), &text);
    let standard = render(&path, "standard", &[]);
    assert!(brightest(&standard) > 0.0);
    // What is certain is exact; what is relied on, nearly so.
    for (trust, most) in [("512", 0.001), ("4000000000", 1.0e-6)] {
        let film = render(&path, "lie", &["--trust", trust]);
        let figures = lie_render::compare(&film, &standard, 0.0).unwrap();
        assert!(figures.relative_rmse < most, "trust {trust}: {figures:?}");
    }
}

#[test]
fn parameters_out_of_range_end_in_2_with_file_and_place() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("scene.toml");
    for generator in ["gallery", "bar", "mosque", "science-center"] {
        let text = format!("[[geometry]]\ngenerator = \"{generator}\"\ndetail = 4.5\n");
        std::fs::write(&path, text).unwrap();
        let mut command = support::lie();
        command.arg("render").arg(&path).args(["--out", "a.exr"]);
        let message = support::failure(&mut command, 2);
        for piece in ["scene.toml:3:10:", "at most 4"] {
            assert!(message.contains(piece), "{generator}: {message}");
        }
    }
}
