use std::{sync::atomic::Ordering, time::Duration};

use lie_protocol::{ClientStatus, FarmStatus, LieStatus, ShaderHealth, ShaderStatus, Text};

use super::{Shared, construction::Progress};
use crate::{connection::PING_EVERY, handshake};

/// A shader that has said nothing for so long is late with two signs of life.
const SILENT_AFTER: Duration = Duration::from_millis(2500);

const _: () = assert!(SILENT_AFTER.as_millis() > 2 * PING_EVERY.as_millis());

impl Shared {
    /// What was learnt, for everybody.
    pub(super) fn lie_status(&self, progress: &Progress) -> LieStatus {
        let audited = self.audits.total();
        LieStatus {
            sent_bytes: self.census.traffic.to_shaders.get(),
            audit_rays: audited.rays,
            audit_wrong: audited.wrong,
            ..progress.status
        }
    }

    /// The farm as it is now.
    pub(super) fn status(&self) -> FarmStatus {
        FarmStatus {
            build: handshake::build(),
            scene: self.summary.name.clone(),
            hash: self.summary.hash,
            triangles: self.summary.triangles,
            lights: self.summary.lights,
            uptime_ms: milliseconds(self.census.uptime()),
            lies: self.lie_status(&self.progress.borrow()),
            samples_per_s: self.census.samples_per_s(),
            shaders_joined: self.census.shaders_joined(),
            shaders_lost: self.census.shaders_lost(),
            shaders: self.shaders(),
            clients: self.clients(),
        }
    }

    fn shaders(&self) -> Vec<ShaderStatus> {
        let roster = self.registry.watch().borrow().clone();
        let records = self.census.shaders.all();
        let known = roster.values().filter_map(|entry| {
            let record = records.get(&entry.id)?;
            let latest = record.latest();
            let heard = latest.heard.elapsed();
            Some(ShaderStatus {
                id: entry.id,
                address: entry.address.clone(),
                threads: entry.threads,
                replays: entry.replays,
                health: health(entry.ready, heard),
                joined_ms: milliseconds(record.joined.elapsed()),
                heard_ms: milliseconds(heard),
                ping_us: latest.ping.map(|ping| ping.as_micros() as u64),
                sent_bytes: record.sent.get(),
                report: latest.report,
            })
        });
        known.collect()
    }

    fn clients(&self) -> Vec<ClientStatus> {
        let records = self.census.clients.all();
        let known = records.iter().map(|(&id, record)| ClientStatus {
            id,
            address: Text::new(&record.peer.to_string()),
            joined_ms: milliseconds(record.joined.elapsed()),
            cameras: record.cameras.load(Ordering::Relaxed),
            report: record.report(),
        });
        known.collect()
    }
}

fn health(ready: bool, heard: Duration) -> ShaderHealth {
    if heard >= SILENT_AFTER {
        ShaderHealth::Silent
    } else if ready {
        ShaderHealth::Ready
    } else {
        ShaderHealth::Starting
    }
}

fn milliseconds(duration: Duration) -> u64 {
    duration.as_millis() as u64
}
