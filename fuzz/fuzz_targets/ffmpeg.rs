#![no_main]

use scaleproof_fuzz as entry;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entry::ffmpeg(bytes));
