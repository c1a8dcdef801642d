use super::*;
use glam::UVec2;

fn report() -> Report {
    let mut table = Table::new(&["scene"], &["ms"]);
    table.push(["bar".to_owned(), "12".to_owned()]);
    let figure = |name: &str, picture| Figure {
        name: name.to_owned(),
        caption: "A caption.".to_owned(),
        picture,
    };
    let tone_map = ToneMap {
        exposure_stops: 0.0,
        curve: lie_render::ToneCurve::Aces,
    };
    let frame = Picture::Frame(Film::new(UVec2::splat(2)), tone_map);
    Report {
        title: "Results".to_owned(),
        command_line: "lie bench table1".to_owned(),
        machine: Machine::here(),
        sections: vec![Section {
            heading: "Times".to_owned(),
            paragraphs: vec!["Of frames.".to_owned()],
            tables: vec![table],
            figures: vec![
                figure("plot.svg", Picture::Svg("<svg/>".to_owned())),
                figure("bar.png", frame),
            ],
            panels: vec![Panel {
                columns: 2,
                figures: ["a.svg", "b.svg", "c d.svg"]
                    .map(|name| figure(name, Picture::Svg(String::new())))
                    .into(),
            }],
        }],
    }
}

#[test]
fn a_report_names_its_machine_and_links_its_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.md");
    report().write(&path).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    for part in [
        "# Results",
        "    lie bench table1",
        "| cores |",
        "## Times",
        "| bar | 12 |",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    for name in ["plot.svg", "bar.png", "a.svg", "b.svg", "c d.svg"] {
        let link = name.replace(' ', "%20");
        assert!(text.contains(&format!("](results/{link})")), "{text}");
        assert!(folder.path().join("results").join(name).exists());
    }
    let panel = "| A caption. | A caption. |\n|---|---|\n\
                 | ![A caption.](results/a.svg) | ![A caption.](results/b.svg) |\n\
                 | A caption. |  |\n| ![A caption.](results/c%20d.svg) |  |\n";
    assert!(text.contains(panel), "{text}");
}

#[test]
fn what_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let blocked = folder.path().join("results");
    fs::write(&blocked, "a file").unwrap();
    let error = report()
        .write(&folder.path().join("results.md"))
        .unwrap_err();
    assert!(error.to_string().contains("results"), "{error}");
}

#[test]
fn file_names_are_harmless() {
    assert_eq!(file_stem("../Café & bar"), "---caf----bar");
}

#[test]
fn what_another_command_wrote_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.md");
    let other = |text: &str| Section {
        heading: "Growth".to_owned(),
        paragraphs: vec![text.to_owned()],
        figures: vec![Figure {
            name: "growth.svg".to_owned(),
            caption: "Growth.".to_owned(),
            picture: Picture::Svg("<svg/>".to_owned()),
        }],
        ..Section::default()
    };
    let text = || fs::read_to_string(&path).unwrap();
    report().rewrite(&path, &["Growth"]).unwrap();
    assert!(!text().contains("Growth"));
    other("First.").put_into(&path).unwrap();
    report().rewrite(&path, &["Growth"]).unwrap();
    other("Second.").put_into(&path).unwrap();
    let written = text();
    assert!(
        written.starts_with(report().markdown("results").trim_end()),
        "{written}"
    );
    for (part, count) in [
        ("## Growth", 1),
        ("First.", 0),
        ("Second.", 1),
        ("## Times", 1),
    ] {
        assert_eq!(written.matches(part).count(), count, "{part} in {written}");
    }
    assert!(written.contains("](results/growth.svg)"), "{written}");
    assert!(folder.path().join("results/growth.svg").exists());
    report().write(&path).unwrap();
    assert!(!text().contains("Growth"));
}

#[test]
fn what_cannot_be_read_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.md");
    fs::write(&path, [0xff, 0xfe]).unwrap();
    let error = report().rewrite(&path, &["Growth"]).unwrap_err();
    assert!(error.to_string().contains("results.md"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), [0xff, 0xfe]);
}
