#![no_main]

use scaleproof::fuzz_entry as entry;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entry::npy(bytes));
