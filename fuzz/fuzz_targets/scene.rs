//! Any text to the reader of scenes: see the body.
#![no_main]

use crepitus_fuzz_bodies::mutate;

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz_bodies::scene::body(data));

libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    if seed.is_multiple_of(mutate::ONE_IN)
        && let Some(changed) = mutate::other_key(&data[..size], seed / mutate::ONE_IN)
        && changed.len() <= max_size
    {
        data[..changed.len()].copy_from_slice(&changed);
        changed.len()
    } else {
        libfuzzer_sys::fuzzer_mutate(data, size, max_size)
    }
});
