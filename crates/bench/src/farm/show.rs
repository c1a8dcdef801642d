use serde_json::{Value, json};

use super::FarmRow;
use crate::{
    Section, Table,
    table::{memory, ms, percent, times},
};

/// The table.
#[must_use]
pub fn table(rows: &[FarmRow]) -> Table {
    let numbers = [
        "threads",
        "local ms",
        "farm ms",
        "farm/local",
        "min",
        "max",
        "render",
        "wait",
        "pack",
        "rest",
        "unpack",
        "first tile",
        "pixels",
        "differ",
        "trusted",
    ];
    let mut table = Table::new(&["scene"], &numbers);
    for row in rows {
        let parts = &row.parts;
        table.push([
            row.scene.clone(),
            row.threads.to_string(),
            ms(row.local_ms.median),
            ms(row.farm_ms.median),
            times(row.ratio.median),
            times(row.ratio.min),
            times(row.ratio.max),
            ms(parts.render_ms),
            ms(parts.idle_ms),
            ms(parts.pack_ms),
            ms(parts.rest_ms),
            ms(parts.unpack_ms),
            ms(parts.latency_ms),
            memory(row.pixel_bytes),
            percent(row.differing),
            percent(row.trusted_fraction),
        ]);
    }
    table
}

/// The rows as JSON.
#[must_use]
pub fn json(rows: &[FarmRow]) -> Value {
    rows.iter().map(row_json).collect()
}

fn row_json(row: &FarmRow) -> Value {
    json!({
        "scene": row.scene,
        "path": row.path,
        "camera": row.camera,
        "accel": row.accel.name(),
        "threads": row.threads,
        "local_ms": row.local_ms.median,
        "local_ms_min": row.local_ms.min,
        "local_ms_max": row.local_ms.max,
        "farm_ms": row.farm_ms.median,
        "farm_ms_min": row.farm_ms.min,
        "farm_ms_max": row.farm_ms.max,
        "ratio": row.ratio.median,
        "ratio_min": row.ratio.min,
        "ratio_max": row.ratio.max,
        "idle_ms": row.parts.idle_ms,
        "render_ms": row.parts.render_ms,
        "pack_ms": row.parts.pack_ms,
        "rest_ms": row.parts.rest_ms,
        "unpack_ms": row.parts.unpack_ms,
        "latency_ms": row.parts.latency_ms,
        "pixel_bytes": row.pixel_bytes,
        "differing": row.differing,
        "trusted_fraction": row.trusted_fraction,
    })
}

/// What the section's reader has to know.
const ABOUT: [&str; 2] = [
    "A client, a constructor and one shader on this machine, over TCP, beside the same frame in one \
     process; both on as many threads, in turn, with the same LIEs, which are frozen. Audits are \
     off. The ratio is the median of those of each turn.",
    "*Render*, *wait* (for tiles) and *pack* are times of the shader's threads, shared out among them; \
     *rest* is what is left of the farm's time: the first request's way, the last tile's, and threads \
     that had no tile left when others had. *Unpack* is the client's, meanwhile. *Differ* is the share of pixels \
     that are not those of the one process.",
];

/// The section of a report.
#[must_use]
pub fn section(rows: &[FarmRow]) -> Section {
    Section {
        heading: "A farm beside one process".to_owned(),
        paragraphs: ABOUT.map(str::to_owned).to_vec(),
        tables: vec![table(rows)],
        ..Section::default()
    }
}
