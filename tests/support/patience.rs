//! Time as it passes for a test: a machine that stops it for a while, and all that it has started with
//! it, makes nothing late.

use std::{
    future::Future,
    pin::pin,
    sync::{
        Once,
        atomic::{AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use tokio::time::sleep;

use super::LONG;

const TICK: Duration = Duration::from_millis(100);
/// A tick that takes longer is one in which the test stood still.
const STILL: Duration = Duration::from_secs(1);

/// Waits for [`LONG`], counted in ticks.
pub(crate) async fn patiently<T>(work: impl Future<Output = T>) -> Option<T> {
    let mut work = pin!(work);
    for _ in 0..LONG.as_millis() / TICK.as_millis() {
        tokio::select! {
            done = &mut work => return Some(done),
            () = sleep(TICK) => {}
        }
    }
    None
}

/// For how long the test has stood still since this was asked first.
pub(crate) fn stood_still() -> Duration {
    static STARTED: Once = Once::new();
    static STILL_MS: AtomicU64 = AtomicU64::new(0);
    STARTED.call_once(|| {
        thread::spawn(|| {
            loop {
                let tick = Instant::now();
                thread::sleep(TICK / 10);
                let took = tick.elapsed();
                if took > STILL {
                    STILL_MS.fetch_add(took.as_millis() as u64, Ordering::Relaxed);
                }
            }
        });
    });
    Duration::from_millis(STILL_MS.load(Ordering::Relaxed))
}
