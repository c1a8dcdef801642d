mod company;
mod failures;

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use lie_protocol::{CancelBefore, ClientToShader, TileDone, TileRequest, limit};
use lie_render::{Film, RenderStats, Tile};
use tokio::{sync::mpsc, time::sleep_until};

use super::{
    ClientConfig, ClientError, Frame, FrameRequest, FrameStats, ShaderShare,
    cut::{self, Costs},
    hub::{Event, Hub, Link},
    standing::Standings,
    transit::Transits,
};
use crate::{
    pixels::PackedPixels,
    scheduler::{Completion, Scheduler, ShaderId},
};
use company::{LOOK_ROUND, REMINDER};
use failures::Failures;

/// What one frame leaves for the next.
#[derive(Default)]
pub(super) struct Memory {
    standings: Standings,
    costs: Costs,
    transits: Transits,
}

/// One frame in work.
pub(super) struct FrameRun<'a> {
    number: u64,
    view: u32,
    request: &'a FrameRequest,
    config: &'a ClientConfig,
    tiles: Vec<Tile>,
    /// Threads that there were for it when it was cut.
    threads: u32,
    scheduler: Scheduler,
    links: BTreeMap<ShaderId, (Link, u64)>,
    memory: &'a mut Memory,
    failures: Failures,
    stats: FrameStats,
    started: Instant,
    /// Since when there has been no shader.
    alone_since: Instant,
    reminded: Instant,
}

impl<'a> FrameRun<'a> {
    /// A frame that so many threads are there for.
    ///
    /// # Errors
    /// [`ClientError::Request`].
    pub(super) fn new(
        number: u64,
        request: &'a FrameRequest,
        config: &'a ClientConfig,
        memory: &'a mut Memory,
        threads: u32,
    ) -> Result<Self, ClientError> {
        let started = Instant::now();
        let sides = 1..=limit::FRAME_SIDE;
        if !(sides.contains(&request.size.x) && sides.contains(&request.size.y)) {
            return Err(ClientError::Request);
        }
        let tiles = cut::cut(request.size, threads as usize);
        let order = memory.costs.order(request.size, &tiles);
        Ok(Self {
            number,
            view: 0,
            request,
            config,
            scheduler: Scheduler::new(order, config.late),
            tiles,
            threads,
            links: BTreeMap::new(),
            memory,
            failures: Failures::default(),
            stats: FrameStats {
                lie_version: u64::MAX,

                ..FrameStats::default()
            },
            started,
            alone_since: started,
            reminded: started,
        })
    }

    /// Says whose frame it is, by the client's number at the constructor.
    pub(super) fn of_view(mut self, view: u32) -> Self {
        self.view = view;
        self
    }

    /// Hands out tiles and takes them in until the film is full.
    pub(super) async fn finish(mut self, hub: &Hub) -> Result<Frame, ClientError> {
        let (links, mut events) = hub.attach(self.number);
        self.gather(links);
        self.assign();
        self.stats.asked_ms = milliseconds(self.started.elapsed());
        // Made while the first tiles are rendered.
        let mut film = Film::new(self.request.size);
        while !self.scheduler.is_done() {
            self.assign();
            if let Err(error) = self.next_event(hub, &mut events, &mut film).await {
                self.call_off_the_rest();
                return Err(error);
            }
        }
        self.set_aside_the_silent();
        self.call_off_the_rest();
        Ok(self.into_frame(film))
    }

    async fn next_event(
        &mut self,
        hub: &Hub,
        events: &mut mpsc::Receiver<Event>,
        film: &mut Film,
    ) -> Result<(), ClientError> {
        let look_round = if self.scheduler.has_reserves() {
            LOOK_ROUND
        } else {
            REMINDER
        };
        let wake = Instant::now() + look_round;
        let deadline = self.scheduler.next_deadline();
        let wake = deadline.map_or(wake, |deadline| deadline.min(wake));
        tokio::select! {
            event = events.recv() => match event {
                Some(Event::Joined(id, link)) => self.join(id, link),
                Some(Event::Left(id)) => self.lose(id),
                Some(Event::Tile(id, done)) => self.take(id, &done, film),
                Some(Event::Failed(id, failed)) => self.fail(id, &failed)?,
                // The hub holds the other end for as long as this frame is the newest.
                None => return Err(ClientError::NoShaders(Duration::ZERO)),
            },
            () = sleep_until(wake.into()) => {}
        }
        self.check_company(hub)
    }

    fn join(&mut self, id: ShaderId, link: Link) {
        if self.links.contains_key(&id) {
            return;
        }
        let begin = ClientToShader::BeginFrame(self.request.begin(self.number, self.view));
        if link.outbox.try_send(begin).is_err() {
            // It is going or stuck: its session will say so, or die of silence.
            link.cut.cancel();
            return;
        }
        if self.memory.standings.may_work(id, Instant::now()) {
            let credits = self.credits(id, link.threads);
            self.scheduler.joined(id, credits);
        } else {
            self.scheduler.joined_in_reserve(id);
        }
        self.links.insert(id, (link, 0));
    }

    fn credits(&self, id: ShaderId, threads: u32) -> usize {
        let share = self.tiles.len() / self.threads.max(1) as usize;
        let credits = self.memory.transits.credits(id, threads, share);
        self.memory.standings.credits(id, credits)
    }

    fn lose(&mut self, id: ShaderId) {
        self.scheduler.lost(id);
    }

