//! Style of a verdict: its colour, a sign that means the same without
//! colour, a short number, and all of it in words.

use super::scale::{self, Tone};
use crate::stability::{Cell, Failure, Rung, Verdict};

/// Sign of a criterion without a number that is met, and of the reference.
pub(super) const MET: &str = "✓";
/// Prefix of the number of a cell that degrades.
pub(super) const DEGRADES: &str = "↓";
/// Prefix of the details of a failing cell.
pub(super) const FAILS: &str = "✗";
/// Suffix of warnings of the run itself.
pub(super) const FLAG: &str = "⚑";

/// Colour of a cell, with sign and number.
pub(super) fn look(cell: &Cell) -> (Tone, String) {
    match &cell.verdict {
        // The reference is what the others are measured with.
        Verdict::Holds(margin) if margin.is_number() && cell.subject.solver != Rung::Reference => {
            (scale::holds(margin.share()), short(margin.measured))
        }
        Verdict::Holds(_) => (scale::holds(0.0), MET.to_owned()),
        Verdict::Degrades { margin, .. } => {
            let number = short(margin.measured);
            (scale::DEGRADES, format!("{DEGRADES}{number}"))
        }
        Verdict::Fails { what, .. } => (scale::FAILS, format!("{FAILS}{}", failure(*what))),
    }
}

/// A cell in words, without the case.
pub(super) fn words(cell: &Cell) -> String {
    let must = if cell.must_hold { ", must hold" } else { "" };
    let detail = match cell.detail.as_str() {
        "" => String::new(),
        detail => format!("; {detail}"),
    };
    format!("{}{must}: {}{detail}", cell.subject, cell.verdict)
}

fn failure(what: Failure) -> String {
    match what {
        Failure::Overflow => "∞".to_owned(),
        Failure::AboveTheLimit => "Ts".to_owned(),
        Failure::OtherEvents { found, .. } => short_count(found),
        _ => String::new(),
    }
}

fn short_count(count: u64) -> String {
    if count < 10_000 {
        format!("{count}")
    } else {
        short(count as f64)
    }
}

/// Formats a number in at most five characters: `2e-13`, `0.37`, `1002`.
fn short(x: f64) -> String {
    let size = x.abs();
    if x == x.trunc() && size < 10_000.0 {
        format!("{x}")
    } else if (10.0..10_000.0).contains(&size) {
        format!("{x:.0}")
    } else if (1.0..10.0).contains(&size) {
        format!("{x:.1}")
    } else if (0.01..1.0).contains(&size) {
        // What rounds to one is not below it.
        format!("{x:.2}")
    } else if x.is_nan() {
        "–".to_owned()
    } else if x.is_infinite() {
        "∞".to_owned()
    } else {
        format!("{x:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_a_cell() {
        for (x, text) in [
            (0.0, "0"),
            (2.1e-13, "2e-13"),
            (637.0, "637"),
            (0.372, "0.37"),
            (3.21, "3.2"),
            (28.11, "28"),
            (5e-5, "5e-5"),
            (1.2e9, "1e9"),
            (f64::NAN, "–"),
            (f64::INFINITY, "∞"),
        ] {
            assert_eq!(short(x), text);
        }
        assert_eq!(short_count(636), "636");
        assert_eq!(short_count(134_398), "1e5");
    }
}
