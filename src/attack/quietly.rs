//! Libraries that panic where they should refuse.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs what may panic on what a user gave; `None` when it did. Nothing of that panic reaches standard error; those of other threads
/// do. What it was at work on is to be given up.
pub(super) fn quietly<T>(may_panic: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let usual = take_hook();
        set_hook(Box::new(move |about| {
            if !IS_QUIET.get() {
                usual(about);
            }
        }));
    });
    let was_quiet = IS_QUIET.replace(true);
    let result = catch_unwind(AssertUnwindSafe(may_panic));
    IS_QUIET.set(was_quiet);
    result.ok()
}
