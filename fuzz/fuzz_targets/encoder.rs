//! Counts to the reader of the encoder: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz::encoder::body(data));
