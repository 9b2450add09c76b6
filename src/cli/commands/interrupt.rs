//! Ctrl-C while programs of others run for this one.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// Calls something at the first Ctrl-C; the second ends the programs that run for a source, and this one.
pub fn on_interrupt(first: impl FnOnce() + Send + 'static) {
    in_background(async move {
        if tokio::signal::ctrl_c().await.is_ok() {
            first();
            if tokio::signal::ctrl_c().await.is_ok() {
                end(scaleproof_capture::interrupt_programs, 130);
            }
        }
    });
}

/// While it lives, Ctrl-C ends the programs that run for a source, and this one: nothing was begun that could be finished.
pub struct Opening(Arc<AtomicBool>);

impl Opening {
    pub fn new() -> Opening {
        let is_over = Arc::new(AtomicBool::new(false));
        let opening = Opening(is_over.clone());
        in_background(async move {
            if tokio::signal::ctrl_c().await.is_ok() && !is_over.load(Ordering::Relaxed) {
                end(scaleproof_capture::interrupt_programs, 130);
            }
        });
        opening
    }
}

impl Drop for Opening {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Waits for signals in a thread of its own; without a runtime for that, they end the program as they always do.
fn in_background(waiting: impl Future<Output = ()> + Send + 'static) {
    std::thread::spawn(|| {
        if let Ok(runtime) = tokio::runtime::Builder::new_current_thread().enable_all().build() {
            runtime.block_on(waiting);
        }
    });
}

/// Held from an interruption to the end of this process, which soon follows.
static ENDING: Mutex<()> = Mutex::new(());

fn end(programs: fn(), code: i32) -> ! {
    let _ending = ENDING.lock();
    programs();
    std::process::exit(code)
}

/// Waits for the end where one has come: that programs died of it is no error to be reported.
pub fn let_an_interruption_end_first() {
    drop(ENDING.lock());
}

#[cfg(unix)]
pub fn end_programs_first() {
    use tokio::signal::unix::{SignalKind, signal};

    in_background(async {
        let kinds = [SignalKind::interrupt(), SignalKind::terminate(), SignalKind::hangup()];
        let [Ok(mut interrupt), Ok(mut terminate), Ok(mut hangup)] = kinds.map(signal) else {
            return;
        };
        let number = tokio::select! {
            _ = interrupt.recv() => 2,
            _ = terminate.recv() => 15,
            _ = hangup.recv() => 1,
        };
        end(scaleproof_detect::kill_programs, 128 + number);
    });
}

#[cfg(not(unix))]
pub fn end_programs_first() {}
