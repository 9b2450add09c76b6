//! Work spread over threads that each own a state (a tag detector, inference sessions) which must not be shared; how long some takes; work that is
//! given up; and memory that the next item takes over.

pub mod interruption;
pub mod memory;
pub mod stopwatch;

use std::convert::Infallible;
use std::panic::resume_unwind;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

/// Time for which work is measured before one run counts, ms.
const LONG_ENOUGH_MS: f64 = 50.0;

/// Returns the number of threads to use: one a core.
pub fn thread_count() -> usize {
    std::thread::available_parallelism().map_or(1, |n| n.get())
}

/// Maps items as [`map_over`], with one thread a core.
pub fn map<T: Sync, S, R: Send, E: Send>(
    items: &[T],
    make_state: impl Fn() -> Result<S, E> + Sync,
    work: impl Fn(&mut S, &T) -> Result<R, E> + Sync,
    on_done: impl Fn() + Sync,
) -> Result<Vec<R>, E> {
    map_over(thread_count(), items, make_state, work, on_done)
}

/// Maps items as [`map`], by work that needs no state and cannot fail.
pub fn each<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let Ok(done) = map(items, || Ok(()), |(), item| Ok::<_, Infallible>(work(item)), || ());
    done
}

/// Does `work` on every item, spread over so many threads; results keep the items' order.
///
/// A thread takes the next item when it has done one, so that one reads and decodes while another computes, and no more items
/// are in work than there are threads.
///
/// Each thread makes its state once. When a state cannot be made, or some work fails, the first error is returned and the
/// remaining items are left.
pub fn map_over<T: Sync, S, R: Send, E: Send>(
    threads: usize,
    items: &[T],
    make_state: impl Fn() -> Result<S, E> + Sync,
    work: impl Fn(&mut S, &T) -> Result<R, E> + Sync,
    on_done: impl Fn() + Sync,
) -> Result<Vec<R>, E> {
    let next = AtomicUsize::new(0);
    let stop = AtomicBool::new(false);
    let done: Mutex<Vec<(usize, Result<R, E>)>> = Mutex::new(Vec::with_capacity(items.len()));
    let push = |i: usize, result: Result<R, E>| {
        if result.is_err() {
            stop.store(true, Ordering::Relaxed);
        }
        // A poisoned lock means a worker panicked; that panic is passed on, so what is in here no longer matters.
        done.lock().unwrap_or_else(|e| e.into_inner()).push((i, result));
    };
    let flag = interruption::flag();
    let run = || {
        interruption::heed(flag.clone());
        let mut state = match make_state() {
            Ok(state) => state,
            Err(e) => return push(usize::MAX, Err(e)),
        };
        while !stop.load(Ordering::Relaxed) && !interruption::is_set() {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(i) else { break };
            push(i, work(&mut state, item));
            on_done();
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads.clamp(1, items.len().max(1)))
            .map(|_| scope.spawn(run))
            .collect();
        for thread in threads {
            // Also what an interrupted one unwinds with.
            if let Err(panic) = thread.join() {
                resume_unwind(panic);
            }
        }
    });
    interruption::check();
    let mut done = done.into_inner().unwrap_or_else(|e| e.into_inner());
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Returns the result of some work, and the milliseconds the fastest of three runs took: what else the machine does only ever adds. Work that has taken
/// [`LONG_ENOUGH_MS`] is not done again: an interruption is a small part of that.
pub fn fastest<R>(mut work: impl FnMut() -> R) -> (R, f64) {
    let mut run = || {
        let start = Instant::now();
        let result = work();
        (result, start.elapsed().as_secs_f64() * 1e3)
    };
    let mut best = run();
    let mut taken_ms = best.1;
    for _ in 0..2 {
        if taken_ms >= LONG_ENOUGH_MS {
            break;
        }
        let again = run();
        taken_ms += again.1;
        if again.1 < best.1 {
            best = again;
        }
    }
    best
}
