//! `lie scene`, as the real binary: what is exported comes back as it was, and odd files end
//! in a picture or in a message.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod support;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    time::{Duration, Instant},
};

use serde_json::Value;
use support::{failure, lie};

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name)
}

/// Runs a command that must succeed; its standard output.
fn success(command: &mut Command) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().unwrap();
    let stderr = String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{command:?}: {stderr}");
    String::from_utf8(stdout).unwrap()
}

fn info(path: &Path, folder: &Path) -> Value {
    let json = folder.join("info.json");
    success(
        lie()
            .args(["scene", "info"])
            .arg(path)
            .arg("--json")
            .arg(&json),
    );
    serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap()
}

fn export(from: &Path, to: &Path) -> String {
    success(lie().args(["scene", "export"]).arg(from).arg(to))
}

/// Kind and number of lights. A rectangle comes back from a file as a mesh of two triangles:
/// both count as `area`.
fn light_counts(info: &Value) -> Vec<(String, u64)> {
    let mut counts: Vec<(String, u64)> = vec![];
    for lights in info["lights"].as_array().unwrap() {
        let kind = match lights["kind"].as_str().unwrap() {
            "rectangle" | "mesh" => "area",
            other => other,
        };
        let count = lights["count"].as_u64().unwrap();
        match counts.iter_mut().find(|(known, _)| known == kind) {
            Some((_, sum)) => *sum += count,
            None => counts.push((kind.to_owned(), count)),
        }
    }
    counts.sort();
    counts
}

fn total_power(info: &Value) -> f64 {
    let lights = info["lights"].as_array().unwrap().iter();
    lights
        .flat_map(|lights| lights["power"].as_array().unwrap())
        .map(|power| power.as_f64().unwrap())
        .sum()
}

#[test]
fn an_exported_glb_is_the_same_scene() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["cornell", "gallery", "science-center"] {
        let glb = folder.path().join(format!("{name}.glb"));
        let said = export(&scene(name), &glb);
        assert!(said.contains(&glb.display().to_string()), "{said}");
        let bytes = fs::metadata(&glb).unwrap().len();
        assert!(said.contains(&format!("{bytes} bytes")), "{said}");

        let (before, after) = (info(&scene(name), folder.path()), info(&glb, folder.path()));
        for key in ["triangles", "cameras", "textures"] {
            assert_eq!(before[key], after[key], "{key} of {name}");
        }
        for key in ["masked", "emissive"] {
            let counts = [&before, &after].map(|info| &info["materials"][key]);
            assert_eq!(counts[0], counts[1], "{key} materials of {name}");
        }
        assert_eq!(light_counts(&before), light_counts(&after), "{name}");
        let (before, after) = (total_power(&before), total_power(&after));
        assert!(
            (after / before - 1.0).abs() < 1.0e-4,
            "{name}: {before} W, {after} W"
        );
    }
}

fn render(from: &Path, out: &Path) {
    let render = ["--integrator", "standard", "--size", "64x64", "--spp", "1"];
    success(
        lie()
            .arg("render")
            .arg(from)
            .args(render)
            .arg("--out")
            .arg(out),
    );
}

/// Relative RMSE of two pictures.
fn distance(a: &Path, b: &Path, folder: &Path) -> f64 {
    let json = folder.join("compare.json");
    success(lie().arg("compare").args([a, b]).arg("--json").arg(&json));
    let figures: Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    figures["relative_rmse"].as_f64().unwrap()
}

#[test]
fn an_exported_cornell_box_gives_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    export(&scene("cornell"), &path("cornell.glb"));
    let render = |from: &Path, out: &str| {
        let samples = ["--light-samples", "1024"];
        let fixed = ["--integrator", "standard", "--size", "48x48", "--spp", "1"];
        let mut command = lie();
        command.arg("render").arg(from).args(fixed).args(samples);
        success(command.arg("--out").arg(path(out)));
    };
    render(&scene("cornell"), "toml.exr");
    render(&path("cornell.glb"), "glb.exr");
    // The lamp has become two triangles, whose samples fall elsewhere: noise remains.
    let distance = distance(&path("toml.exr"), &path("glb.exr"), folder.path());
    assert!(distance < 0.01, "relative RMSE {distance}");
}

#[test]
fn an_obj_comes_with_its_library() {
    let folder = tempfile::tempdir().unwrap();
    let obj = folder.path().join("box.obj");
    let said = export(&scene("cornell"), &obj);
    let mtl = folder.path().join("box.mtl");
    assert!(
        said.contains(&mtl.display().to_string()) && mtl.is_file(),
        "{said}"
    );
    let info = info(&obj, folder.path());
    assert_eq!(info["triangles"], 36);
    assert_eq!(light_counts(&info), [("area".to_owned(), 1)]);
    // Once more over itself is allowed: it is not what it is made from.
    export(&scene("cornell"), &obj);
    let names: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(names.len(), 3, "nothing unfinished is left: {names:?}");
}

#[test]
fn what_a_format_cannot_hold_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let obj = folder.path().join("gallery.obj");
    let output = lie()
        .args(["scene", "export"])
        .args([&scene("gallery"), &obj])
        .output()
        .unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.success() && stderr.contains("WARN"),
        "{stderr}"
    );
}

