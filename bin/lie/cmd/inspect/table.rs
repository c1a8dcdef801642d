use lie_farm::inspect::{
    Answer, BoundsReport, CellReport, LightClass, LightReport, PixelReport, SeenReport,
};

/// A report for people, line by line: lights by what they give, the others only if `all`.
pub(super) fn lines(report: &PixelReport, all: bool) -> Vec<String> {
    let ([x, y], [width, height]) = (report.pixel, report.size);
    let mut lines = vec![format!(
        "pixel {x},{y} of {width} x {height}, camera {}; {} samples, trust {}",
        report.camera, report.samples, report.trust
    )];
    let Some(seen) = &report.seen else {
        lines.push("there is nothing to see: no surface, and no light on it".into());
        return lines;
    };
    lines.extend(surface(seen));
    lines.extend(cell(&seen.cell));
    lines.extend(totals(seen));
    lines.push(String::new());
    lines.extend(lights(seen, all));
    lines
}

fn surface(seen: &SeenReport) -> Vec<String> {
    let surface = &seen.surface;
    let mut lines = vec![
        format!(
            "surface   {} ({}), triangle {}, {:.3} m away",
            surface.mesh, surface.material, surface.triangle, surface.distance
        ),
        format!(
            "          at {}, normal {}",
            vector(surface.position),
            vector(surface.normal)
        ),
    ];
    if surface.emitted != [0.0; 3] {
        let emitted = vector(surface.emitted);
        lines.push(format!("          it emits {emitted} itself"));
    }
    lines
}

fn cell(cell: &CellReport) -> Vec<String> {
    let path: String = cell
        .path
        .iter()
        .map(|octant| format!("/{octant}"))
        .collect();
    let path = if path.is_empty() { "/" } else { &path };
    let region = match (&cell.region, cell.holds) {
        (None, true) => "the whole cell: without trust it holds everywhere".into(),
        (None, false) => "none yet: every light is traced".into(),
        (Some(region), true) => format!("{}, which holds the point", extent(region)),
        (Some(region), false) => format!(
            "{}, which does not hold the point: every light is traced",
            extent(region)
        ),
    };
    vec![
        format!(
            "cell      {path}, depth {}, {}",
            cell.depth,
            extent(&cell.bounds)
        ),
        format!("region    {region}"),
        format!(
            "samples   {}; {} occluders listed",
            cell.samples, cell.occluders
        ),
    ]
}

fn totals(seen: &SeenReport) -> Vec<String> {
    let totals = &seen.totals;
    let share = |luminance: f64| match totals.luminance {
        0.0 => String::new(),
        whole => format!(" ({:.3} %)", 100.0 * luminance / f64::from(whole)),
    };
    vec![
        format!(
            "light     {:.6}; error {:+.6}{}, expected {:.6}{}",
            totals.luminance,
            totals.error,
            share(totals.error.into()),
            totals.expected_error,
            share(totals.expected_error),
        ),
        format!(
            "rays      {} by the standard, {} saved, {} traced; {} against lists, {} occluder tests",
            totals.standard_rays,
            totals.saved_rays,
            totals.traced_rays,
            totals.list_rays,
            totals.occluder_tests
        ),
    ]
}

fn lights(seen: &SeenReport, all: bool) -> Vec<String> {
    let mut shown: Vec<&LightReport> = seen
        .lights
        .iter()
        .filter(|light| all || matters(light))
        .collect();
    // Stable: of equal lights the one with the lower number goes first.
    shown.sort_by(|a, b| b.luminance.total_cmp(&a.luminance));
    let whole = seen.totals.luminance;
    let mut rows = vec![HEAD.map(str::to_owned)];
    rows.extend(shown.iter().map(|light| row(light, whole)));
    let mut lines = aligned(&rows);
    let left_out = seen.lights.len() - shown.len();
    if left_out > 0 {
        lines.push(format!(
            "{left_out} of {} lights left out: they give nothing, and nobody doubts it (--all)",
            seen.lights.len()
        ));
    }
    lines
}