    /// A shader that breaks the rules, or does not take what it asked for, is out.
    fn expel(&mut self, id: ShaderId, why: &str) {
        if let Some((link, _)) = self.links.get(&id) {
            tracing::warn!("shader {} is cut off: {why}", link.address);
            link.cut.cancel();
        }
        self.lose(id);
    }

    fn assign(&mut self) {
        for (id, index) in self.scheduler.assign(Instant::now()) {
            let tile = self.tiles[index as usize];
            let request = ClientToShader::TileRequest(TileRequest {
                frame: self.number,
                tile: index,
                origin: tile.origin.to_array(),
                size: tile.size.to_array(),
            });
            let sent = self
                .links
                .get(&id)
                .map(|(link, _)| link.outbox.try_send(request));
            if !matches!(sent, Some(Ok(()))) {
                self.expel(id, "it does not take requests");
            }
        }
    }

    fn take(&mut self, id: ShaderId, done: &TileDone, film: &mut Film) {
        let clock = Instant::now();
        self.stats.last_tile_ms = milliseconds(clock - self.started);
        let number = done.report.tile;
        let Some(&tile) = self.tiles.get(number as usize) else {
            return self.expel(id, "there is no such tile");
        };
        // What is done, or was never asked of this one, is not written over.
        if self.scheduler.wants(number, id)
            && let Err(problem) = self.unpack(&done.pixels, tile, film)
        {
            return self.expel(id, &problem);
        }
        if let Some(held) = self.scheduler.held(number, id, clock) {
            let cost = &done.report.cost;
            self.memory.transits.note(id, held, cost);
        }
        let completion = self.scheduler.completed(number, id, Instant::now());
        if self.memory.standings.proved(id)
            && let Some((link, _)) = self.links.get(&id)
        {
            tracing::info!("shader {} works again", link.address);
        }
        if let Some((link, _)) = self.links.get(&id) {
            let credits = self.credits(id, link.threads);
            self.scheduler.has_credits(id, credits);
        }
        if completion == Completion::Duplicate {
            return;
        }
        if let Some((_, tiles)) = self.links.get_mut(&id) {
            *tiles += 1;
        }
        self.stats.unpack_ms += milliseconds(clock.elapsed());
        let render_ns = done.report.cost.render_ns;
        self.memory.costs.note(self.request.size, tile, render_ns);
        self.count(done);
    }

    /// Unpacks a tile straight into the film.
    fn unpack(&self, bytes: &[u8], tile: Tile, film: &mut Film) -> Result<(), String> {
        let (format, compression) = (self.request.format, self.request.compression);
        let count = (tile.size.x * tile.size.y) as usize;
        let pixels = PackedPixels::new(bytes, count, format, compression)
            .map_err(|error| error.to_string())?;
        film.fill(tile, |from, row| pixels.unpack(from, row))
            .map_err(|error| error.to_string())
    }

    fn count(&mut self, done: &TileDone) {
        let (stats, cost) = (&mut self.stats, &done.report.cost);
        if stats.latency_ms == 0.0 {
            stats.latency_ms = milliseconds(self.started.elapsed());
        }
        stats.lie_version = stats.lie_version.min(done.report.lie_version);
        stats.lie_version_max = stats.lie_version_max.max(done.report.lie_version);
        stats.pixel_bytes += done.pixels.len() as u64;
        let ms = |nanoseconds: u64| nanoseconds as f64 * 1.0e-6;
        stats.queued_ms += ms(cost.queued_ns);
        stats.idle_ms += ms(cost.idle_ns);
        stats.render_ms += ms(cost.render_ns);
        stats.pack_ms += ms(cost.pack_ns);
        stats.render += RenderStats {
            visibility_ns: cost.visibility_ns,
            unoccluded_ns: cost.unoccluded_ns,
            partial_ns: cost.partial_ns,
            full_ns: cost.full_ns,
            primary_rays: cost.primary_rays,
            shadow_rays: cost.shadow_rays,
            list_rays: cost.list_rays,
            occluder_tests: cost.occluder_tests,
            evaluations: cost.evaluations,
            trusted: cost.trusted,
        };
    }

    /// Tiles that are still in work are not wanted: two shaders had them, or the frame was given up or failed.
    fn call_off_the_rest(&self) {
        for (&id, (link, _)) in &self.links {
            if self.scheduler.in_flight(id) > 0 {
                let frame = self.number + 1;
                let cancel = ClientToShader::CancelBefore(CancelBefore { frame });
                // If it does not get there, the next frame says the same.
                let _ = link.outbox.try_send(cancel);
            }
        }
    }

    fn into_frame(mut self, film: Film) -> Frame {
        let shares = std::mem::take(&mut self.links).into_values();
        Frame {
            film,
            stats: FrameStats {
                frame_ms: milliseconds(self.started.elapsed()),
                tiles: self.tiles.len() as u64,
                trusted_fraction: self.stats.render.trusted_fraction(),
                lost_tiles: self.scheduler.lost_tiles(),
                reissued_tiles: self.scheduler.reissued_tiles(),
                shaders: shares
                    .map(|(link, tiles)| ShaderShare {
                        address: link.address,
                        tiles,
                    })
                    .collect(),
                ..std::mem::take(&mut self.stats)
            },
        }
    }
}

/// A frame that nobody waits for any more is not rendered any more.
impl Drop for FrameRun<'_> {
    fn drop(&mut self) {
        if !self.scheduler.is_done() {
            self.call_off_the_rest();
        }
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1.0e3
}

#[cfg(test)]
mod tests;