#[test]
fn generators_follow_their_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let generate = |arguments: &[&str], name: &str| {
        let path = folder.path().join(name);
        success(lie().args(["scene", "generate"]).args(arguments).arg(&path));
        (info(&path, folder.path()), fs::read(&path).unwrap())
    };
    let (cornell, _) = generate(&["cornell-box"], "cornell.glb");
    assert_eq!(cornell["triangles"], 36);
    let rough = ["gallery", "--detail", "0.25"];
    let (gallery, bytes) = generate(&rough, "gallery.glb");
    let (_, again) = generate(&rough, "again.glb");
    let (_, other) = generate(&["gallery", "--detail", "0.25", "--seed", "2"], "other.glb");
    assert!(bytes == again && bytes != other);
    let (finer, _) = generate(&["gallery", "--detail", "0.5"], "finer.glb");
    assert!(finer["triangles"].as_u64() > gallery["triangles"].as_u64());
}

#[test]
fn wrong_arguments_are_named_and_end_in_2() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let cornell = scene("cornell").display().to_string();
    let glb = path("cornell.glb");
    export(&scene("cornell"), Path::new(&glb));
    export(&scene("cornell"), Path::new(&path("taken.obj")));
    fs::rename(path("taken.obj"), path("model.obj")).unwrap();
    let before = fs::read(&glb).unwrap();
    for (arguments, expected) in [
        (vec!["info", "no/such.glb"], "no/such.glb"),
        (vec!["info", "Cargo.lock"], "Cargo.lock"),
        (vec!["export", &cornell, &path("a.stl")], ".glb or .obj"),
        (vec!["export", &cornell, &path("noending")], ".glb or .obj"),
        (vec!["export", &glb, &glb], "replace the scene itself"),
        (vec!["export", &cornell, &path("taken.obj")], "taken.mtl"),
        (vec!["generate", "sponza", &path("a.glb")], "sponza"),
        (vec!["generate", "gallery", &path("a.gltf")], ".glb or .obj"),
        (
            vec!["generate", "gallery", &path("a.glb"), "--detail", "0"],
            "--detail 0",
        ),
        (
            vec!["generate", "gallery", &path("a.glb"), "--detail", "NaN"],
            "--detail NaN",
        ),
        (
            vec!["generate", "gallery", &path("a.glb"), "--seed", "x"],
            "--seed",
        ),
        (
            vec!["generate", "cornell-box", &path("a.glb"), "--seed", "3"],
            "always the same",
        ),
    ] {
        let message = failure(lie().arg("scene").args(&arguments), 2);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert!(fs::read(&glb).unwrap() == before, "the input is as it was");
    let nowhere = path("no/such/folder/a.glb");
    let message = failure(lie().args(["scene", "export", &cornell, &nowhere]), 1);
    assert!(message.contains(&nowhere), "{message}");
}

/// Runs a command to its end: exit code and standard error. A signal, or no end within 20
/// seconds, fails.
fn code_of(command: &mut Command) -> (i32, String) {
    let start = Instant::now();
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(20) {
            child.kill().unwrap();
            panic!("{command:?} takes more than 20 s");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let Output { status, stderr, .. } = child.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&stderr).into_owned();
    let code = status.code();
    (
        code.unwrap_or_else(|| panic!("{command:?}: {status}, {stderr}")),
        stderr,
    )
}

#[test]
fn odd_files_end_in_a_picture_or_in_a_message() {
    let odd = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/odd");
    let Ok(entries) = fs::read_dir(&odd) else {
        println!("skipped: ../shared/odd is not there");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("odd.exr");
    let mut shown = 0;
    for entry in entries {
        let file = entry.unwrap().path();
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let (code, message) = code_of(lie().args(["scene", "info"]).arg(&file));
        check(code, &message, &name);

        let _ = fs::remove_file(&picture);
        let size = ["--size", "32x32", "--out"];
        let mut render = lie();
        render.arg("render").arg(&file).args(size).arg(&picture);
        let (render_code, message) = code_of(&mut render);
        check(render_code, &message, &name);
        assert_eq!(code, render_code, "{name}: info and render agree");
        if render_code == 0 {
            // A picture with a pixel that is no number is refused.
            assert_eq!(distance(&picture, &picture, folder.path()), 0.0, "{name}");
            shown += 1;
        } else {
            assert!(!picture.exists(), "{name}: a picture in spite of the error");
        }
    }
    assert!(shown > 0, "some odd files can be shown");
}

fn check(code: i32, message: &str, name: &str) {
    assert!(code == 0 || code == 2, "{name}: code {code}, {message}");
    assert!(!message.contains("panicked"), "{name}: {message}");
    assert!(
        code == 0 || message.contains(name),
        "{name} is not named: {message}"
    );
}

#[test]
fn a_gallery_renders_from_its_glb() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let glb = path("gallery.glb");
    success(
        lie()
            .args(["scene", "generate", "gallery", "--detail", "0.25"])
            .arg(&glb),
    );
    render(&glb, &path("gallery.exr"));
    assert_eq!(
        distance(&path("gallery.exr"), &path("gallery.exr"), folder.path()),
        0.0
    );
}
