//! Runs one of `lie_trial`'s targets.

use std::cell::RefCell;

use lie_trial::Run;

/// Feeds a target; gets it ready at the first time.
///
/// # Panics
/// If there is no such target.
pub fn feed(name: &str, bytes: &[u8]) {
    thread_local! {
        static RUN: RefCell<Option<Run>> = const { RefCell::new(None) };
    }
    let open = || {
        let mut targets = lie_trial::TARGETS.into_iter();
        let target = targets.find(|target| target.name == name);
        (target.expect("a target of this name").open)()
    };
    RUN.with_borrow_mut(|run| run.get_or_insert_with(open)(bytes));
}
