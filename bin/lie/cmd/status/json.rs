use lie_protocol::{ClientStatus, FarmStatus, PROTOCOL_VERSION, ShaderStatus};
use serde_json::{Value, json};

use super::words::{frame_ms, health, tile_ms};

/// A farm for scripts. What is not known is null.
pub(super) fn of(address: &str, farm: &FarmStatus) -> Value {
    let lies = &farm.lies;
    json!({
        "constructor": {
            "address": address,
            "build": farm.build.as_str(),
            "protocol_version": PROTOCOL_VERSION,
            "uptime_s": seconds(farm.uptime_ms),
            "scene": {
                "name": farm.scene.as_str(),
                "hash": farm.hash.to_string(),
                "triangles": farm.triangles,
                "lights": farm.lights,
            },
            "lie": {
                "version": lies.version,
                "cells": lies.cells,
                "entries": lies.entries,
                "occluders": lies.occluders,
                "bytes": lies.bytes,
                "converged": lies.converged,
                "frozen": lies.frozen,
                // Infinite as long as nothing was looked at, which JSON cannot say.
                "estimated_error": lies.estimated_error,
            },
            "construct": {
                "samples": lies.samples,
                "samples_per_s": farm.samples_per_s,
            },
            "audit": { "rays": lies.audit_rays, "wrong": lies.audit_wrong },
            "sent_bytes": lies.sent_bytes,
            "shaders_joined": farm.shaders_joined,
            "shaders_lost": farm.shaders_lost,
        },
        "shaders": farm.shaders.iter().map(|shader| of_shader(shader, lies.version)).collect::<Vec<_>>(),
        "clients": farm.clients.iter().map(of_client).collect::<Vec<_>>(),
    })
}

fn of_shader(shader: &ShaderStatus, newest: u64) -> Value {
    let report = shader.report.as_ref();
    json!({
        "id": shader.id,
        "address": shader.address.as_str(),
        "threads": shader.threads,
        "replays": shader.replays,
        "health": health(shader.health),
        "since_s": seconds(shader.joined_ms),
        "heard_s": seconds(shader.heard_ms),
        "ping_ms": shader.ping_us.map(|us| us as f64 * 1.0e-3),
        "sent_bytes": shader.sent_bytes,
        "tiles": report.map(|report| report.tiles),
        "camera_rays": report.map(|report| report.camera_rays),
        "shadow_rays": report.map(|report| report.shadow_rays),
        "list_rays": report.map(|report| report.list_rays),
        "tile_ms": tile_ms(shader),
        "lie_version": report.map(|report| report.lie_version),
        "lie_lag": report.map(|report| newest.saturating_sub(report.lie_version)),
        "clients": report.map(|report| report.clients),
        "outstanding_tiles": report.map(|report| report.outstanding),
        "pixel_bytes": report.map(|report| report.sent_bytes),
    })
}

fn of_client(client: &ClientStatus) -> Value {
    let report = client.report.as_ref();
    json!({
        "id": client.id,
        "address": client.address.as_str(),
        "since_s": seconds(client.joined_ms),
        "cameras": client.cameras,
        "frames": report.map(|report| report.frames),
        "frame_ms": frame_ms(client),
        "lost_tiles": report.map(|report| report.lost_tiles),
        "reissued_tiles": report.map(|report| report.reissued_tiles),
    })
}

fn seconds(milliseconds: u64) -> f64 {
    milliseconds as f64 * 1.0e-3
}
