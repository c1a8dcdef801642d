use serde_json::{Value, json};

use super::{ConvergeRow, ConvergeSummary, Mode};
use crate::{
    BenchError, Figure, Picture, Section, Table,
    plot::{self, Axes, Curve},
    report::file_stem,
    table::{memory, ms, or_dash, percent},
};

/// All marks.
#[must_use]
pub fn table(rows: &[ConvergeRow]) -> Table {
    let numbers = [
        "construction s",
        "samples",
        "passes",
        "rel. RMSE",
        "FLIP",
        "trusted",
        "frame ms",
        "audited rays",
        "wrong",
        "audit ms",
    ];
    let mut table = Table::new(&["scene", "mode"], &numbers);
    for row in rows {
        table.push([
            row.scene.clone(),
            row.mode.name().to_owned(),
            format!("{:.2}", 1.0e-3 * row.time_ms),
            row.samples.to_string(),
            format!("{:.2}", row.passes),
            percent(row.relative_rmse),
            format!("{:.5}", row.flip_mean),
            percent(row.trusted_fraction),
            ms(row.frame_ms),
            or_dash(row.audit, |audit| audit.rays.to_string()),
            or_dash(row.audit, |audit| percent(audit.wrong_fraction())),
            or_dash(row.audit, |audit| ms(audit.time_ms)),
        ]);
    }
    table
}

/// Each scene and mode in one line.
#[must_use]
pub fn summary_table(summary: &[ConvergeSummary]) -> Table {
    let numbers = [
        "threads",
        "standard ms",
        "first frame ms",
        "its rel. RMSE",
        "converged after s",
        "standard frames",
        "last frame ms",
        "its rel. RMSE",
        "trusted",
        "worst of the walk",
        "LIEs",
    ];
    let mut table = Table::new(&["scene", "mode"], &numbers);
    for line in summary {
        table.push([
            line.scene.clone(),
            line.mode.name().to_owned(),
            line.threads.to_string(),
            ms(line.standard_frame_ms.median),
            ms(line.first_frame_ms.median),
            percent(line.first_frame_relative_rmse),
            or_dash(line.converged_ms, |time| format!("{:.2}", 1.0e-3 * time)),
            or_dash(line.converged_standard_frames(), |frames| {
                format!("{frames:.1}")
            }),
            ms(line.last_frame_ms),
            percent(line.last_frame_relative_rmse),
            percent(line.last_frame_trusted_fraction),
            or_dash(line.worst_walk_relative_rmse, percent),
            memory(line.lie_bytes),
        ]);
    }
    table
}

/// The marks as JSON.
#[must_use]
pub fn rows_json(rows: &[ConvergeRow]) -> Value {
    let row = |row: &ConvergeRow| {
        json!({
            "scene": row.scene,
            "mode": row.mode.name(),
            "time_ms": row.time_ms,
            "samples": row.samples,
            "passes": row.passes,
            "relative_rmse": row.relative_rmse,
            "flip_mean": row.flip_mean,
            "trusted_fraction": row.trusted_fraction,
            "frame_ms": row.frame_ms,
            "audit_rays": row.audit.map(|audit| audit.rays),
            "audit_wrong": row.audit.map(|audit| audit.wrong),
            "audit_ms": row.audit.map(|audit| audit.time_ms),
        })
    };
    rows.iter().map(row).collect()
}

/// The summary as JSON.
#[must_use]
pub fn summary_json(summary: &[ConvergeSummary]) -> Value {
    let line = |line: &ConvergeSummary| {
        json!({
            "scene": line.scene,
            "path": line.path,
            "camera": line.camera,
            "mode": line.mode.name(),
            "threads": line.threads,
            "standard_frame_ms": line.standard_frame_ms.median,
            "standard_frame_ms_min": line.standard_frame_ms.min,
            "standard_frame_ms_max": line.standard_frame_ms.max,
            "converged_ms": line.converged_ms,
            "converged_standard_frames": line.converged_standard_frames(),
            "first_frame_ms": line.first_frame_ms.median,
            "first_frame_ms_min": line.first_frame_ms.min,
            "first_frame_ms_max": line.first_frame_ms.max,
            "first_frame_relative_rmse": line.first_frame_relative_rmse,
            "last_frame_ms": line.last_frame_ms,
            "last_frame_relative_rmse": line.last_frame_relative_rmse,
            "last_frame_trusted_fraction": line.last_frame_trusted_fraction,
            "worst_walk_relative_rmse": line.worst_walk_relative_rmse,
            "lie_bytes": line.lie_bytes,
        })
    };
    summary.iter().map(line).collect()
}

