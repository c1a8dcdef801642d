use serde_json::{Value, json};

use super::{Phase, ScaleRow};
use crate::{
    BenchError, Figure, Picture, Section, Table,
    plot::{self, Axes, Curve},
    table::{memory, ms, or_dash, percent},
};

/// The section's heading: another report keeps what stands under it.
pub const HEADING: &str = "Scale, with simulated shaders";

/// The tables: frames, and what they took.
#[must_use]
pub fn table(rows: &[ScaleRow]) -> [Table; 2] {
    [frames(rows), resources(rows)]
}

fn frames(rows: &[ScaleRow]) -> Table {
    let numbers = [
        "slowed",
        "tiles",
        "side",
        "frames",
        "ms",
        "p95",
        "first tile",
        "efficiency",
        "of largest",
        "tiles/s",
        "clock late",
        "twice ‰",
    ];
    let mut table = Table::new(&["shaders", "constructor"], &numbers);
    for (row, name, phase) in phases(rows) {
        table.push([
            row.shaders.to_string(),
            name.to_owned(),
            format!("{}×", row.slow_down),
            phase.tiles.to_string(),
            phase.side.to_string(),
            phase.frames.to_string(),
            ms(phase.frame_ms),
            ms(phase.frame_ms_p95),
            ms(phase.latency_ms),
            percent(phase.efficiency),
            percent(phase.efficiency_of_largest),
            format!("{:.0}", phase.tiles_per_s),
            ms(phase.clock_late_ms),
            format!("{:.1}", phase.reissued_per_mille),
        ]);
    }
    table
}

fn resources(rows: &[ScaleRow]) -> Table {
    let numbers = [
        "slowed",
        "client CPU",
        "constructor CPU",
        "simulation CPU",
        "out/s",
        "out/s and shader",
        "versions/s",
        "most lag",
    ];
    let mut table = Table::new(&["shaders", "constructor"], &numbers);
    let cpu = |cpu: Option<f64>| or_dash(cpu, |cpu| format!("{cpu:.2}"));
    for (row, name, phase) in phases(rows) {
        let (used, bytes) = (&phase.used, phase.used.sent_bytes_per_s);
        table.push([
            row.shaders.to_string(),
            name.to_owned(),
            format!("{}×", row.slow_down),
            cpu(used.client_cpu),
            cpu(used.constructor_cpu),
            cpu(used.shaders_cpu),
            memory(bytes as u64),
            memory((bytes / row.shaders.max(1) as f64) as u64),
            format!("{:.1}", used.versions_per_s),
            used.most_lag.to_string(),
        ]);
    }
    table
}

fn phases(rows: &[ScaleRow]) -> impl Iterator<Item = (&ScaleRow, &'static str, &Phase)> {
    rows.iter()
        .flat_map(|row| [(row, "still", &row.still), (row, "learns", &row.learning)])
}

/// The rows as JSON. What is not said to be of learning is of still frames.
#[must_use]
pub fn json(rows: &[ScaleRow]) -> Value {
    rows.iter().map(row_json).collect()
}

fn row_json(row: &ScaleRow) -> Value {
    let mut value = phase_json(&row.still);
    value["shaders"] = row.shaders.into();
    value["simulated"] = true.into();
    value["slow_down"] = row.slow_down.into();
    value["learning"] = phase_json(&row.learning);
    // What goes out is of interest while there is something to send.
    value["constructor_bytes_per_s"] = row.learning.used.sent_bytes_per_s.into();
    value
}

fn phase_json(phase: &Phase) -> Value {
    let used = &phase.used;
    json!({
        "frames": phase.frames,
        "tiles": phase.tiles,
        "tile_side": phase.side,
        "efficiency": phase.efficiency,
        "efficiency_of_largest": phase.efficiency_of_largest,
        "frame_ms": phase.frame_ms,
        "frame_ms_p95": phase.frame_ms_p95,
        "first_tile_ms": phase.latency_ms,
        "tiles_per_s": phase.tiles_per_s,
        "clock_late_ms": phase.clock_late_ms,
        "reissued_per_mille": phase.reissued_per_mille,
        "client_cpu": used.client_cpu,
        "constructor_cpu": used.constructor_cpu,
        "simulation_cpu": used.shaders_cpu,
        "constructor_bytes_per_s": used.sent_bytes_per_s,
        "versions_per_s": used.versions_per_s,
        "most_lag": used.most_lag,
    })
}

