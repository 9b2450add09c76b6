//! Work that its caller may give up, in a process that goes on: a Python session after Ctrl-C.
//!
//! A thread looks at its flag between the items that it deals to workers, between steps of least squares, and before files are written. Once the flag
//! is set it unwinds, so that nothing is written any more. Workers inherit the flag. A thread without one never stops.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local! {
    static FLAG: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Payload with which an interrupted thread unwinds.
#[derive(Debug)]
pub struct Interrupted;

/// Lets this thread end soon after the flag is set; without a flag, it goes on.
pub fn heed(flag: Option<Arc<AtomicBool>>) {
    FLAG.set(flag);
}

/// Returns the flag that this thread heeds.
pub fn flag() -> Option<Arc<AtomicBool>> {
    FLAG.with_borrow(Clone::clone)
}

/// Returns true if this thread shall end.
pub fn is_set() -> bool {
    FLAG.with_borrow(|flag| flag.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed)))
}

/// Unwinds, without a panic's message, where this thread shall end.
pub fn check() {
    if is_set() {
        std::panic::resume_unwind(Box::new(Interrupted));
    }
}
