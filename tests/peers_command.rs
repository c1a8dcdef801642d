//! `lie bench peers`, as the real binary, beside a program that only pretends to render.

#![allow(clippy::unwrap_used)]
#![cfg(unix)]

mod support;

use std::{
    fs,
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;
use support::{cornell, failure, lie, succeeds};

/// Sides of the pictures here.
const SIDE: u32 = 32;

/// A line as the program prints it; `$T` and `$V` are the shell's.
const LINE: &str = "scene.bin v31300 T$T $V median 0.0100 min 0.0090 s  KIND 1024  \
                    1.00 Mray/s  mean 0.5  clean 1/2";

/// A shell script that notes what it is asked for, and then does as it is told for each variant.
fn pretender(folder: &Path, for_each_variant: &str) -> PathBuf {
    let program = folder.join("pretender");
    let asked = folder.join("asked");
    let script = format!(
        "#!/bin/sh\n\
         echo \"$@\" >> {}\n\
         SCENE=$1; shift\n\
         while [ $# -gt 0 ]; do case $1 in\n\
         --threads) T=$2; shift 2;; --variant) VARIANTS=$2; shift 2;;\n\
         --out) OUT=$2; shift 2;; --reps|--area) shift 2;; --nobuild) shift;;\n\
         *) echo \"what is $1?\" >&2; exit 2;; esac; done\n\
         for V in $(echo $VARIANTS | tr , ' '); do\n{for_each_variant}\ndone\n",
        asked.display()
    );
    fs::write(&program, script).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    program
}

/// One that prints what is expected, and whose pictures are grey.
fn good_pretender(folder: &Path) -> PathBuf {
    let picture = folder.join("grey.npy");
    fs::write(&picture, grey()).unwrap();
    let line = |kind: &str| LINE.replace("KIND", kind);
    let script = format!(
        "if [ -n \"$OUT\" ]; then cp {} $OUT.$V.npy; fi\n\
         case $V in prim*) echo \"{}\";; *) echo \"{}\";; esac",
        picture.display(),
        line("primary_rays"),
        line("shadow_rays")
    );
    pretender(folder, &script)
}

/// A picture in NumPy's format.
fn grey() -> Vec<u8> {
    let header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({SIDE}, {SIDE}, 3), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend((0..3 * SIDE * SIDE).flat_map(|_| 0.5_f32.to_le_bytes()));
    bytes
}

fn peers(scene: &Path, program: &Path) -> Command {
    let mut bench = lie();
    bench.args(["bench", "peers"]).arg(scene);
    bench.arg("--embree").arg(program);
    bench.args(["--size", "32x32", "--threads", "1", "--repeat", "2"]);
    bench
}

/// What a command that succeeds prints.
fn printed(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn ours_are_compared_with_what_another_program_says() {
    let folder = tempfile::tempdir().unwrap();
    let program = good_pretender(folder.path());
    let json = folder.path().join("peers.json");
    let mut bench = peers(&cornell(), &program);
    bench.args(["--variants", "prim16,occ1,pix16"]);
    bench.arg("--report").arg(folder.path());
    let text = printed(bench.arg("--json").arg(&json));
    assert!(text.contains("embree pix16 (best)"), "{text}");
    let written: Value = serde_json::from_slice(&fs::read(json).unwrap()).unwrap();
    check_rows(&written["rows"]);
    let ratios = written["ratios"].as_array().unwrap();
    let find = |over: &str, under: &str, version: &str| {
        let is_it = |row: &&Value| {
            row["over"] == over && row["under"] == under && row["version"] == version
        };
        let found = ratios.iter().find(is_it);
        found.unwrap_or_else(|| panic!("no {over} / {under}, {version} in {ratios:?}"))
    };
    for over in ["embree occ1", "embree pix16"] {
        for under in ["standard", "lie"] {
            let ratio = find(over, under, "plain");
            assert!(ratio["peer_relative_rmse"].as_f64().unwrap() > 0.0);
            assert!(ratio["ratio_min"].as_f64() <= ratio["ratio_max"].as_f64());
            assert!(find(over, under, "as it is")["peer_relative_rmse"].is_null());
        }
    }
    find("embree prim16", "visibility", "plain");
    find("embree prim16", "closest hits", "plain");
    for version in ["plain", "as it is"] {
        find("standard", "lie", version);
        find("lie", "visibility", version);
    }
    let report = fs::read_to_string(folder.path().join("peers.md")).unwrap();
    assert!(report.contains("| embree pix16 (best) |"), "{report}");
    assert!(folder.path().join("peers/peers-times.svg").exists());
    check_questions(&fs::read_to_string(folder.path().join("asked")).unwrap());
}

fn check_rows(rows: &Value) {
    let rows = rows.as_array().unwrap();
    assert_eq!(rows.len(), 3 + 2 * 4, "three variants, and twice ours");
    for row in rows {
        let number = |key: &str| row[key].as_f64().unwrap();
        assert_eq!(
            (&row["scene"], &row["threads"]),
            (&"cornell".into(), &1.into())
        );
        assert!(number("frame_ms_min") <= number("frame_ms"), "{row}");
        let who = row["who"].as_str().unwrap();
        if who.starts_with("embree") {
            assert_eq!((number("frame_ms"), number("rays")), (10.0, 1024.0));
            assert_eq!((number("clean_frames"), number("frames")), (2.0, 4.0));
            assert_eq!(row["peer_relative_rmse"], 0.0, "the same picture always");
        }
        if who == "lie" {
            assert!(number("relative_rmse") < 0.02, "{row}");
        }
    }
}

/// Two questions for pictures, the second with more samples on the lamp, and two for times.
fn check_questions(asked: &str) {
    let asked: Vec<&str> = asked.lines().collect();
    assert_eq!(asked.len(), 4, "{asked:?}");
    for (line, part) in [
        (
            0,
            "--threads 1 --reps 0 --variant prim16,occ1,pix16 --area 4 --nobuild --out",
        ),
        (1, "--reps 0 --variant pix16 --area 16 --nobuild --out"),
        (2, "--reps 1 --variant prim16,occ1,pix16 --area 4 --nobuild"),
        (3, "--reps 1 --variant prim16,occ1,pix16 --area 4 --nobuild"),
    ] {
        assert!(asked[line].contains(part), "{part} in {asked:?}");
    }
}

#[test]
fn a_program_that_is_none_of_this_kind_ends_in_2() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("text"), "not a program").unwrap();
    for (program, problem) in [
        (path("nowhere"), "cannot be run"),
        (folder.path().to_owned(), "cannot be run"),
        (path("text"), "cannot be run"),
        (
            pretender(folder.path(), "echo no memory >&2; exit 3"),
            "exit status: 3: no memory",
        ),
    ] {
        let message = failure(&mut peers(&cornell(), &program), 2);
        assert!(message.contains(problem), "{message}");
        assert!(
            message.contains(&program.display().to_string()),
            "{message}"
        );
    }
    for (script, problem) in [
        ("kill -9 $$", "signal: 9"),
        ("echo hello", "printed what is not understood: hello"),
        (":", "printed nothing about 'prim16'"),
        (
            &LINE
                .replace("KIND", "primary_rays")
                .replace("scene", "echo scene"),
            "prim16.npy: cannot be read",
        ),
    ] {
        let program = pretender(folder.path(), script);
        let message = failure(&mut peers(&cornell(), &program), 2);
        assert!(message.contains(problem), "{message}");
    }
}

