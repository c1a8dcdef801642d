//! What is known of shaders and clients, for people to look at. Nothing in here decides anything:
//! what a process says of itself is kept as it came, and shown.

use std::{
    net::SocketAddr,
    sync::{
        Mutex,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use lie_protocol::{ClientReport, ShaderReport};
use tokio::time::sleep;

use super::{
    Shared,
    listing::{Entry, Listing, lock},
    rate::Rate,
};
use crate::connection::{ByteCount, DEAD_AFTER, LinkError};

/// How often construction's progress is noted.
const NOTE_EVERY: Duration = Duration::from_secs(1);

/// All shaders and clients there are.
pub(super) struct Census {
    started: Instant,
    pub(super) shaders: Listing<ShaderRecord>,
    pub(super) clients: Listing<ClientRecord>,
    shaders_joined: AtomicU64,
    shaders_lost: AtomicU64,
    pub(super) traffic: Traffic,
    rate: Mutex<Rate>,
}

/// Bytes on all connections, from the end of their handshakes on.
#[derive(Default)]
pub(super) struct Traffic {
    pub(super) to_shaders: ByteCount,
    pub(super) from_shaders: ByteCount,
    pub(super) to_clients: ByteCount,
    pub(super) from_clients: ByteCount,
}

/// A shader.
pub(super) struct ShaderRecord {
    pub(super) joined: Instant,
    pub(super) sent: ByteCount,
    pub(super) received: ByteCount,
    latest: Mutex<Latest>,
}

/// What changes from one moment to the next.
#[derive(Clone, Copy)]
pub(super) struct Latest {
    /// When anything came last.
    pub(super) heard: Instant,
    /// A ping that is not answered, and when it went.
    asked: Option<(u64, Instant)>,
    /// How long the last one that was answered took.
    pub(super) ping: Option<Duration>,
    pub(super) report: Option<ShaderReport>,
}

/// A client.
pub(super) struct ClientRecord {
    pub(super) peer: SocketAddr,
    pub(super) joined: Instant,
    pub(super) cameras: AtomicU64,
    report: Mutex<Option<ClientReport>>,
}

impl Census {
    pub(super) fn new() -> Self {
        Self {
            started: Instant::now(),
            shaders: Listing::default(),
            clients: Listing::default(),
            shaders_joined: AtomicU64::new(0),
            shaders_lost: AtomicU64::new(0),
            traffic: Traffic::default(),
            rate: Mutex::default(),
        }
    }

    /// A shader has joined.
    pub(super) fn shader(&self, id: u32) -> Entry<'_, ShaderRecord> {
        self.shaders_joined.fetch_add(1, Ordering::Relaxed);
        let now = Instant::now();
        let record = ShaderRecord {
            joined: now,
            sent: ByteCount::within(&self.traffic.to_shaders),
            received: ByteCount::within(&self.traffic.from_shaders),
            latest: Mutex::new(Latest {
                heard: now,
                asked: None,
                ping: None,
                report: None,
            }),
        };
        self.shaders.enter(id, record)
    }

    /// A shader's session has ended like this.
    pub(super) fn shader_left(&self, ended: &Result<(), LinkError>) {
        if !matches!(ended, Ok(()) | Err(LinkError::Refused(_))) {
            self.shaders_lost.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// A client has joined.
    pub(super) fn client(&self, id: u32, peer: SocketAddr) -> Entry<'_, ClientRecord> {
        let record = ClientRecord {
            peer: SocketAddr::new(peer.ip().to_canonical(), peer.port()),
            joined: Instant::now(),
            cameras: AtomicU64::new(0),
            report: Mutex::default(),
        };
        self.clients.enter(id, record)
    }

    pub(super) fn uptime(&self) -> Duration {
        self.started.elapsed()
    }

    pub(super) fn shaders_joined(&self) -> u64 {
        self.shaders_joined.load(Ordering::Relaxed)
    }

    pub(super) fn shaders_lost(&self) -> u64 {
        self.shaders_lost.load(Ordering::Relaxed)
    }

    /// Construction samples per second.
    pub(super) fn samples_per_s(&self) -> f32 {
        lock(&self.rate).per_s()
    }
}

/// Notes how far construction is, for ever.
pub(super) async fn keep_rate(shared: &Shared) {
    loop {
        let samples = shared.progress.borrow().status.samples;
        lock(&shared.census.rate).note(Instant::now(), samples);
        sleep(NOTE_EVERY).await;
    }
}

impl ShaderRecord {
    /// Something came from it.
    pub(super) fn heard(&self) {
        lock(&self.latest).heard = Instant::now();
    }

    /// A ping goes to it.
    pub(super) fn asked(&self, nonce: u64) {
        let mut latest = lock(&self.latest);
        // It may drop one when it is busy.
        if latest
            .asked
            .is_none_or(|(_, at)| at.elapsed() >= DEAD_AFTER)
        {
            latest.asked = Some((nonce, Instant::now()));
        }
    }

    /// It has answered a ping.
    pub(super) fn answered(&self, nonce: u64) {
        let mut latest = lock(&self.latest);
        if let Some((_, at)) = latest.asked.take_if(|(asked, _)| *asked == nonce) {
            latest.ping = Some(at.elapsed());
        }
    }

    /// It says what it has done.
    pub(super) fn reported(&self, report: ShaderReport) {
        lock(&self.latest).report = Some(report);
    }

    pub(super) fn latest(&self) -> Latest {
        *lock(&self.latest)
    }
}

impl ClientRecord {
    /// It has told us a camera.
    pub(super) fn looked(&self) {
        self.cameras.fetch_add(1, Ordering::Relaxed);
    }

    /// It says what it has done.
    pub(super) fn reported(&self, report: ClientReport) {
        *lock(&self.report) = Some(report);
    }

    pub(super) fn report(&self) -> Option<ClientReport> {
        *lock(&self.report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_answer_to_our_own_ping_counts() {
        let census = Census::new();
        let record = census.shader(3);
        record.answered(0);
        record.asked(8);
        record.answered(9);
        assert_eq!(record.latest().ping, None);
        record.asked(9);
        record.answered(8);
        assert!(record.latest().ping.is_some());
    }

    #[test]
    fn who_has_left_is_not_listed_and_who_is_lost_is_counted() {
        let census = Census::new();
        let (one, other) = (census.shader(1), census.shader(2));
        assert_eq!(census.shaders.all().len(), 2);
        drop(one);
        census.shader_left(&Err(LinkError::Closed));
        drop(other);
        census.shader_left(&Ok(()));
        assert!(census.shaders.all().is_empty());
        assert_eq!((census.shaders_joined(), census.shaders_lost()), (2, 1));
    }
}
