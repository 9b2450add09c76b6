//! Ctrl-C while programs of others run for this one.

/// Ends them before an interruption ends this program.
#[cfg(unix)]
pub(in crate::cli) fn end_programs_first() {
    use tokio::signal::unix::{SignalKind, signal};

    std::thread::spawn(|| {
        let Ok(runtime) = tokio::runtime::Builder::new_current_thread().enable_all().build() else {
            return;
        };
        runtime.block_on(async {
            let kinds = [SignalKind::interrupt(), SignalKind::terminate(), SignalKind::hangup()];
            let [Ok(mut interrupt), Ok(mut terminate), Ok(mut hangup)] = kinds.map(signal) else {
                return;
            };
            let number = tokio::select! {
                _ = interrupt.recv() => 2,
                _ = terminate.recv() => 15,
                _ = hangup.recv() => 1,
            };
            scaleproof_detect::kill_programs();
            std::process::exit(128 + number);
        });
    });
}

#[cfg(not(unix))]
pub(in crate::cli) fn end_programs_first() {}
