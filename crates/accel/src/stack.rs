use std::cell::RefCell;

use crate::node::Child;

/// Pending children, with where a ray, or the first of a packet, enters them.
pub(crate) type Stack = Vec<(f32, Child)>;

thread_local! {
    static STACK: RefCell<Stack> = const { RefCell::new(Vec::new()) };
}

/// Lends this thread's stack, so that no ray allocates.
#[inline]
pub(crate) fn with_stack<T>(work: impl FnOnce(&mut Stack) -> T) -> T {
    STACK.with_borrow_mut(work)
}
