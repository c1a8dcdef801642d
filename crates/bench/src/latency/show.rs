use serde_json::{Value, json};

use super::{LatencyRun, StageTimes};
use crate::{
    BenchError, Figure, Picture, Section, Table,
    plot::{self, Group},
    table::{ms, or_dash},
};

/// The section's heading: another report keeps what stands under it.
pub const HEADING: &str = "Latency, from input to picture";

/// The table.
#[must_use]
pub fn table(runs: &[LatencyRun]) -> Table {
    let numbers = ["delay ms", "patience ms", "count", "p50", "p95", "p99"];
    let mut table = Table::new(&["stage"], &numbers);
    for (run, stage) in rows(runs) {
        table.push([
            stage.stage.to_owned(),
            ms(run.delay_ms),
            or_dash(run.patience_ms, ms),
            stage.count.to_string(),
            known(stage.p50_ms),
            known(stage.p95_ms),
            known(stage.p99_ms),
        ]);
    }
    table
}

fn known(value: f64) -> String {
    or_dash((!value.is_nan()).then_some(value), ms)
}

fn rows(runs: &[LatencyRun]) -> impl Iterator<Item = (&LatencyRun, &StageTimes)> {
    runs.iter()
        .flat_map(|run| run.stages.iter().map(move |stage| (run, stage)))
}

/// The rows as JSON.
#[must_use]
pub fn json(runs: &[LatencyRun]) -> Value {
    rows(runs)
        .map(|(run, stage)| {
            json!({
                "stage": stage.stage,
                "delay_ms": run.delay_ms,
                "patience_ms": run.patience_ms,
                "rate": run.rate,
                "shaders": run.shaders,
                "inputs": run.inputs,
                "asked": run.asked,
                "pictures": run.pictures,
                "count": stage.count,
                "p50_ms": stage.p50_ms,
                "p95_ms": stage.p95_ms,
                "p99_ms": stage.p99_ms,
            })
        })
        .collect()
}

/// What the section's reader has to know.
const ABOUT: [&str; 3] = [
    "Somebody moves the camera along the scene's walk; of what is put in, only the newest is asked for, when the \
     frame before is done (or given up: *patience*). Times are in milliseconds since the input, of those inputs that were asked \
     for: until it was *taken up*; until frame and first tiles were handed to the connections (*camera out*); until the \
     first and the last tile had come; until the film was full (*assembled*) and was 8-bit sRGB (*shown*).",
    "*Any input, shown* is of all inputs: until a picture was shown that is as new, or newer. *Stale work \
     stopped* is how long the tile of a new frame waited at its shader while a stale frame of 256 rays per pixel was in work there, \
     at whatever moment it was given up.",
    "*Delay* is added by proxies between all processes, in each direction, and does not limit what passes. The constructor's LIEs are frozen.",
];

/// The section of a report. `of` says what was looked at.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn section(runs: &[LatencyRun], of: String) -> Result<Section, BenchError> {
    let counts = runs.iter().map(|run| {
        format!(
            "With {} ms of delay{}: {} inputs ({} in a second), {} frames asked for, {} pictures.",
            run.delay_ms,
            run.patience_ms
                .map_or(String::new(), |ms| format!(" and {ms} ms of patience")),
            run.inputs,
            run.rate,
            run.asked,
            run.pictures
        )
    });
    let mut paragraphs = vec![of];
    paragraphs.extend(ABOUT.map(str::to_owned));
    paragraphs.extend(counts);
    let groups: Vec<Group> = runs.iter().map(group).collect();
    let svg = plot::bars("From input to picture, p50 and p95", "ms", &groups)?;
    let figures = svg.map(|svg| Figure {
        name: "latency.svg".to_owned(),
        caption: "From input to picture, by delay.".to_owned(),
        picture: Picture::Svg(svg),
    });
    Ok(Section {
        heading: HEADING.to_owned(),
        paragraphs,
        tables: vec![table(runs)],
        figures: figures.into_iter().collect(),
        ..Section::default()
    })
}

fn group(run: &LatencyRun) -> Group {
    let of = |name: &str| run.stages.iter().find(|stage| stage.stage == name);
    let bars = ["first tile", "shown"].into_iter().filter_map(|name| {
        let stage = of(name)?;
        let both = [("p50", stage.p50_ms), ("p95", stage.p95_ms)];
        Some(both.map(|(share, ms)| (format!("{name}, {share}"), ms)))
    });
    let patience = run.patience_ms;
    let patience = patience.map_or(String::new(), |ms| format!(", patience {ms} ms"));
    Group {
        name: format!("{} ms{patience}", run.delay_ms),
        bars: bars.flatten().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_listed_by_run_and_what_was_not_seen_is_a_dash() {
        let stage = |stage, p50_ms| StageTimes {
            stage,
            count: 3,
            p50_ms,
            p95_ms: 2.0 * p50_ms,
            p99_ms: 3.0 * p50_ms,
        };
        let run = |delay_ms| LatencyRun {
            delay_ms,
            patience_ms: None,
            rate: 1000.0,
            shaders: 1,
            inputs: 9,
            asked: 4,
            pictures: 3,
            stages: vec![stage("shown", 10.0 + delay_ms), stage("other", f64::NAN)],
        };
        let runs = [run(0.0), run(5.0)];
        let text = table(&runs).text();
        for part in ["shown", "10.0", "30.0", "45.0", "–"] {
            assert!(text.contains(part), "{part} in {text}");
        }
        let json = json(&runs);
        assert_eq!(json[2]["p50_ms"], 15.0);
        assert_eq!(json[1]["p50_ms"], Value::Null);
        let section = section(&runs, "of something".to_owned()).unwrap();
        assert_eq!(section.figures.len(), 1);
        assert!(
            section.paragraphs[4].contains("4 frames"),
            "{:?}",
            section.paragraphs
        );
    }
}
