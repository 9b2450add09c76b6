//! Libraries that panic where they should refuse.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static IS_REFUSING: Cell<bool> = const { Cell::new(false) };
}

/// Runs what may panic on what a user gave; `None` when it did. What it was at work on is to be given up.
pub(super) fn quietly<T>(may_panic: impl FnOnce() -> T) -> Option<T> {
    let before = IS_REFUSING.replace(true);
    let result = catch_unwind(AssertUnwindSafe(may_panic));
    IS_REFUSING.set(before);
    result.ok()
}

/// Whether a panic of this thread would be caught and returned as an error. A program's panic hook may ask, to stay silent; the library
/// itself leaves the hook alone, since it is the whole process's.
pub fn is_refusing() -> bool {
    IS_REFUSING.get()
}
