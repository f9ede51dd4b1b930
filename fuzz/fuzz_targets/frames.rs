//! Any bytes to the decoder of frames: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz::frames::body(data));
