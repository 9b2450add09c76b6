//! The largest file that this process may write.

/// Lets a file that grows past what the system lets this process write (`ulimit -f`) fail to be written, as on a full disk; a process that does not
/// ask for that is ended by the signal SIGXFSZ, without a word. Programs that are started from here inherit it. Does nothing off Linux and macOS.
#[cfg(any(target_os = "linux", target_os = "macos"))]
pub fn fail_instead_of_ending() {
    use std::ffi::c_int;

    // signal.h of both
    const SIGXFSZ: c_int = 25;
    const SIG_IGN: usize = 1;
    unsafe extern "C" {
        fn signal(number: c_int, action: usize) -> usize;
    }
    // SAFETY: the C library's function with two of its own constants; no handler of ours runs.
    unsafe { signal(SIGXFSZ, SIG_IGN) };
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
pub fn fail_instead_of_ending() {}
