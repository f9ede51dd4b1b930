//! Any finite motion to a raw joint: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz_bodies::step::body(data));
