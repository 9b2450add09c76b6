//! Memory for photos and pictures: kept for the next one, and in large pages.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Once;

/// Lets this process keep memory that it frees, instead of giving it back to the system and taking it again, zeroed page by page, for
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

/// The system's allocator, which asks for large pages where much memory is wanted at once: a photo of 12 megapixels, too large for [`keep`], then
/// takes 18 of the kernel's pages instead of 9,000, and `score` of such photos a tenth less processor time. Does nothing more off Linux.
pub struct LargePages;

/// Below this, [`keep`] has what is needed; a large page has 2 MiB.
const LARGE_BYTES: usize = 4 << 20;

// SAFETY: the system's allocator, unchanged; what `in_large_pages` does to its memory changes no content.
unsafe impl GlobalAlloc for LargePages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        in_large_pages(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        in_large_pages(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, start: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        in_large_pages(unsafe { System.realloc(start, layout, bytes) }, bytes)
    }

    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        unsafe { System.dealloc(start, layout) };
    }
}

fn in_large_pages(start: *mut u8, bytes: usize) -> *mut u8 {
    if bytes >= LARGE_BYTES && !start.is_null() {
        advise_large_pages(start, bytes);
    }
    start
}

#[cfg(target_os = "linux")]
fn advise_large_pages(start: *mut u8, bytes: usize) {
    use std::ffi::{c_int, c_void};

    const PAGE_BYTES: usize = 4096;
    // asm-generic/mman-common.h
    const MADV_HUGEPAGE: c_int = 14;
    unsafe extern "C" {
        fn madvise(start: *mut c_void, bytes: usize, advice: c_int) -> c_int;
    }
    let skipped = start.align_offset(PAGE_BYTES);
    let whole = bytes.saturating_sub(skipped) / PAGE_BYTES * PAGE_BYTES;
    // SAFETY: whole pages within memory that was just allocated; a kernel without large pages refuses, which changes nothing.
    unsafe { madvise(start.wrapping_add(skipped).cast(), whole, MADV_HUGEPAGE) };
}

#[cfg(not(target_os = "linux"))]
fn advise_large_pages(_: *mut u8, _: usize) {}
