//! Steps of a study.

/// Steps of a full study, s.
pub const FULL_STEPS_S: [f64; 9] = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6];

/// Steps of a quick one, s.
pub const QUICK_STEPS_S: [f64; 5] = [1e-3, 2e-4, 1e-4, 5e-5, 2e-5];

/// Sorts steps, longest first, without duplicates.
pub(crate) fn falling(steps_s: &[f64]) -> Vec<f64> {
    let mut steps_s = steps_s.to_vec();
    steps_s.sort_by(|a, b| b.total_cmp(a));
    steps_s.dedup();
    steps_s
}
