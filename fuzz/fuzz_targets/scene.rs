//! Any text to the reader of scenes: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz_bodies::scene::body(data));
