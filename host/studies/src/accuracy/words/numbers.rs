//! Numbers as a person reads them.

use crepitus_pages::table::show::scientific;

/// An error with its unit.
pub(super) fn with_unit(x: f64, unit: &str) -> String {
    if unit.is_empty() {
        scientific(x)
    } else {
        format!("{} {unit}", scientific(x))
    }
}

/// A number in three digits, never with an exponent.
pub(super) fn plain(x: f64) -> String {
    if !(x.abs() > 0.0 && x.is_finite()) {
        return format!("{x}");
    }
    let digits = (0..9)
        .zip([100.0, 10.0, 1.0, 0.1, 0.01, 1e-3, 1e-4, 1e-5, 1e-6])
        .find(|(_, above)| x.abs() >= *above)
        .map_or(9, |(digits, _)| digits);
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(with_unit(0.0, "s"), "0 s");
        assert_eq!(plain(1234.5), "1234");
        assert_eq!(plain(68.32), "68.3");
        assert_eq!(plain(3.456), "3.46");
        assert_eq!(plain(0.00683), "0.00683");
        assert_eq!(plain(0.0), "0");
    }
}
