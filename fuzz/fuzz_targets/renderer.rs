//! Samples and changes of parameters to the renderer: see the body.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crepitus_fuzz::renderer::body(data));
