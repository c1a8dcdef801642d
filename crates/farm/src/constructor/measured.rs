use lie_protocol::{FarmStatus, LieStatus, ShaderHealth, ShaderStatus};

use super::Shared;
use crate::metrics::{Exposition, write_audits, write_bytes, write_process};

impl Shared {
    /// All there is to measure, for Prometheus.
    pub(super) fn metrics(&self) -> String {
        let farm = self.status();
        let mut text = Exposition::default();
        write_process(&mut text, "constructor");
        text.gauge("lie_uptime_seconds", "Time since connections are taken.")
            .value(&[], farm.uptime_ms as f64 * 1.0e-3);
        write_lies(&mut text, &farm.lies);
        write_audits(&mut text, farm.lies.audit_rays, farm.lies.audit_wrong);
        write_members(&mut text, &farm);
        for shader in SHADER_NUMBERS {
            shader.write(&mut text, &farm);
        }
        let traffic = &self.census.traffic;
        let (shaders, clients) = (
            (traffic.to_shaders.get(), traffic.from_shaders.get()),
            (traffic.to_clients.get(), traffic.from_clients.get()),
        );
        write_bytes(
            &mut text,
            &[
                ("shader", shaders.0, shaders.1),
                ("client", clients.0, clients.1),
            ],
        );
        self.refusals.write(&mut text);
        text.into_text()
    }
}

fn write_lies(text: &mut Exposition, lies: &LieStatus) {
    let gauges = [
        (
            "lie_lies_version",
            "Newest version of the LIEs.",
            lies.version,
        ),
        ("lie_lies_cells", "Octree cells.", lies.cells),
        (
            "lie_lies_entries",
            "Pairs of a cell and a light.",
            lies.entries,
        ),
        (
            "lie_lies_occluders",
            "Triples of a cell, a light and a triangle.",
            lies.occluders,
        ),
        ("lie_lies_bytes", "Memory of the LIEs.", lies.bytes),
    ];
    for (name, help, value) in gauges {
        text.gauge(name, help).count(&[], value);
    }
    text.gauge(
        "lie_lies_estimated_error",
        "Relative RMSE to be expected of pictures by LIEs used without trust.",
    )
    .value(&[], f64::from(lies.estimated_error));
    text.gauge(
        "lie_construction_converged",
        "Whether more samples would not help what clients see now.",
    )
    .flag(&[], lies.converged);
    text.counter("lie_construction_samples_total", "Construction samples.")
        .count(&[], lies.samples);
}

fn write_members(text: &mut Exposition, farm: &FarmStatus) {
    let healths = [
        (ShaderHealth::Starting, "starting"),
        (ShaderHealth::Ready, "ready"),
        (ShaderHealth::Silent, "silent"),
    ];
    let mut shaders = text.gauge("lie_shaders", "Connected shaders, by health.");
    for (health, name) in healths {
        let count = farm.shaders.iter().filter(|shader| shader.health == health);
        shaders.count(&[("health", name)], count.count() as u64);
    }
    text.counter("lie_shaders_joined_total", "Shaders that have joined.")
        .count(&[], farm.shaders_joined);
    text.counter(
        "lie_shaders_lost_total",
        "Shaders that left without a word.",
    )
    .count(&[], farm.shaders_lost);
    text.gauge("lie_clients", "Connected clients.")
        .count(&[], farm.clients.len() as u64);
}

/// A number of each shader.
struct ShaderNumber {
    name: &'static str,
    help: &'static str,
    is_counter: bool,
    /// `None` as long as it is not known. The version is the newest.
    of: fn(&ShaderStatus, version: u64) -> Option<f64>,
}

const SHADER_NUMBERS: [ShaderNumber; 7] = [
    ShaderNumber {
        name: "lie_shader_ready",
        help: "Whether the shader is connected, takes clients and is not silent.",
        is_counter: false,
        of: |shader, _| Some(f64::from(u8::from(shader.health == ShaderHealth::Ready))),
    },
    ShaderNumber {
        name: "lie_shader_heard_seconds",
        help: "Time since anything was heard of the shader.",
        is_counter: false,
        of: |shader, _| Some(shader.heard_ms as f64 * 1.0e-3),
    },
    ShaderNumber {
        name: "lie_shader_ping_seconds",
        help: "Time that the last answered ping took.",
        is_counter: false,
        of: |shader, _| shader.ping_us.map(|us| us as f64 * 1.0e-6),
    },
    ShaderNumber {
        name: "lie_shader_lies_lag",
        help: "Versions of the LIEs that the shader is behind, as it says.",
        is_counter: false,
        of: |shader, version| {
            let report = shader.report?;
            Some(version.saturating_sub(report.lie_version) as f64)
        },
    },
    ShaderNumber {
        name: "lie_shader_credits_in_use",
        help: "Tiles that clients have asked of the shader and that are not done, as it says.",
        is_counter: false,
        of: |shader, _| shader.report.map(|report| f64::from(report.outstanding)),
    },
    ShaderNumber {
        name: "lie_shader_tiles_total",
        help: "Tiles that the shader has rendered, as it says.",
        is_counter: true,
        of: |shader, _| shader.report.map(|report| report.tiles as f64),
    },
    ShaderNumber {
        name: "lie_shader_sent_bytes_total",
        help: "Bytes sent to the shader.",
        is_counter: true,
        of: |shader, _| Some(shader.sent_bytes as f64),
    },
];

impl ShaderNumber {
    fn write(&self, text: &mut Exposition, farm: &FarmStatus) {
        let mut family = if self.is_counter {
            text.counter(self.name, self.help)
        } else {
            text.gauge(self.name, self.help)
        };
        for shader in &farm.shaders {
            if let Some(value) = (self.of)(shader, farm.lies.version) {
                let id = shader.id.to_string();
                let labels = [("shader", &*id), ("address", shader.address.as_str())];
                family.value(&labels, value);
            }
        }
    }
}
