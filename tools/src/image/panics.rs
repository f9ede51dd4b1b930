//! Functions that mean a panic, by their names.

/// Returns whether control that gets here has panicked, or is in a fault handler,
/// which to an interrupt is the same.
///
/// Names are demangled and without hash. The path decides where a name alone
/// could be anybody's: `core::result::unwrap_failed`, but not
/// `motor::unwrap_failed`.
pub fn is_panic(name: &str) -> bool {
    const HANDLERS: [&str; 12] = [
        "rust_begin_unwind",
        "rust_panic",
        "panic_handler",
        "__rust_start_panic",
        "_defmt_panic",
        "__cxa_pure_virtual",
        "abort",
        "HardFault",
        "HardFault_",
        "HardFaultTrampoline",
        "DefaultHandler",
        "DefaultHandler_",
    ];
    let path = name.trim_start_matches('<');
    let last = path.rsplit("::").next().unwrap_or(path);
    if HANDLERS.contains(&last) || path.split("::").any(|part| part == "panicking") {
        return true;
    }
    // Methods of slices and strings stand below their type: `<[u8]>::…`.
    let standard = ["core::", "alloc::", "std::", "defmt::", "[", "str>"];
    let failing = last.contains("panic")
        || last.ends_with("_fail")
        || last.ends_with("_failed")
        || matches!(
            last,
            "handle_error" | "handle_alloc_error" | "capacity_overflow"
        );
    let panics = last == "panic" || last.starts_with("panic_") || last.ends_with("_panic");
    panics || failing && standard.iter().any(|root| path.starts_with(root))
}

#[cfg(test)]
mod tests {
    use super::is_panic;

    #[test]
    fn knows_the_ways_to_panic() {
        for name in [
            "core::panicking::panic_fmt",
            "core::panicking::panic_bounds_check",
            "core::panicking::panic_const::panic_const_div_by_zero",
            "core::option::unwrap_failed",
            "core::option::expect_failed",
            "core::result::unwrap_failed",
            "core::slice::index::slice_end_index_len_fail",
            "core::slice::index::slice_index_fail",
            "core::slice::copy_from_slice_impl::len_mismatch_fail",
            "<[_]>::copy_from_slice::len_mismatch_fail",
            "core::str::slice_error_fail",
            "core::cell::panic_already_borrowed",
            "alloc::raw_vec::handle_error",
            "alloc::alloc::handle_alloc_error",
            "__rustc::rust_begin_unwind",
            "_defmt_panic",
            "defmt::export::panic",
            "HardFault",
            "DefaultHandler_",
        ] {
            assert!(is_panic(name), "{name}");
        }
    }

    #[test]
    fn leaves_others_alone() {
        for name in [
            "crepitus_device::drive::Drive::tick",
            "motor::arming_failed",
            "core::fmt::write",
            "core::result::Result<T,E>::unwrap_or",
            "TIM3",
            "<app::Trace as core::ops::Drop>::drop",
        ] {
            assert!(!is_panic(name), "{name}");
        }
    }
}
