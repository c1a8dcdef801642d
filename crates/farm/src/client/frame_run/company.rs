//! Who a frame is rendered by: who is asked, who is set aside, and what if nobody is there.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use super::{ClientError, FrameRun, Hub, Link, ShaderId};

/// How often it is looked whether somebody in reserve is needed.
pub(super) const LOOK_ROUND: Duration = Duration::from_millis(50);
/// How often somebody who waits for shaders is told so.
pub(super) const REMINDER: Duration = Duration::from_secs(2);

impl FrameRun<'_> {
    /// Takes who is there; those who have let frames wait are in reserve for a while.
    pub(super) fn gather(&mut self, links: BTreeMap<ShaderId, Link>) {
        self.memory
            .standings
            .keep_only(|id| links.contains_key(&id));
        self.memory.transits.keep_only(|id| links.contains_key(&id));
        let now = Instant::now();
        for (id, link) in links {
            self.stats.set_aside += u64::from(!self.memory.standings.may_work(id, now));
            self.join(id, link);
        }
    }

    /// Fails if there has been nobody for too long, and says so before.
    pub(super) fn check_company(&mut self, hub: &Hub) -> Result<(), ClientError> {
        let now = Instant::now();
        if self.scheduler.shaders() > 0 {
            self.alone_since = now;
            return Ok(());
        }
        if let Some(scene) = hub.other_scene() {
            let address = self.config.constructor.clone();
            return Err(ClientError::OtherScene { address, scene });
        }
        let alone = now.duration_since(self.alone_since);
        if alone >= self.config.shader_timeout {
            return Err(ClientError::NoShaders(alone));
        }
        if now.duration_since(self.reminded) >= REMINDER {
            self.reminded = now;
            tracing::info!(
                "waiting for a shader, for {} s now ({} of {} tiles are missing)",
                alone.as_secs(),
                self.scheduler.unfinished(),
                self.tiles.len()
            );
        }
        Ok(())
    }

    /// Who was given tiles, let the frame wait for them and gave nothing is not asked for a while.
    pub(super) fn set_aside_the_silent(&mut self) {
        let now = Instant::now();
        for (&id, (link, _)) in &self.links {
            if self.scheduler.is_silent(id, now) {
                let pause = self.memory.standings.failed(id, now);
                tracing::warn!(
                    "shader {} gave nothing while a frame waited: it is set aside for {} s",
                    link.address,
                    pause.as_secs_f32()
                );
            }
        }
    }
}
