//! The paper's Table 1: time and speed-up of a frame, with the error that it has.

use serde_json::{Value, json};

use crate::{
    BenchError, Contender, Figure, FrameRow, Picture, Section, Table, paper,
    plot::{self, Group},
    table::{memory, ms, or_dash, percent, times},
};

/// The table, the paper's figures beside ours.
#[must_use]
pub fn table(rows: &[FrameRow]) -> Table {
    let numbers = [
        "threads",
        "ms",
        "min",
        "max",
        "speed-up",
        "min",
        "max",
        "rel. RMSE",
        "FLIP",
        "trusted",
        "LIEs",
        "paper s",
        "paper speed-up",
    ];
    let mut table = Table::new(&["scene", "integrator"], &numbers);
    for row in rows {
        let paper = paper::time(&row.scene, row.contender);
        let lies = row.contender.uses_lies();
        table.push([
            row.scene.clone(),
            row.contender.name().to_owned(),
            row.threads.to_string(),
            ms(row.frame_ms.median),
            ms(row.frame_ms.min),
            ms(row.frame_ms.max),
            or_dash(row.speedup, |speedup| times(speedup.median)),
            or_dash(row.speedup, |speedup| times(speedup.min)),
            or_dash(row.speedup, |speedup| times(speedup.max)),
            percent(row.relative_rmse),
            format!("{:.5}", row.flip_mean),
            or_dash(lies.then_some(row.trusted_fraction), percent),
            or_dash(lies.then_some(row.lie_bytes), memory),
            or_dash(paper, |paper| format!("{:.2}", paper.frame_s)),
            or_dash(paper, |paper| format!("{:.1}×", paper.speedup)),
        ]);
    }
    table
}

/// The rows as JSON.
#[must_use]
pub fn json(rows: &[FrameRow]) -> Value {
    rows.iter().map(row_json).collect()
}

fn row_json(row: &FrameRow) -> Value {
    let paper = paper::time(&row.scene, row.contender);
    json!({
        "scene": row.scene,
        "path": row.path,
        "camera": row.camera,
        "accel": row.accel.name(),
        "integrator": row.contender.name(),
        "threads": row.threads,
        "frame_ms": row.frame_ms.median,
        "frame_ms_min": row.frame_ms.min,
        "frame_ms_max": row.frame_ms.max,
        "speedup": row.speedup.map(|speedup| speedup.median),
        "speedup_min": row.speedup.map(|speedup| speedup.min),
        "speedup_max": row.speedup.map(|speedup| speedup.max),
        "relative_rmse": row.relative_rmse,
        "flip_mean": row.flip_mean,
        "trusted_fraction": row.trusted_fraction,
        "shadow_rays": row.shadow_rays,
        "lie_bytes": row.lie_bytes,
        "shader_bytes": row.shader_bytes,
        "construct_ms": row.construct_ms,
        "converged": row.converged,
        "paper_frame_s": paper.map(|paper| paper.frame_s),
        "paper_speedup": paper.map(|paper| paper.speedup),
    })
}

/// What the section's reader has to know.
const ABOUT: [&str; 2] = [
    "Each time is the median of the frame alone, construction not counted; the integrators \
     render in turn within one run. A speed-up is the median of the ratios of frames that \
     followed each other. Errors are against the standard's picture: root mean square error \
     of linear radiance divided by its mean, and mean FLIP at the scene's exposure. *Trusted* \
     is the share of light evaluations that the LIEs answered without a ray through the \
     scene; *LIEs* is their memory with all evidence.",
    "The paper's columns are LIE §6, Table 1: Java on ten dual-processor Pentium 4 at 1.7 GHz, \
     and models that ours are only made after. It gives no errors. Ratios may be compared, \
     seconds may not.",
];

