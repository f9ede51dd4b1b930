//! Samples and changes of all symptoms under way: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz::symptoms::body(data));
