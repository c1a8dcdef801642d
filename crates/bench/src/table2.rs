//! The paper's Table 2: what the time of a frame with LIEs goes to.

use serde_json::{Value, json};

use crate::{
    BenchError, Contender, Figure, FrameRow, Picture, Section, Table, paper,
    plot::{self, Group},
    table::{ms, or_dash, percent},
};

/// The rows that the table is about: LIEs without masking, as in the paper.
fn chosen(rows: &[FrameRow]) -> impl Iterator<Item = &FrameRow> {
    rows.iter().filter(|row| row.contender == Contender::Lie)
}

/// The table, the paper's column for each scene beside ours.
#[must_use]
pub fn table(rows: &[FrameRow]) -> Table {
    let numbers = [
        "threads",
        "visibility ms",
        "unoccluded ms",
        "partial ms",
        "traced ms",
        "total ms",
        "min",
        "max",
        "rel. RMSE",
        "FLIP",
        "paper: visibility / unoccluded / partial / total s",
    ];
    let mut table = Table::new(&["scene"], &numbers);
    for row in chosen(rows) {
        let paper = paper::scene(&row.scene).map(|scene| scene.table2);
        table.push([
            row.scene.clone(),
            row.threads.to_string(),
            ms(row.stages.visibility_ms),
            ms(row.stages.unoccluded_ms),
            ms(row.stages.partial_ms),
            ms(row.stages.full_ms),
            ms(row.frame_ms.median),
            ms(row.frame_ms.min),
            ms(row.frame_ms.max),
            percent(row.relative_rmse),
            format!("{:.5}", row.flip_mean),
            or_dash(paper, |paper| {
                let [visibility, unoccluded, partial, total] = [
                    paper.visibility_s,
                    paper.unoccluded_s,
                    paper.partial_s,
                    paper.total_s,
                ];
                format!("{visibility:.2} / {unoccluded:.2} / {partial:.2} / {total:.2}")
            }),
        ]);
    }
    table
}

/// The rows as JSON.
#[must_use]
pub fn json(rows: &[FrameRow]) -> Value {
    chosen(rows).map(row_json).collect()
}

fn row_json(row: &FrameRow) -> Value {
    let paper = paper::scene(&row.scene).map(|scene| scene.table2);
    json!({
        "scene": row.scene,
        "path": row.path,
        "camera": row.camera,
        "accel": row.accel.name(),
        "threads": row.threads,
        "visibility_ms": row.stages.visibility_ms,
        "unoccluded_ms": row.stages.unoccluded_ms,
        "partial_ms": row.stages.partial_ms,
        "full_ms": row.stages.full_ms,
        "total_ms": row.frame_ms.median,
        "total_ms_min": row.frame_ms.min,
        "total_ms_max": row.frame_ms.max,
        "relative_rmse": row.relative_rmse,
        "flip_mean": row.flip_mean,
        "paper": paper.map(|paper| json!({
            "visibility_s": paper.visibility_s,
            "unoccluded_s": paper.unoccluded_s,
            "partial_s": paper.partial_s,
            "total_s": paper.total_s,
        })),
    })
}

/// What the section's reader has to know.
const ABOUT: [&str; 2] = [
    "Frames with LIEs, without masking. Stages are measured on each thread and shared out \
     among the threads; the total is the frame's time on the wall, with what lies between the \
     stages. *Traced* are shadow rays through the whole scene, for lights that are not \
     trusted yet; the paper has none.",
    "The paper's column is LIE §6, Table 2.",
];

/// The section of a report.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn section(rows: &[FrameRow]) -> Result<Section, BenchError> {
    let most = chosen(rows).map(|row| row.threads).max().unwrap_or(0);
    let widest = chosen(rows).filter(|row| row.threads == most);
    let groups: Vec<Group> = widest
        .map(|row| Group {
            name: row.scene.clone(),
            bars: [
                ("visibility", row.stages.visibility_ms),
                ("unoccluded", row.stages.unoccluded_ms),
                ("partial", row.stages.partial_ms),
                ("traced", row.stages.full_ms),
            ]
            .map(|(name, value)| (name.to_owned(), value))
            .to_vec(),
        })
        .collect();
    let axis = format!("ms, {most} threads");
    let plotted = plot::bars("Where a frame's time goes", &axis, &groups)?;
    let figure = plotted.map(|svg| Figure {
        name: "table2-stages.svg".to_owned(),
        caption: "Where the time of a frame with LIEs goes.".to_owned(),
        picture: Picture::Svg(svg),
    });
    Ok(Section {
        heading: "Table 2: where a frame's time goes".to_owned(),
        paragraphs: ABOUT.map(str::to_owned).to_vec(),
        tables: vec![table(rows)],
        figures: figure.into_iter().collect(),
        ..Section::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lies_have_stages() {
        let rows = crate::table1::tests::rows();
        let text = table(&rows).text();
        assert_eq!(text.lines().count(), 3);
        assert!(text.contains("0.48 / 0.14 / 0.07 / 0.69"), "{text}");
        let json = json(&rows);
        assert_eq!(json.as_array().unwrap().len(), 1);
        assert_eq!(json[0]["partial_ms"], 50.0);
        assert_eq!(json[0]["total_ms"], 100.0);
        assert_eq!(section(&rows).unwrap().figures.len(), 1);
    }
}
