//! Any samples to a guarded joint: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz_bodies::guarded::body(data));