/// What the section's reader has to know, beside the modes.
const ABOUT: [&str; 2] = [
    "Errors are relative RMSE against the standard's picture. A view has converged when more \
     construction would make its picture neither better nor much cheaper (decision 21); a dash \
     says that this did not happen in the passes or the time given, and *standard frames* is how \
     many frames the standard could have rendered meanwhile. *Trusted* is the share of a frame's \
     light evaluations that LIEs answered. Where very many occluders are in the way the \
     scene itself is asked for good, in all modes that have such a limit. *Audited* are the shadow \
     rays that LIEs answer for in a hundredth of the pixels; they are traced, and *wrong* is the \
     share of the answers that they contradict. Here nothing is mended by it.",
    "The worst of the walk is the largest error among frames a quarter of a second apart, \
     from the middle of the scene's first walkthrough on: LIEs start from nothing with four \
     passes over the view before the first, and then get a quarter of a pass before each frame.",
];

/// What is measured, in which modes.
fn about_modes(summary: &[ConvergeSummary]) -> String {
    let modes = distinct(summary.iter().map(|line| line.mode));
    let modes: Vec<&str> = modes.into_iter().map(Mode::about).collect();
    format!(
        "LIEs of a view, constructed from nothing on all threads. At each mark a frame is \
         rendered with the LIEs so far, on a clock of its own. Mode {}.",
        modes.join("; mode ")
    )
}

/// Each once, in the order in which they come first.
fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = vec![];
    for item in items {
        if !found.contains(&item) {
            found.push(item);
        }
    }
    found
}

/// The section of a report.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn section(rows: &[ConvergeRow], summary: &[ConvergeSummary]) -> Result<Section, BenchError> {
    let scenes = distinct(summary.iter().map(|line| line.scene.as_str()));
    let mut figures = vec![];
    for scene in scenes {
        figures.extend(scene_figures(scene, rows, summary)?);
    }
    Ok(Section {
        heading: "Convergence from a cold start".to_owned(),
        paragraphs: std::iter::once(about_modes(summary))
            .chain(ABOUT.map(str::to_owned))
            .collect(),
        tables: vec![summary_table(summary), table(rows)],
        figures,
        ..Section::default()
    })
}

/// Errors smaller than this are drawn as large as this.
const ERROR_FLOOR: f64 = 1.0e-5;

fn scene_figures(
    scene: &str,
    rows: &[ConvergeRow],
    summary: &[ConvergeSummary],
) -> Result<Vec<Figure>, BenchError> {
    let error = |row: &ConvergeRow| row.relative_rmse;
    let seconds = |row: &ConvergeRow| 1.0e-3 * row.time_ms;
    let by_time = courses(scene, rows, seconds, error);
    let by_passes = courses(scene, rows, |row| row.passes, error);
    let mut frames = courses(scene, rows, seconds, |row| row.frame_ms);
    let standard = summary.iter().find(|line| line.scene == scene);
    if let Some(standard) = standard {
        let times = rows
            .iter()
            .filter(|row| row.scene == scene && row.time_ms > 0.0);
        let mut points: Vec<(f64, f64)> = times
            .map(|row| (seconds(row), standard.standard_frame_ms.median))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        frames.push(Curve {
            name: "standard".to_owned(),
            points,
        });
    }
    let figure = |kind: &str, caption: &str, x: &str, y: &str, curves: &[Curve]| {
        let title = format!("{scene}: {y}");
        let axes = Axes {
            title: &title,
            x,
            y,
            floor: ERROR_FLOOR,
        };
        Ok::<_, BenchError>(plot::curves(&axes, curves)?.map(|svg| Figure {
            name: format!("converge-{}-{kind}.svg", file_stem(scene)),
            caption: format!("{scene}: {caption}"),
            picture: Picture::Svg(svg),
        }))
    };
    let time_axis = "seconds of construction";
    let note = "error {} from the first construction on; what is below 0.001 % is drawn there.";
    let figures = [
        figure(
            "error-time",
            &note.replace("{}", "over time"),
            time_axis,
            "relative RMSE",
            &by_time,
        )?,
        figure(
            "error-samples",
            &note.replace("{}", "over samples"),
            "samples per pixel",
            "relative RMSE",
            &by_passes,
        )?,
        figure(
            "frames",
            "time of a frame with the LIEs so far.",
            time_axis,
            "ms of a frame",
            &frames,
        )?,
    ];
    Ok(figures.into_iter().flatten().collect())
}

