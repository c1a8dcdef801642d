use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

/// A case that takes so many ticks hangs. Ticks are counted, not time: in a process that was
/// stopped for a while none have passed.
const HANGS: u32 = 300;
const TICK: Duration = Duration::from_millis(100);

/// Ends the process if a case hangs, since nothing else could.
pub(crate) struct Watch {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    case: AtomicU64,
    is_over: AtomicBool,
}

impl Watch {
    pub(crate) fn start(target: &'static str, seed: u64) -> Self {
        let shared = Arc::new(Shared::default());
        let watched = shared.clone();
        let thread = thread::spawn(move || watch(&watched, target, seed));
        Self {
            shared,
            thread: Some(thread),
        }
    }

    /// Another case.
    pub(crate) fn begins(&self, case: u64) {
        self.shared.case.store(case, Relaxed);
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}

fn watch(shared: &Shared, target: &str, seed: u64) {
    let (mut last, mut ticks) = (shared.case.load(Relaxed), 0);
    while !shared.is_over.load(Relaxed) {
        thread::park_timeout(TICK);
        let case = shared.case.load(Relaxed);
        ticks = if case == last { ticks + 1 } else { 0 };
        last = case;
        if ticks == HANGS {
            eprintln!("{target}: case {case} of seed {seed} hangs");
            std::process::exit(101);
        }
    }
}
