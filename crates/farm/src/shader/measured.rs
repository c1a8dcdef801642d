use super::Shared;
use crate::metrics::{Exposition, write_audits, write_bytes, write_process};

impl Shared {
    /// All there is to measure, for Prometheus.
    pub(super) fn metrics(&self) -> String {
        let mut text = Exposition::default();
        write_process(&mut text, "shader");
        self.write_tiles(&mut text);
        self.write_now(&mut text);
        let meter = &self.meter;
        write_audits(&mut text, meter.audit_rays.get(), meter.audit_wrong.get());
        let (to, from) = (&meter.to_constructor, &meter.from_constructor);
        write_bytes(
            &mut text,
            &[
                ("client", meter.to_clients.get(), meter.from_clients.get()),
                ("constructor", to.get(), from.get()),
            ],
        );
        self.refusals.write(&mut text);
        text.into_text()
    }

    fn write_tiles(&self, text: &mut Exposition) {
        let (meter, stages) = (&self.meter, &self.meter.stages);
        text.counter("lie_tiles_total", "Tiles rendered to their end.")
            .count(&[], meter.tiles.get());
        text.counter(
            "lie_render_seconds_total",
            "Time of rendering, summed over threads.",
        )
        .value(&[], meter.render_ns.get() as f64 * 1.0e-9);
        text.counter("lie_rays_total", "Rays, by kind.")
            .count(&[("kind", "camera")], meter.camera_rays.get())
            .count(&[("kind", "shadow")], meter.shadow_rays.get())
            .count(&[("kind", "list")], meter.list_rays.get());
        text.counter(
            "lie_occluder_tests_total",
            "Triangles of occluder lists that rays were tested against.",
        )
        .count(&[], meter.occluder_tests.get());
        text.counter(
            "lie_light_evaluations_total",
            "Lights evaluated at surface points.",
        )
        .count(&[], meter.evaluations.get());
        text.counter(
            "lie_trusted_evaluations_total",
            "Those of them that the LIEs answered.",
        )
        .count(&[], meter.trusted.get());
        let mut family = text.histogram(
            "lie_tile_stage_seconds",
            "Time of a tile in each stage; its wait for a thread is the first.",
        );
        for (stage, histogram) in [
            ("queued", &stages.queued),
            ("visibility", &stages.visibility),
            ("unoccluded", &stages.unoccluded),
            ("partial", &stages.partial),
            ("traced", &stages.traced),
            ("pack", &stages.pack),
        ] {
            family.durations(&[("stage", stage)], histogram);
        }
    }

    fn write_now(&self, text: &mut Exposition) {
        let (queued, busy) = (self.meter.queued.get(), self.meter.busy.get());
        text.gauge("lie_render_threads", "Threads that render.")
            .count(&[], u64::from(self.threads));
        text.gauge("lie_render_threads_busy", "Threads that render a tile now.")
            .count(&[], busy);
        text.gauge(
            "lie_credits_in_use",
            "Tiles that clients have asked for and that are not done.",
        )
        .count(&[], queued + busy);
        text.gauge("lie_clients", "Connected clients.")
            .count(&[], self.meter.clients.get());
        text.gauge("lie_scene_ready", "Whether there is a scene to render.")
            .flag(&[], self.stage.borrow().is_some());
        text.gauge(
            "lie_constructor_connected",
            "Whether the constructor is there.",
        )
        .count(&[], self.meter.constructors.get());
        text.gauge(
            "lie_lies_version",
            "Version of the LIEs that tiles are shaded with; 0 for none.",
        )
        .count(&[], self.lie_version());
    }
}
