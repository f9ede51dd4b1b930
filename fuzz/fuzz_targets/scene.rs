//! Any text to the reader of scenes: see the body.
#![no_main]

use crepitus_fuzz::mutate;

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz::scene::body(data));

libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate::apply(data, (size, max_size), seed, mutate::other_key)
        .unwrap_or_else(|| libfuzzer_sys::fuzzer_mutate(data, size, max_size))
});
