//! Work in another thread, while the thread that called from Python watches for Ctrl-C, shows progress and calls Python's functions.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::time::Duration;

use pyo3::prelude::*;
use scaleproof_core::workers::interruption;

use crate::error::unpanicked;

/// Ctrl-C is looked for this often.
const EVERY: Duration = Duration::from_millis(50);

/// How far some work has come, and whether it shall end.
#[derive(Debug, Default)]
pub struct Course {
    pub of: AtomicUsize,
    pub done: AtomicUsize,
    pub stop: Arc<AtomicBool>,
}

impl Course {
    /// One more item is done.
    pub fn step(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// The error that ends the work, unless it goes on.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Does work that stops soon after its course says so. Calls `progress(done, of)` from time to time, and `answer` for each request that the work sends;
/// what these raise, or Ctrl-C, stops the work and is the error.
pub fn work<T: Send, R: Send>(
    py: Python<'_>,
    course: &Course,
    progress: Option<Py<PyAny>>,
    requests: (Sender<Event<R>>, Receiver<Event<R>>),
    mut answer: impl FnMut(Python<'_>, R, &Receiver<Event<R>>) -> PyResult<()> + Send,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let (sender, receiver) = requests;
    let (done, failed) = py.detach(move || {
        std::thread::scope(|scope| {
            let worker = scope.spawn(move || {
                let done = unpanicked(work);
                // Nobody listens any more only when this thread is not waited for.
                drop(sender.send(Event::Done));
                done
            });
            let (mut failed, mut shown) = (None, 0);
            let mut watch = |request: Option<R>| {
                // After an error nobody is asked any more: requests are dropped, and who made them is told so.
                if failed.is_some() {
                    return;
                }
                let looked = Python::attach(|py| {
                    py.check_signals()?;
                    let done = course.done.load(Ordering::Relaxed);
                    if let (Some(progress), true) = (&progress, done != shown) {
                        shown = done;
                        progress.call1(py, (done, course.of.load(Ordering::Relaxed)))?;
                    }
                    request.map_or(Ok(()), |request| answer(py, request, &receiver))
                });
                if let Err(e) = looked {
                    give_up(&course.stop);
                    failed = Some(e);
                }
            };
            loop {
                match receiver.recv_timeout(EVERY) {
                    Ok(Event::Ask(request)) => watch(Some(request)),
                    Err(RecvTimeoutError::Timeout) => watch(None),
                    Ok(Event::Done) | Err(RecvTimeoutError::Disconnected) => break,
                }
            }
            watch(None);
            (worker.join(), failed)
        })
    });
    match (failed, done) {
        (Some(e), _) => Err(e),
        (None, Ok(done)) => done,
        (None, Err(_)) => unpanicked(|| panic!("a thread ended")),
    }
}

/// Tells work to stop, and ends the programs that it waits for.
fn give_up(stop: &AtomicBool) {
    stop.store(true, Ordering::Relaxed);
    scaleproof_detect::kill_programs();
}

/// What comes from the thread that works.
#[derive(Debug)]
pub enum Event<R> {
    Ask(R),
    Done,
}

/// Work that unwinds soon after Ctrl-C, with the programs that it has started, and writes no file from then on; nobody waits for that.
pub fn alone<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> T + Send + 'static) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel();
    let flag = Arc::new(AtomicBool::new(false));
    let heeded = Arc::clone(&flag);
    std::thread::spawn(move || {
        interruption::heed(Some(heeded));
        drop(sender.send(unpanicked(work)));
    });
    py.detach(move || {
        loop {
            match receiver.recv_timeout(EVERY) {
                Ok(done) => return done,
                Err(RecvTimeoutError::Timeout) => {
                    Python::attach(|py| py.check_signals()).inspect_err(|_| give_up(&flag))?;
                }
                Err(RecvTimeoutError::Disconnected) => return unpanicked(|| panic!("a thread ended")),
            }
        }
    })
}
