//! Anything from hosts and the drive to the comms controller: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz::comms::body(data));