#[test]
fn what_another_program_cannot_render_is_named_or_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let program = good_pretender(folder.path());
    let scene = folder.path().join("scene.toml");
    let text = "name = \"sunny\"\n[[geometry]]\ngenerator = \"cornell-box\"\n\
                [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0, -1, 0]\n\
                irradiance = [1, 1, 1]\n";
    fs::write(&scene, text).unwrap();
    let message = failure(&mut peers(&scene, &program), 2);
    assert!(message.contains("'sun' (a directional light)"), "{message}");
    assert!(message.contains("--skip-unsupported"), "{message}");
    succeeds(peers(&scene, &program).arg("--skip-unsupported"));
}

#[test]
fn wrong_arguments_end_in_2() {
    let folder = tempfile::tempdir().unwrap();
    let program = good_pretender(folder.path());
    for (arguments, expected) in [
        (&["--size", "40x32"][..], "multiples of 16"),
        (&["--variants", "pix16,--all"], "'--all' is no variant"),
        (&["--variants", ""], "'' is no variant"),
    ] {
        let mut bench = lie();
        bench.args(["bench", "peers"]).arg(cornell());
        let message = failure(bench.arg("--embree").arg(&program).args(arguments), 2);
        assert!(message.contains(expected), "{message}");
    }
    let mut bench = lie();
    let message = failure(bench.args(["bench", "peers"]).arg(cornell()), 2);
    assert!(message.contains("--embree"), "{message}");
}
