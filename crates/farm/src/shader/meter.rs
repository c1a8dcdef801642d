use lie_protocol::WireCost;

use crate::{
    connection::ByteCount,
    metrics::{Counter, Gauge, Histogram},
};

/// What a shader has done since its start. Written once for each tile, without a lock.
#[derive(Default)]
pub(super) struct Meter {
    /// Tiles rendered to their end.
    pub(super) tiles: Counter,
    pub(super) camera_rays: Counter,
    pub(super) shadow_rays: Counter,
    pub(super) list_rays: Counter,
    pub(super) occluder_tests: Counter,
    pub(super) evaluations: Counter,
    pub(super) trusted: Counter,
    pub(super) render_ns: Counter,
    pub(super) audit_rays: Counter,
    pub(super) audit_wrong: Counter,
    /// Time of a tile, stage by stage.
    pub(super) stages: Stages,
    /// Tiles that wait for a thread.
    pub(super) queued: Gauge,
    /// Tiles in work.
    pub(super) busy: Gauge,
    /// Clients that are connected.
    pub(super) clients: Gauge,
    /// 1 while the constructor is connected.
    pub(super) constructors: Gauge,
    pub(super) to_clients: ByteCount,
    pub(super) from_clients: ByteCount,
    pub(super) to_constructor: ByteCount,
    pub(super) from_constructor: ByteCount,
}

/// What a tile's time goes to.
#[derive(Default)]
pub(super) struct Stages {
    /// From the request's arrival to the start of the work.
    pub(super) queued: Histogram,
    pub(super) visibility: Histogram,
    pub(super) unoccluded: Histogram,
    pub(super) partial: Histogram,
    pub(super) traced: Histogram,
    pub(super) pack: Histogram,
}

impl Meter {
    /// A tile is done.
    pub(super) fn tile(&self, cost: &WireCost) {
        self.tiles.add(1);
        self.camera_rays.add(cost.primary_rays);
        self.shadow_rays.add(cost.shadow_rays);
        self.list_rays.add(cost.list_rays);
        self.occluder_tests.add(cost.occluder_tests);
        self.evaluations.add(cost.evaluations);
        self.trusted.add(cost.trusted);
        self.render_ns.add(cost.render_ns);
        self.stages.queued.observe_ns(cost.queued_ns);
        self.stages.visibility.observe_ns(cost.visibility_ns);
        self.stages.unoccluded.observe_ns(cost.unoccluded_ns);
        self.stages.partial.observe_ns(cost.partial_ns);
        self.stages.traced.observe_ns(cost.full_ns);
        self.stages.pack.observe_ns(cost.pack_ns);
    }

    /// An audit has traced so many rays, of which so many were answered wrongly.
    pub(super) fn audited(&self, (rays, wrong): (u64, u64)) {
        self.audit_rays.add(rays);
        self.audit_wrong.add(wrong);
    }
}
