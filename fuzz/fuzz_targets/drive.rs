//! Anything from the link and any readings to the drive controller: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz_bodies::drive::body(data));
