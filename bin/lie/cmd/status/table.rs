use std::fmt::Write;

use lie_protocol::{ClientStatus, FarmStatus, ShaderStatus};

use super::words::{frame_ms, state, tile_ms};

/// A farm for people.
pub(super) fn of(address: &str, farm: &FarmStatus) -> String {
    let mut text = constructor(address, farm);
    text.push('\n');
    let version = farm.lies.version;
    if farm.shaders.is_empty() {
        text += "no shader is connected\n";
    } else {
        let rows = farm.shaders.iter().map(|shader| of_shader(shader, version));
        text += &align(&SHADER_COLUMNS, rows);
    }
    text.push('\n');
    if farm.clients.is_empty() {
        text += "no client is connected\n";
    } else {
        text += &align(&CLIENT_COLUMNS, farm.clients.iter().map(of_client));
    }
    text
}

fn constructor(address: &str, farm: &FarmStatus) -> String {
    let (lies, hash) = (&farm.lies, farm.hash.to_string());
    let state = match (lies.frozen, lies.converged) {
        (true, _) => "frozen",
        (false, true) => "converged",
        (false, false) => "learning",
    };
    let rows = [
        (
            "constructor",
            format!("{address}, {}, up {}", farm.build, span(farm.uptime_ms)),
        ),
        (
            "scene",
            format!(
                "{} ({} triangles, {} lights, {})",
                farm.scene,
                grouped(farm.triangles),
                grouped(farm.lights),
                &hash[..12]
            ),
        ),
        (
            "LIEs",
            format!(
                "version {}, {} cells, {} entries, {} occluders, {}, {state}",
                lies.version,
                grouped(lies.cells),
                grouped(lies.entries),
                grouped(lies.occluders),
                bytes(lies.bytes)
            ),
        ),
        (
            "construction",
            format!(
                "{} samples, {}/s",
                grouped(lies.samples),
                short(f64::from(farm.samples_per_s))
            ),
        ),
        (
            "audits",
            format!(
                "{} rays, {} wrong",
                grouped(lies.audit_rays),
                grouped(lies.audit_wrong)
            ),
        ),
        (
            "shaders",
            format!(
                "{} now, {} joined, {} lost, {} sent to them",
                farm.shaders.len(),
                farm.shaders_joined,
                farm.shaders_lost,
                bytes(lies.sent_bytes)
            ),
        ),
        ("clients", format!("{} now", farm.clients.len())),
    ];
    let mut text = String::new();
    for (name, value) in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<13} {value}");
    }
    text
}

const SHADER_COLUMNS: [&str; 12] = [
    "shader", "address", "health", "since", "threads", "tiles", "rays", "ms/tile", "version",
    "lag", "sent", "ping",
];

fn of_shader(shader: &ShaderStatus, newest: u64) -> [String; 12] {
    let report = shader.report;
    let rays = report.map(|report| {
        let rays = [report.camera_rays, report.shadow_rays, report.list_rays];
        rays.iter()
            .fold(0, |sum: u64, &rays| sum.saturating_add(rays))
    });
    let ping = shader.ping_us;
    [
        shader.id.to_string(),
        shader.address.to_string(),
        state(shader),
        span(shader.joined_ms),
        shader.threads.to_string(),
        known(report, |report| grouped(report.tiles)),
        known(rays, |rays| short(rays as f64)),
        known(tile_ms(shader), |ms| format!("{ms:.1}")),
        known(report, |report| report.lie_version.to_string()),
        known(report, |report| {
            newest.saturating_sub(report.lie_version).to_string()
        }),
        bytes(shader.sent_bytes),
        known(ping, |us| format!("{:.1} ms", us as f64 * 1.0e-3)),
    ]
}

const CLIENT_COLUMNS: [&str; 7] = [
    "client",
    "address",
    "since",
    "frames",
    "last frame",
    "lost tiles",
    "late tiles",
];

fn of_client(client: &ClientStatus) -> [String; 7] {
    let report = client.report;
    [
        client.id.to_string(),
        client.address.to_string(),
        span(client.joined_ms),
        known(report, |report| grouped(report.frames)),
        known(frame_ms(client), |ms| format!("{ms:.1} ms")),
        known(report, |report| grouped(report.lost_tiles)),
        known(report, |report| grouped(report.reissued_tiles)),
    ]
}

fn known<T>(value: Option<T>, write: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "-".to_owned(), write)
}

/// Columns as wide as they must be: address and health to the left, numbers to the right.
fn align<const N: usize>(head: &[&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let mut lines = vec![head.map(str::to_owned)];
    lines.extend(rows);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max();
    let widths: Vec<usize> = (0..N).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for line in &lines {
        let cells = line.iter().zip(&widths).enumerate();
        let cells = cells.map(|(column, (cell, &width))| match column {
            1 | 2 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        text += cells.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}

/// A duration in its two largest units.
fn span(milliseconds: u64) -> String {
    let seconds = milliseconds / 1000;
    let (minutes, hours, days) = (seconds / 60, seconds / 3600, seconds / 86_400);
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3600 => format!("{minutes} min {} s", seconds % 60),
        3600..86_400 => format!("{hours} h {} min", minutes % 60),
        _ => format!("{days} d {} h", hours % 24),
    }
}

/// A whole number in groups of three digits.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

fn bytes(count: u64) -> String {
    let (number, prefix) = scaled(count as f64);
    format!("{number} {prefix}B")
}

fn short(number: f64) -> String {
    let (number, prefix) = scaled(number);
    format!("{number} {prefix}").trim_end().to_owned()
}

/// A number with three digits, and a unit's prefix.
fn scaled(mut number: f64) -> (String, &'static str) {
    let mut prefix = "";
    for larger in ["k", "M", "G", "T", "P", "E"] {
        if number < 999.5 {
            break;
        }
        (number, prefix) = (number / 1000.0, larger);
    }
    let decimals = match number {
        _ if prefix.is_empty() => 0,
        n if n < 9.995 => 2,
        n if n < 99.95 => 1,
        _ => 0,
    };
    (format!("{number:.decimals$}"), prefix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, text) in [
            (0, "0 B"),
            (999, "999 B"),
            (1000, "1.00 kB"),
            (12_345, "12.3 kB"),
            (999_600, "1.00 MB"),
            (123_456_789, "123 MB"),
            (u64::MAX, "18.4 EB"),
        ] {
            assert_eq!(bytes(number), text);
        }
        assert_eq!(
            (short(7.0), short(12_300.0)),
            ("7".to_owned(), "12.3 k".to_owned())
        );
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(1_234_567), "1 234 567");
    }

    #[test]
    fn spans_have_their_largest_units() {
        for (milliseconds, text) in [
            (0, "0 s"),
            (59_999, "59 s"),
            (61_000, "1 min 1 s"),
            (3_600_000, "1 h 0 min"),
            (90_000_000, "1 d 1 h"),
        ] {
            assert_eq!(span(milliseconds), text);
        }
    }

    #[test]
    fn columns_are_aligned() {
        let row = |a: &str, b: &str, c: &str| [a.to_owned(), b.to_owned(), c.to_owned()];
        let rows = [row("1", "long:1", "x"), row("10", "b", "")];
        let text = align(&["id", "at", "is"], rows.into_iter());
        assert_eq!(text, "id  at      is\n 1  long:1  x\n10  b\n");
    }
}
