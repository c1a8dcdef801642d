use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use lie_farm::{
    client::{Frame, FrameStats},
    walk::WalkObserver,
};
use lie_protocol::LieStatus;
use lie_render::{Film, ToneCurve, ToneMap, write_exr, write_png};
use lie_scene::RenderSettings;
use serde_json::{Value, json};
use tokio::sync::watch;

use super::{FarmIntegrator, Format, WalkOptions};
use crate::args::Precision;

/// Writes a walk's frames and keeps its figures.
pub(crate) struct Report {
    scene: String,
    shaders: u32,
    integrator: FarmIntegrator,
    settings: RenderSettings,
    out: Option<PathBuf>,
    format: Format,
    precision: Precision,
    status: watch::Receiver<LieStatus>,
    bar: ProgressBar,
    settled: Option<bool>,
    rows: Vec<Value>,
    frame_ms: Vec<f64>,
    /// From the connection to the constructor until all shaders were there.
    pub(super) joined_ms: f64,
}

impl Report {
    pub(super) fn new(
        options: &WalkOptions,
        (scene, shaders): (&str, u32),
        settings: RenderSettings,
        status: watch::Receiver<LieStatus>,
        bar: ProgressBar,
    ) -> Self {
        Self {
            scene: scene.to_owned(),
            shaders,
            integrator: options.integrator,
            settings,
            out: options.out.clone(),
            format: options.format,
            precision: options.precision,
            status,
            bar,
            settled: None,
            rows: vec![],
            frame_ms: vec![],
            joined_ms: 0.0,
        }
    }

    /// One line for people.
    pub(super) fn summary(&self) -> String {
        let mut times = self.frame_ms.clone();
        times.sort_by(f64::total_cmp);
        let (Some(least), Some(most)) = (times.first(), times.last()) else {
            return "no frames".to_owned();
        };
        let out = self.out.as_ref();
        let place = out.map_or(String::new(), |out| format!(", in {}", out.display()));
        format!(
            "{} frames of {} x {} pixels: {:.1} ms median ({least:.1} to {most:.1}), {}, {}{place}",
            times.len(),
            self.settings.size.x,
            self.settings.size.y,
            times[times.len() / 2],
            if self.shaders == 1 {
                "1 shader".to_owned()
            } else {
                format!("{} shaders", self.shaders)
            },
            self.integrator.name(),
        )
    }

    /// Everything for machines.
    pub(super) fn json(&self) -> Value {
        let status = *self.status.borrow();
        json!({
            "scene": self.scene,
            "shaders": self.shaders,
            "integrator": self.integrator.name(),
            "width": self.settings.size.x,
            "height": self.settings.size.y,
            "spp": self.settings.samples_per_pixel,
            "light_samples": self.settings.light_samples,
            "joined_ms": self.joined_ms,
            "lie": {
                "version": status.version,
                "cells": status.cells,
                "entries": status.entries,
                "occluders": status.occluders,
                "bytes": status.bytes,
                "samples": status.samples,
                "estimated_error": finite(status.estimated_error),
                "converged": status.converged,
                "frozen": status.frozen,
            },
            "audit": { "rays": status.audit_rays, "wrong": status.audit_wrong },
            "constructor_sent_bytes": status.sent_bytes,
            "frames": self.rows,
        })
    }

    fn row(&self, index: u32, stats: &FrameStats) -> Value {
        let status = *self.status.borrow();
        let render = &stats.render;
        let ms = |ns: u64| ns as f64 * 1.0e-6;
        let shaders = stats.shaders.iter();
        let tiles: Vec<Value> = shaders
            .map(|share| json!({ "address": share.address, "tiles": share.tiles }))
            .collect();
        json!({
            "index": index,
            "frame_ms": stats.frame_ms,
            "latency_ms": stats.latency_ms,
            "lie_version": stats.lie_version,
            "lie_version_max": stats.lie_version_max,
            "trusted_fraction": stats.trusted_fraction,
            "lost_tiles": stats.lost_tiles,
            "reissued_tiles": stats.reissued_tiles,
            "set_aside": stats.set_aside,
            "settled": self.settled,
            "pixel_bytes": stats.pixel_bytes,
            "constructor_sent_bytes": status.sent_bytes,
            "queued_ms": stats.queued_ms,
            "idle_ms": stats.idle_ms,
            "render_ms": stats.render_ms,
            "pack_ms": stats.pack_ms,
            "unpack_ms": stats.unpack_ms,
            "visibility_ms": ms(render.visibility_ns),
            "unoccluded_ms": ms(render.unoccluded_ns),
            "partial_ms": ms(render.partial_ns),
            "full_ms": ms(render.full_ns),
            "primary_rays": render.primary_rays,
            "shadow_rays": render.shadow_rays,
            "list_rays": render.list_rays,
            "occluder_tests": render.occluder_tests,
            "evaluations": render.evaluations,
            "shaders": tiles,
        })
    }

    fn write(&self, directory: &Path, index: u32, film: &Film) -> anyhow::Result<()> {
        let name = |ending: &str| directory.join(format!("frame-{index:04}.{ending}"));
        if self.format != Format::Png {
            write_exr(&name("exr"), film, self.precision.into())?;
        }
        if self.format != Format::Exr {
            let map = ToneMap {
                exposure_stops: self.settings.exposure_stops,
                curve: ToneCurve::Aces,
            };
            write_png(&name("png"), film, &map)?;
        }
        Ok(())
    }
}

impl WalkObserver for Report {
    type Error = anyhow::Error;

    fn begins(&mut self, index: u32, settled: Option<bool>) {
        if settled == Some(false) {
            tracing::warn!("frame {index}: its view has not converged in time");
        }
        self.settled = settled;
    }

    fn finished(&mut self, index: u32, frame: Frame) -> anyhow::Result<()> {
        if let Some(directory) = &self.out {
            self.write(directory, index, &frame.film)?;
        }
        let row = self.row(index, &frame.stats);
        self.rows.push(row);
        self.frame_ms.push(frame.stats.frame_ms);
        self.bar.set_position(u64::from(index) + 1);
        self.bar.set_message(format!(
            "{:.0} ms, {:.0} % trusted",
            frame.stats.frame_ms,
            100.0 * frame.stats.trusted_fraction
        ));
        Ok(())
    }
}

/// JSON has no infinity.
fn finite(value: f32) -> Option<f32> {
    value.is_finite().then_some(value)
}
