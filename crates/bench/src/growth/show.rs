use serde_json::{Value, json};

use super::{Axis, CONTENDERS, GrowthRow};
use crate::{
    BenchError, Contender, Figure, Picture, Section, Table,
    plot::{self, Axes, Curve},
    table::{memory, ms, or_dash, percent, times},
};

/// The section's heading: another report keeps what stands under it.
pub const HEADING: &str = "Growth with lights and triangles";

/// The table.
#[must_use]
pub fn table(rows: &[GrowthRow]) -> Table {
    let numbers = [
        "lights",
        "triangles",
        "threads",
        "ms",
        "min",
        "max",
        "visibility",
        "traced",
        "speed-up",
        "rel. RMSE",
        "trusted",
        "LIEs",
        "at a shader",
        "construct ms",
        "scene ms",
        "hierarchy ms",
        "hierarchy",
        "process",
        "at most",
    ];
    let mut table = Table::new(&["grows", "integrator"], &numbers);
    for row in rows {
        let frame = &row.frame;
        let lies = frame.contender.uses_lies();
        table.push([
            row.axis.name().to_owned(),
            frame.contender.name().to_owned(),
            row.lights.to_string(),
            row.triangles.to_string(),
            frame.threads.to_string(),
            ms(frame.frame_ms.median),
            ms(frame.frame_ms.min),
            ms(frame.frame_ms.max),
            ms(frame.stages.visibility_ms),
            ms(frame.stages.full_ms),
            or_dash(frame.speedup, |speedup| times(speedup.median)),
            percent(frame.relative_rmse),
            or_dash(lies.then_some(frame.trusted_fraction), percent),
            or_dash(lies.then_some(frame.lie_bytes), memory),
            or_dash(lies.then_some(frame.shader_bytes), memory),
            or_dash(lies.then_some(frame.construct_ms), ms),
            ms(row.build_ms - row.accel_build_ms),
            ms(row.accel_build_ms),
            memory(row.accel_bytes),
            or_dash(row.resident_bytes, memory),
            or_dash(row.peak_bytes, memory),
        ]);
    }
    table
}

/// The rows as JSON: those of frames, with what grows.
#[must_use]
pub fn json(rows: &[GrowthRow]) -> Value {
    let frames: Vec<_> = rows.iter().map(|row| row.frame.clone()).collect();
    let mut values = crate::table1::json(&frames);
    for (index, row) in rows.iter().enumerate() {
        let value = &mut values[index];
        value["grows"] = row.axis.name().into();
        value["lights"] = row.lights.into();
        value["triangles"] = row.triangles.into();
        value["visibility_ms"] = row.frame.stages.visibility_ms.into();
        value["traced_ms"] = row.frame.stages.full_ms.into();
        value["build_ms"] = row.build_ms.into();
        value["accel_build_ms"] = row.accel_build_ms.into();
        value["accel_bytes"] = row.accel_bytes.into();
        value["resident_bytes"] = json!(row.resident_bytes);
        value["peak_bytes"] = json!(row.peak_bytes);
    }
    values
}

/// What the section's reader has to know.
const ABOUT: [&str; 2] = [
    "*Lights*: closed rooms that are all alike, with ten points of light in each; the camera sees the \
     first, and a point there ten lights, however many rooms there are. *Triangles*: the \
     mosque under its hundred lights, carved more and more finely. Times are medians of the frame \
     alone; the integrators render in turn within one run. *Visibility* is what of that goes to camera \
     rays and surfaces, *traced* what goes to lights that LIEs do not answer.",
    "*Construct* is the time in which the LIEs of the view were constructed, *scene* that of making the \
     scene's triangles, once, and *hierarchy* that of building what finds hits in them, with its memory. \
     *LIEs* is their memory with all evidence, *at a shader* without. *Process* is the memory of the whole \
     process with the scene and before there are LIEs, *at most* the most that it had until then, \
     in the steps before too.",
];

/// The section of a report.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn section(rows: &[GrowthRow]) -> Result<Section, BenchError> {
    let figures = [
        figure(rows, Axis::Lights, |row| row.lights)?,
        figure(rows, Axis::Triangles, |row| row.triangles)?,
    ];
    Ok(Section {
        heading: HEADING.to_owned(),
        paragraphs: ABOUT.map(str::to_owned).to_vec(),
        tables: vec![table(rows)],
        figures: figures.into_iter().flatten().collect(),
        ..Section::default()
    })
}

/// Times of frames, and of construction, over what grows.
fn figure(
    rows: &[GrowthRow],
    axis: Axis,
    count: fn(&GrowthRow) -> usize,
) -> Result<Option<Figure>, BenchError> {
    let curve = |name: String, contender: Contender, time: fn(&GrowthRow) -> f64| {
        let own = rows.iter().filter(|row| row.axis == axis);
        let own = own.filter(|row| row.frame.contender == contender);
        Curve {
            name,
            points: own.map(|row| (count(row) as f64, time(row))).collect(),
        }
    };
    let mut curves: Vec<Curve> = CONTENDERS
        .iter()
        .map(|&contender| {
            let name = contender.name().to_owned();
            curve(name, contender, |row| row.frame.frame_ms.median)
        })
        .collect();
    let name = "construction of lie".to_owned();
    let construct_ms = |row: &GrowthRow| row.frame.construct_ms;
    curves.push(curve(name, Contender::Lie, construct_ms));
    let axes = Axes {
        title: &format!("Time of a frame over {}", axis.name()),
        x: axis.name(),
        y: "ms",
        floor: 0.01,
    };
    Ok(plot::curves(&axes, &curves)?.map(|svg| Figure {
        name: format!("growth-{}.svg", axis.name()),
        caption: format!("Time of a frame over the number of {}.", axis.name()),
        picture: Picture::Svg(svg),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_stand_beside_what_grows() {
        let row = |frame, lights| GrowthRow {
            axis: Axis::Lights,
            lights,
            triangles: 4711,
            build_ms: 12.5,
            accel_build_ms: 2.5,
            accel_bytes: 3_000_000,
            peak_bytes: Some(9_000_000),
            resident_bytes: Some(7_000_000),
            frame,
        };
        let frames = crate::table1::tests::rows();
        let rows: Vec<_> = [10, 1000]
            .into_iter()
            .flat_map(|lights| {
                frames
                    .clone()
                    .into_iter()
                    .map(move |frame| row(frame, lights))
            })
            .collect();
        let text = table(&rows).text();
        for part in [
            "lights", "1000", "4711", "300", "3.00×", "7.0 MB", "2000", "3.0 MB", "9.0 MB",
        ] {
            assert!(text.contains(part), "{part} in {text}");
        }
        let json = json(&rows);
        assert_eq!(
            (&json[3]["lights"], &json[3]["integrator"]),
            (&1000.into(), &"lie".into())
        );
        let section = section(&rows).unwrap();
        let names: Vec<&str> = section.figures.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(
            names,
            ["growth-lights.svg"],
            "nothing is known of triangles"
        );
    }
}
