use serde_json::{Value, json};

use super::{Difference, PeerRatio, PeerRow, Version};
use crate::{
    BenchError, Figure, Picture, Section, Spread, Table,
    plot::{self, Group},
    table::{ms, or_dash, percent, times},
};

/// The table of times and errors.
#[must_use]
pub fn table(rows: &[PeerRow]) -> Table {
    let labels = ["scene", "version", "who"];
    let numbers = [
        "threads",
        "ms",
        "min",
        "max",
        "rays",
        "clean",
        "≠ Embree",
        "but 0.1 %",
        "off",
        "≠ standard",
    ];
    let mut table = Table::new(&labels, &numbers);
    for row in rows {
        table.push([
            row.scene.clone(),
            row.version.name().to_owned(),
            marked(&row.who, row.is_best),
            row.threads.to_string(),
            ms(row.frame_ms.median),
            ms(row.frame_ms.min),
            ms(row.frame_ms.max),
            row.rays.to_string(),
            or_dash(row.clean, |clean| {
                format!("{}/{}", clean.frames, clean.tries)
            }),
            or_dash(row.from_peer, |difference| {
                percent(difference.relative_rmse)
            }),
            or_dash(row.from_peer, |difference| {
                percent(difference.relative_rmse_p999)
            }),
            or_dash(row.from_peer, |difference| percent(difference.differing)),
            or_dash(row.relative_rmse, percent),
        ]);
    }
    table
}

/// The table of ratios.
#[must_use]
pub fn ratio_table(ratios: &[PeerRatio]) -> Table {
    let labels = ["scene", "version", "time of", "by that of"];
    let numbers = [
        "threads",
        "ratio",
        "min",
        "max",
        "≠ Embree",
        "off",
        "≠ standard",
    ];
    let mut table = Table::new(&labels, &numbers);
    for row in ratios {
        table.push([
            row.scene.clone(),
            row.version.name().to_owned(),
            marked(&row.over, row.is_best),
            row.under.clone(),
            row.threads.to_string(),
            times(row.ratio.median),
            times(row.ratio.min),
            times(row.ratio.max),
            or_dash(row.from_peer, |difference| {
                percent(difference.relative_rmse)
            }),
            or_dash(row.from_peer, |difference| percent(difference.differing)),
            or_dash(row.relative_rmse, percent),
        ]);
    }
    table
}

fn marked(who: &str, is_best: bool) -> String {
    let mark = if is_best { " (best)" } else { "" };
    format!("{who}{mark}")
}

/// The rows as JSON.
#[must_use]
pub fn json(rows: &[PeerRow]) -> Value {
    rows.iter().map(row_json).collect()
}

fn row_json(row: &PeerRow) -> Value {
    let mut value = json!({
        "scene": row.scene,
        "version": row.version.name(),
        "who": row.who,
        "is_best": row.is_best,
        "threads": row.threads,
        "rays": row.rays,
        "clean_frames": row.clean.map(|clean| clean.frames),
        "frames": row.clean.map(|clean| clean.tries),
        "relative_rmse": row.relative_rmse,
    });
    set_spread(&mut value, "frame_ms", row.frame_ms);
    set_difference(&mut value, row.from_peer);
    value
}

/// The ratios as JSON.
#[must_use]
pub fn ratios_json(ratios: &[PeerRatio]) -> Value {
    ratios.iter().map(ratio_json).collect()
}

fn ratio_json(row: &PeerRatio) -> Value {
    let mut value = json!({
        "scene": row.scene,
        "version": row.version.name(),
        "threads": row.threads,
        "over": row.over,
        "under": row.under,
        "is_best": row.is_best,
        "relative_rmse": row.relative_rmse,
    });
    set_spread(&mut value, "ratio", row.ratio);
    set_difference(&mut value, row.from_peer);
    value
}

fn set_spread(value: &mut Value, key: &str, spread: Spread) {
    value[key] = spread.median.into();
    value[format!("{key}_min")] = spread.min.into();
    value[format!("{key}_max")] = spread.max.into();
}

fn set_difference(value: &mut Value, difference: Option<Difference>) {
    let of = |part: fn(&Difference) -> f64| difference.as_ref().map(part).into();
    value["peer_relative_rmse"] = of(|difference| difference.relative_rmse);
    value["peer_relative_rmse_p999"] = of(|difference| difference.relative_rmse_p999);
    value["peer_differing"] = of(|difference| difference.differing);
}