/// What the section's reader has to know, beside what was recorded.
const ABOUT: [&str; 3] = [
    "**Simulated.** Constructor, client and scheduler are the real ones, each a process, over TCP on this \
     machine; the shaders are one process that keeps a connection of its own to each of the others for \
     every shader, takes for each tile the time that was recorded of it, as often as *slowed* says, and answers with \
     as many bytes. It reads the versions of the LIEs' updates and not their cells. All of them share the cores of this machine.",
    "*Efficiency*: the recorded costs of all the frame's tiles (slowed), divided by the number of shaders times the frame's \
     time; the median of all frames. Frames follow each other and do not overlap, so that a frame's end, where \
     some shaders have no tile any more, counts in full. *Of largest* takes the costs of the largest tiles, which one shader \
     would have: small ones cost more in all, so this is speed-up divided by shaders. *Clock late* is by how much \
     the simulation was late by itself, tile by tile; it counts as the farm's time.",
    "*Still*: the constructor has nothing to do. *Learns*: it constructs on one thread what a moving camera sees, and \
     sends it to all shaders, while frames are rendered. *CPU* is in cores. *Lag* is in versions of the LIEs, of the \
     shader that was behind most by its last report, which is up to a second old.",
];

/// The section of a report. `of` says what was recorded.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn section(rows: &[ScaleRow], of: String) -> Result<Section, BenchError> {
    let mut paragraphs = vec![of];
    paragraphs.extend(ABOUT.map(str::to_owned));
    Ok(Section {
        heading: HEADING.to_owned(),
        paragraphs,
        tables: table(rows).to_vec(),
        figures: figures(rows)?,
        ..Section::default()
    })
}

fn figures(rows: &[ScaleRow]) -> Result<Vec<Figure>, BenchError> {
    let curve = |name: &str, value: &dyn Fn(&ScaleRow) -> f64| Curve {
        name: name.to_owned(),
        points: first_of_each(rows)
            .map(|row| (row.shaders as f64, value(row)))
            .collect(),
    };
    let efficiency = [
        curve("still", &|row| 100.0 * row.still.efficiency),
        curve("still, of largest tiles", &|row| {
            100.0 * row.still.efficiency_of_largest
        }),
        curve("while the constructor learns", &|row| {
            100.0 * row.learning.efficiency
        }),
    ];
    let bytes = [curve("to all shaders", &|row| {
        1.0e-6 * row.learning.used.sent_bytes_per_s
    })];
    let latency = [
        curve("frame", &|row| row.still.frame_ms),
        curve("first tile", &|row| row.still.latency_ms),
    ];
    let plots: [(&str, &str, &str, &[Curve]); 3] = [
        (
            "scale-efficiency",
            "Efficiency over shaders (simulated)",
            "%",
            &efficiency,
        ),
        (
            "scale-bytes",
            "What a constructor that learns sends (simulated shaders)",
            "MB/s",
            &bytes,
        ),
        (
            "scale-latency",
            "Time of a frame over shaders (simulated)",
            "ms",
            &latency,
        ),
    ];
    let mut figures = vec![];
    for (name, title, unit, curves) in plots {
        let axes = Axes {
            title,
            x: "shaders",
            y: unit,
            floor: 0.001,
        };
        if let Some(svg) = plot::curves(&axes, curves)? {
            figures.push(Figure {
                name: format!("{name}.svg"),
                caption: format!("{title}."),
                picture: Picture::Svg(svg),
            });
        }
    }
    Ok(figures)
}

/// Of rows with as many shaders the first.
fn first_of_each(rows: &[ScaleRow]) -> impl Iterator<Item = &ScaleRow> {
    let is_first = |&(index, row): &(usize, &ScaleRow)| {
        let before = &rows[..index];
        before.iter().all(|other| other.shaders != row.shaders)
    };
    rows.iter().enumerate().filter(is_first).map(|(_, row)| row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_of_shaders_is_drawn_once_and_listed_always() {
        let row = |shaders, slow_down| ScaleRow {
            shaders,
            slow_down,
            still: Phase {
                efficiency: 0.9,
                frame_ms: 12.0,
                latency_ms: 1.0,
                ..Phase::default()
            },
            learning: Phase::default(),
        };
        let rows = [row(1, 1.0), row(24, 1.0), row(24, 0.5)];
        let drawn: Vec<_> = first_of_each(&rows).map(|row| row.slow_down).collect();
        assert_eq!(drawn, [1.0, 1.0]);
        let json = json(&rows);
        assert_eq!(json[2]["shaders"], 24);
        assert_eq!(json[2]["simulated"], true);
        assert_eq!(json[0]["efficiency"], 0.9);
        assert_eq!(json[0]["client_cpu"], Value::Null);
        let section = section(&rows, "of something".to_owned()).unwrap();
        assert_eq!(section.figures.len(), 3);
        assert!(section.tables[0].text().contains("0.5×"));
    }
}