/// The section of a report.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn section(rows: &[FrameRow]) -> Result<Section, BenchError> {
    let most = rows.iter().map(|row| row.threads).max().unwrap_or(0);
    let widest: Vec<&FrameRow> = rows.iter().filter(|row| row.threads == most).collect();
    let time = |row: &FrameRow| Some((row.contender.name().to_owned(), row.frame_ms.median));
    let ours = |row: &FrameRow| Some((row.contender.name().to_owned(), row.speedup?.median));
    let papers = |row: &FrameRow| {
        let speedup = paper::time(&row.scene, row.contender)?.speedup;
        Some((format!("{}, paper", row.contender.name()), speedup))
    };
    let times = groups(&widest, |row| time(row).into_iter().collect());
    // The standard's is always one.
    let accelerated: Vec<&FrameRow> = widest
        .iter()
        .filter(|row| row.contender != Contender::Standard)
        .copied()
        .collect();
    let speedups = groups(&accelerated, |row| {
        ours(row).into_iter().chain(papers(row)).collect()
    });
    let figure = |name: &str, caption: &str, title: &str, axis: &str, groups: &[Group]| {
        Ok::<_, BenchError>(plot::bars(title, axis, groups)?.map(|svg| Figure {
            name: format!("table1-{name}.svg"),
            caption: caption.to_owned(),
            picture: Picture::Svg(svg),
        }))
    };
    let time_axis = format!("ms, {most} threads");
    let time = figure(
        "times",
        "Time of a frame.",
        "Time of a frame",
        &time_axis,
        &times,
    )?;
    let speedup = figure(
        "speedups",
        "Speed-up over the standard ray tracer, ours and the paper's.",
        "Speed-up over the standard",
        "times as fast",
        &speedups,
    )?;
    Ok(Section {
        heading: "Table 1: frames".to_owned(),
        paragraphs: ABOUT.map(str::to_owned).to_vec(),
        tables: vec![table(rows)],
        figures: time.into_iter().chain(speedup).collect(),
        ..Section::default()
    })
}

/// One group of bars for each scene, in order.
fn groups(rows: &[&FrameRow], bars: impl Fn(&FrameRow) -> Vec<(String, f64)>) -> Vec<Group> {
    let mut groups: Vec<Group> = vec![];
    for row in rows {
        if groups.last().is_none_or(|group| group.name != row.scene) {
            groups.push(Group {
                name: row.scene.clone(),
                bars: vec![],
            });
        }
        if let Some(group) = groups.last_mut() {
            group.bars.extend(bars(row));
        }
    }
    groups
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{Spread, Stages};

    pub(crate) fn rows() -> Vec<FrameRow> {
        let row = |contender: Contender, median: f64| FrameRow {
            scene: "bar".to_owned(),
            path: "scenes/bar".to_owned(),
            camera: "room".to_owned(),
            accel: lie_render::AccelKind::default(),
            contender,
            threads: 2,
            frame_ms: Spread {
                median,
                min: 0.9 * median,
                max: 1.5 * median,
            },
            speedup: Spread::of(&[300.0 / median]),
            stages: Stages {
                visibility_ms: 20.0,
                unoccluded_ms: 10.0,
                partial_ms: 50.0,
                full_ms: 5.0,
            },
            relative_rmse: 0.001,
            flip_mean: 0.0002,
            trusted_fraction: 0.97,
            shadow_rays: 12,
            lie_bytes: 1_500_000,
            shader_bytes: 1_000_000,
            construct_ms: 2000.0,
            converged: true,
        };
        vec![row(Contender::Standard, 300.0), row(Contender::Lie, 100.0)]
    }

    #[test]
    fn the_papers_figures_stand_beside_ours() {
        let text = table(&rows()).text();
        let lie = text.lines().last().unwrap();
        for part in [
            "bar", "lie", "100", "3.00×", "0.1000 %", "1.5 MB", "0.69", "14.6×",
        ] {
            assert!(lie.contains(part), "{part} in {lie}");
        }
        let json = json(&rows());
        assert_eq!(json[1]["speedup"], 3.0);
        assert_eq!(json[1]["paper_speedup"], 14.6);
        assert_eq!(json[0]["integrator"], "standard");
        let section = section(&rows()).unwrap();
        assert_eq!(section.figures.len(), 2);
    }

    #[test]
    fn without_a_standard_there_is_no_speedup_and_without_rows_no_plot() {
        let mut rows = rows();
        rows.iter_mut().for_each(|row| row.speedup = None);
        assert!(table(&rows).text().contains('–'));
        assert!(json(&rows)[0]["speedup"].is_null());
        assert!(section(&[]).unwrap().figures.is_empty());
    }
}
