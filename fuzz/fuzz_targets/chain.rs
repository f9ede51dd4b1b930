//! Hosts, both controllers and the link between them: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz_bodies::chain::body(data));
