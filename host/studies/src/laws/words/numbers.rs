//! Numbers and costs as people read them.

use crate::laws::LawStudy;
use crate::laws::costs::Costs;
use crepitus_pages::plot::number::{rounded, scientific};

/// A share in percent, without the sign: two digits, and no more than mean something.
pub(crate) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent.is_nan() {
        "–".to_owned()
    } else if percent == 0.0 {
        "0".to_owned()
    } else if percent < 0.01 {
        "<0.01".to_owned()
    } else if percent < 0.995 {
        format!("{percent:.2}")
    } else if percent < 9.95 {
        format!("{percent:.1}")
    } else {
        format!("{percent:.0}")
    }
}

/// A number of any size, in three digits.
pub(crate) fn plain(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 || (1e-3..1e6).contains(&size) {
        rounded(x)
    } else {
        scientific(x)
    }
}

/// A number that may not be known.
pub(crate) fn known(x: Option<f64>) -> String {
    x.map_or_else(|| "–".to_owned(), plain)
}

/// Returns whether every law was run on the controller.
pub(crate) fn is_on_controller(study: &LawStudy) -> bool {
    !study.costs.is_empty() && study.costs.iter().all(|costs| costs.controller.is_some())
}

/// Unit of the cost by which laws are compared.
pub(crate) fn unit_of_cost(study: &LawStudy) -> &'static str {
    if is_on_controller(study) {
        "cycles"
    } else {
        "ns"
    }
}

/// Costs of a law.
pub(crate) fn costs_of<'s>(study: &'s LawStudy, law: &str) -> Option<&'s Costs> {
    study.costs.iter().find(|costs| costs.law == law)
}

/// Cost of a step without its unit; `–` if it was not measured.
pub(crate) fn cost(study: &LawStudy, law: &str) -> String {
    let cost = costs_of(study, law).map(Costs::of_a_step);
    let cost = cost.filter(|cost| cost.is_finite());
    cost.map_or_else(
        || "–".to_owned(),
        |cost| {
            if cost < 9.95 {
                format!("{cost:.1}")
            } else {
                format!("{cost:.0}")
            }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_mean_something() {
        for (share, text) in [
            (0.0, "0"),
            (3e-6, "<0.01"),
            (0.001_234, "0.12"),
            (0.0345, "3.5"),
            (0.347, "35"),
            (1.0, "100"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(percent(share), text);
        }
        assert_eq!(plain(0.4), "0.4");
        assert_eq!(plain(-2.5e-7), "−2.5·10⁻⁷");
        assert_eq!(known(None), "–");
    }
}
