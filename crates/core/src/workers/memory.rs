//! Memory that one photo or picture took is kept for the next one.

use std::sync::Once;

/// From now on this process keeps memory that it frees, instead of giving it back to the system and taking it again, zeroed page by page, for
/// every picture: 2,300 pages for one of yolox_nano's gradients, for which two threads wait on each other. Does nothing without glibc.
pub fn keep() {
    static KEPT: Once = Once::new();
    KEPT.call_once(retain_freed_memory);
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn retain_freed_memory() {
    use std::ffi::c_int;

    // malloc.h
    const M_TRIM_THRESHOLD: c_int = -1;
    const M_TOP_PAD: c_int = -2;
    const M_MMAP_THRESHOLD: c_int = -3;
    unsafe extern "C" {
        fn mallopt(parameter: c_int, value: c_int) -> c_int;
    }
    for (parameter, bytes) in [
        (M_TRIM_THRESHOLD, c_int::MAX),
        (M_TOP_PAD, 16 << 20),
        (M_MMAP_THRESHOLD, 32 << 20),
    ] {
        // SAFETY: glibc's function; it ignores a parameter that it does not know.
        unsafe { mallopt(parameter, bytes) };
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn retain_freed_memory() {}
