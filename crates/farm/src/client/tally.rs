use std::sync::atomic::{AtomicU32, Ordering};

use lie_protocol::ClientReport;

use super::FrameStats;
use crate::metrics::{Counter, Gauge};

/// What a client has done since its start, for whoever watches the farm.
#[derive(Default)]
pub(super) struct Tally {
    view: AtomicU32,
    frames: Counter,
    frame_us: Gauge,
    lost_tiles: Counter,
    reissued_tiles: Counter,
}

impl Tally {
    /// Our number at the constructor that took us in last.
    pub(super) fn view(&self) -> u32 {
        self.view.load(Ordering::Relaxed)
    }

    /// A constructor has taken us in, under this number.
    pub(super) fn welcome(&self, view: u32) {
        self.view.store(view, Ordering::Relaxed);
    }

    /// A frame is asked for.
    pub(super) fn begin(&self) {
        self.frames.add(1);
    }

    /// A frame is done.
    pub(super) fn finished(&self, stats: &FrameStats) {
        self.frame_us.set((1.0e3 * stats.frame_ms) as usize);
        self.lost_tiles.add(stats.lost_tiles);
        self.reissued_tiles.add(stats.reissued_tiles);
    }

    /// For the constructor.
    pub(super) fn report(&self) -> ClientReport {
        ClientReport {
            frames: self.frames.get(),
            frame_us: self.frame_us.get(),
            lost_tiles: self.lost_tiles.get(),
            reissued_tiles: self.reissued_tiles.get(),
        }
    }
}