/// Whether a light gives something, is said to, or may.
fn matters(light: &LightReport) -> bool {
    let is_in_doubt = light.class == LightClass::Doubtful && light.standard_rays > 0;
    light.luminance > 0.0 || light.error != 0.0 || light.expected_error > 0.0 || is_in_doubt
}

const HEAD: [&str; 12] = [
    "light",
    "name",
    "class",
    "answer",
    "agree",
    "share %",
    "light",
    "error",
    "expected",
    "rays",
    "saved",
    "occluders",
];

fn row(light: &LightReport, whole: f32) -> [String; 12] {
    let share = if whole > 0.0 {
        100.0 * light.luminance / whole
    } else {
        0.0
    };
    let name = if light.name.is_empty() {
        light.kind
    } else {
        &light.name
    };
    [
        light.light.to_string(),
        name.to_owned(),
        class(light),
        answer(light.answer).to_owned(),
        light.evidence.map_or("-".into(), |evidence| {
            format!("{}/{}", evidence.agreed, light.needed)
        }),
        format!("{share:.2}"),
        format!("{:.6}", light.luminance),
        or_dash(light.error != 0.0, || format!("{:+.6}", light.error)),
        or_dash(light.expected_error > 0.0, || {
            format!("{:.6}", light.expected_error)
        }),
        light.standard_rays.to_string(),
        light.saved_rays.to_string(),
        occluders(light),
    ]
}

fn or_dash(is_there: bool, text: impl FnOnce() -> String) -> String {
    if is_there { text() } else { "-".into() }
}

fn class(light: &LightReport) -> String {
    let class = match light.class {
        LightClass::ProvenUnoccluded => "proven unoccluded",
        LightClass::CompleteList => "complete list",
        LightClass::ProvenHidden => "proven hidden",
        LightClass::Lit => "lit",
        LightClass::Hidden => "hidden",
        LightClass::Dark => "dark",
        LightClass::MaskedOut => "masked: left out",
        LightClass::MaskedWhole => "masked: shown whole",
        LightClass::Crowded => "crowded",
        LightClass::Doubtful => "doubtful",
    };
    format!("{class}{}", if light.open { ", open" } else { "" })
}

fn answer(answer: Answer) -> &'static str {
    match answer {
        Answer::Unoccluded => "no ray",
        Answer::List => "list",
        Answer::Traced => "traced",
        Answer::Hidden => "nothing",
    }
}

/// How many triangles, and of which meshes the most.
fn occluders(light: &LightReport) -> String {
    const NAMED: usize = 3;
    let mut meshes: Vec<(&str, usize)> = vec![];
    for occluder in &light.occluders {
        let mesh = occluder.triangle.mesh.as_str();
        match meshes.iter_mut().find(|known| known.0 == mesh) {
            Some(known) => known.1 += 1,
            None => meshes.push((mesh, 1)),
        }
    }
    if meshes.is_empty() {
        return "-".into();
    }
    meshes.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    let named: Vec<String> = meshes
        .iter()
        .take(NAMED)
        .map(|(mesh, count)| format!("{mesh} {count}"))
        .collect();
    let more = if meshes.len() > NAMED { ", …" } else { "" };
    format!("{}: {}{more}", light.occluders.len(), named.join(", "))
}

/// Columns of one width; numbers to the right, the last as it is.
fn aligned(rows: &[[String; 12]]) -> Vec<String> {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<usize> = (0..12).map(|column| width(column).unwrap_or(0)).collect();
    let line = |row: &[String; 12]| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(column, (cell, &width))| match column {
            1..=3 => format!("{cell:<width$}"),
            11 => cell.clone(),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<String>>().join("  ")
    };
    rows.iter().map(line).collect()
}

fn vector([x, y, z]: [f32; 3]) -> String {
    format!("({x:.3}, {y:.3}, {z:.3})")
}

fn extent(bounds: &BoundsReport) -> String {
    format!("{} to {}", vector(bounds.min), vector(bounds.max))
}