/// One curve for each mode.
fn courses(
    scene: &str,
    rows: &[ConvergeRow],
    x: impl Fn(&ConvergeRow) -> f64,
    y: impl Fn(&ConvergeRow) -> f64,
) -> Vec<Curve> {
    let rows = || rows.iter().filter(|row| row.scene == scene);
    let of_mode = |mode: Mode| Curve {
        name: mode.name().to_owned(),
        points: rows()
            .filter(|row| row.mode == mode)
            .map(|row| (x(row), y(row)))
            .collect(),
    };
    let modes = distinct(rows().map(|row| row.mode));
    modes.into_iter().map(of_mode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Spread;

    fn rows() -> Vec<ConvergeRow> {
        let row = |mode, time_ms, relative_rmse| ConvergeRow {
            audit: None,
            scene: "bar".to_owned(),
            mode,
            time_ms,
            samples: time_ms as u64,
            passes: 1.0e-3 * time_ms,
            relative_rmse,
            flip_mean: 0.5 * relative_rmse,
            trusted_fraction: 0.5,
            frame_ms: 80.0,
        };
        vec![
            row(Mode::Paper, 0.0, 1.0),
            row(Mode::Paper, 100.0, 0.1),
            row(Mode::Trust, 0.0, 0.0),
            row(Mode::Trust, 120.0, 0.0),
        ]
    }

    fn summary() -> Vec<ConvergeSummary> {
        let line = |mode, converged_ms, worst_walk_relative_rmse| ConvergeSummary {
            scene: "bar".to_owned(),
            path: "scenes/bar".to_owned(),
            camera: "room".to_owned(),
            mode,
            threads: 2,
            standard_frame_ms: Spread {
                median: 200.0,
                min: 190.0,
                max: 210.0,
            },
            converged_ms,
            first_frame_ms: Spread {
                median: 90.0,
                min: 80.0,
                max: 91.0,
            },
            first_frame_relative_rmse: 1.0,
            last_frame_ms: 80.0,
            last_frame_relative_rmse: 0.1,
            last_frame_trusted_fraction: 0.5,
            worst_walk_relative_rmse,
            lie_bytes: 1000,
        };
        vec![
            line(Mode::Paper, Some(100.0), Some(0.2)),
            line(Mode::Trust, None, None),
        ]
    }

    #[test]
    fn what_did_not_happen_is_null() {
        let json = summary_json(&summary());
        assert_eq!(json[0]["converged_ms"], 100.0);
        assert_eq!(json[0]["converged_standard_frames"], 0.5);
        assert!(json[1]["converged_ms"].is_null());
        assert!(json[1]["converged_standard_frames"].is_null());
        assert!(json[1]["worst_walk_relative_rmse"].is_null());
        assert!(summary_table(&summary()).text().contains('–'));
        assert_eq!(rows_json(&rows()).as_array().unwrap().len(), 4);
    }

    #[test]
    fn modes_that_were_measured_are_explained_and_drawn() {
        let text = section(&rows(), &summary()).unwrap().paragraphs.join("");
        for mode in Mode::ALL {
            assert_eq!(
                text.contains(mode.about()),
                [Mode::Paper, Mode::Trust].contains(&mode),
                "{text}"
            );
        }
        let mut rows = rows();
        rows.truncate(1);
        rows[0].mode = Mode::InOrder;
        let drawn = courses("bar", &rows, |_| 1.0, |row| row.relative_rmse);
        let names: Vec<&str> = drawn.iter().map(|curve| curve.name.as_str()).collect();
        assert_eq!(names, ["in-order"]);
    }

    #[test]
    fn each_scene_has_three_plots() {
        let section = section(&rows(), &summary()).unwrap();
        let names: Vec<&str> = section
            .figures
            .iter()
            .map(|figure| figure.name.as_str())
            .collect();
        assert_eq!(
            names,
            [
                "converge-bar-error-time.svg",
                "converge-bar-error-samples.svg",
                "converge-bar-frames.svg"
            ]
        );
    }
}
