//! What table and JSON both say.

use lie_protocol::{ClientStatus, ShaderHealth, ShaderStatus};

/// Mean milliseconds of rendering a tile took a shader since its start.
pub(super) fn tile_ms(shader: &ShaderStatus) -> Option<f64> {
    let report = shader.report.filter(|report| report.tiles > 0)?;
    Some(report.render_ns as f64 * 1.0e-6 / report.tiles as f64)
}

/// Milliseconds that a client's last frame took.
pub(super) fn frame_ms(client: &ClientStatus) -> Option<f64> {
    let report = client.report.filter(|report| report.frame_us > 0)?;
    Some(report.frame_us as f64 * 1.0e-3)
}

/// What a shader is, and how it is: one that replays costs is never taken for one that renders.
pub(super) fn state(shader: &ShaderStatus) -> String {
    let health = health(shader.health);
    if shader.replays {
        format!("replays, {health}")
    } else {
        health.to_owned()
    }
}

/// A shader's health as it is written.
pub(super) fn health(health: ShaderHealth) -> &'static str {
    match health {
        ShaderHealth::Starting => "starting",
        ShaderHealth::Ready => "ready",
        ShaderHealth::Silent => "silent",
    }
}