/// What the section's reader has to know.
const ABOUT: [&str; 3] = [
    "*Embree* is a separate program that renders exact direct light with Intel Embree, and knows \
     matt, flat surfaces of one colour under points, hard spots and parallelograms. The *plain* \
     scene has nothing else: there both render the same. *As it is* ours render the scene with its \
     textures, gloss, normals and lamps; Embree's time stays that of the plain one.",
    "In each round the other program's process comes first, then a frame of each of ours; ratios \
     are of one round's times, and the table has their median. *Best* is Embree's fastest variant \
     with packets of shadow rays. Its times are medians of *clean* frames, in which it had its cores \
     to itself, where there were any; ours are all frames. *visibility* is the stage of the \
     frame with LIEs: hits and the surfaces there; *closest hits* are the packets alone.",
    "*≠ Embree* is the root mean square error against Embree's picture, divided by its mean, and *but \
     0.1 %* the same without the worst thousandth of the pixels: edges of shapes and shadows fall on \
     one pixel or the next. *off* is the share of pixels more than one per cent away. Under area \
     lights that picture has sixteen times as many samples, and all others have their noise. \
     *≠ standard* is the error against our own standard.",
];

/// The section of a report.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn section(rows: &[PeerRow], ratios: &[PeerRatio]) -> Result<Section, BenchError> {
    let most = rows.iter().map(|row| row.threads).max().unwrap_or(0);
    let mut groups: Vec<Group> = vec![];
    let widest = rows.iter().filter(|row| row.threads == most);
    for row in widest.filter(|row| row.version == Version::Plain) {
        if groups.last().is_none_or(|group| group.name != row.scene) {
            groups.push(Group {
                name: row.scene.clone(),
                bars: vec![],
            });
        }
        if let Some(group) = groups.last_mut() {
            group.bars.push((row.who.clone(), row.frame_ms.median));
        }
    }
    let axis = format!("ms, {most} threads");
    let svg = plot::bars("Time of a frame of the plain scene", &axis, &groups)?;
    let figure = svg.map(|svg| Figure {
        name: "peers-times.svg".to_owned(),
        caption: "Time of a frame of the plain scene.".to_owned(),
        picture: Picture::Svg(svg),
    });
    Ok(Section {
        heading: "Beside Embree".to_owned(),
        paragraphs: ABOUT.map(str::to_owned).to_vec(),
        tables: vec![ratio_table(ratios), table(rows)],
        figures: figure.into_iter().collect(),
        ..Section::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::Clean;

    fn spread(median: f64) -> Spread {
        Spread {
            median,
            min: 0.5 * median,
            max: 2.0 * median,
        }
    }

    #[test]
    fn times_and_ratios_stand_beside_errors() {
        let from_peer = Some(Difference {
            relative_rmse: 0.002,
            relative_rmse_p999: 0.0001,
            differing: 0.01,
        });
        let row = PeerRow {
            scene: "bar".to_owned(),
            version: Version::Plain,
            who: "embree pix16".to_owned(),
            is_best: true,
            threads: 2,
            frame_ms: spread(12.0),
            rays: 77,
            clean: Some(Clean {
                frames: 4,
                tries: 5,
            }),
            from_peer,
            relative_rmse: None,
        };
        let ratio = PeerRatio {
            scene: "bar".to_owned(),
            version: Version::Plain,
            threads: 2,
            over: "embree pix16".to_owned(),
            under: "lie".to_owned(),
            is_best: true,
            ratio: spread(3.0),
            from_peer,
            relative_rmse: Some(0.001),
        };
        let (rows, ratios) = ([row], [ratio]);
        let text = table(&rows).text() + &ratio_table(&ratios).text();
        for part in ["pix16 (best)", "12.0", "4/5", "0.2000 %", "3.00×", "–"] {
            assert!(text.contains(part), "{part} in {text}");
        }
        assert_eq!(json(&rows)[0]["peer_differing"], 0.01);
        assert_eq!(ratios_json(&ratios)[0]["ratio_max"], 6.0);
        assert_eq!(section(&rows, &ratios).unwrap().figures.len(), 1);
        assert!(section(&[], &[]).unwrap().figures.is_empty());
    }
}
