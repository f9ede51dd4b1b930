//! Any bytes to the readers of recordings: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz::recording::body(data));
