//! Commit, target and compiler of the package.

use pyo3::prelude::*;

/// Returns commit, target and compiler of the build; a name that is not known is left out.
#[pyfunction]
pub(crate) fn build() -> Vec<(&'static str, &'static str)> {
    let known = [
        ("commit", option_env!("CREPITUS_COMMIT")),
        ("target", option_env!("CREPITUS_TARGET")),
        ("rustc", option_env!("CREPITUS_RUSTC")),
    ];
    let known = known.into_iter();
    known
        .filter_map(|(name, value)| Some((name, value?)))
        .collect()
}
