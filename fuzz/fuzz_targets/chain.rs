//! Hosts, both controllers and the link between them: see the body.
#![no_main]

use crepitus_fuzz_bodies::mutate;

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz_bodies::chain::body(data));

libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    if seed.is_multiple_of(mutate::ONE_IN) {
        let seed = seed / mutate::ONE_IN;
        let changed = mutate::more_operations(&data[..size], &mutate::CHAIN, seed);
        if changed.len() <= max_size {
            data[..changed.len()].copy_from_slice(&changed);
            return changed.len();
        }
    }
    libfuzzer_sys::fuzzer_mutate(data, size, max_size)
});
