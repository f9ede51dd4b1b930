//! Identified values beside their truth, and the page of the book that has the result.

#![allow(dead_code, reason = "each test uses its part")]

#[path = "../../../../sim/virtual-device/tests/book/mod.rs"]
mod book;

use book::Page;
use crepitus_identify::Estimate;
use crepitus_identify::brace::{Brace, Quantity, QuantityResult};

/// The page of the results.
pub(crate) const PAGE: Page = Page {
    file: "identification.md",
    bless: "cargo test -p crepitus-identify --test hidden_braces --test second_simulation --test imperfections -- --test-threads=1",
};

/// A visible value with its truth, in the unit of its quantity.
#[derive(Clone, Copy)]
pub(crate) struct Compared {
    pub(crate) quantity: Quantity,
    pub(crate) estimate: Estimate,
    pub(crate) truth: f64,
}

impl Compared {
    /// Returns whether the interval holds the truth.
    pub(crate) fn holds(&self) -> bool {
        self.estimate.holds(self.truth)
    }

    /// Relative error, %.
    pub(crate) fn error_percent(&self) -> f64 {
        100.0 * (self.estimate.value / self.truth - 1.0)
    }
}

/// Compares the values of a brace with the truth, and prints each; returns the visible ones.
pub(crate) fn compared(
    name: &str,
    brace: &Brace,
    truth: impl Fn(Quantity) -> f64,
) -> Vec<Compared> {
    println!("{name}: {:.4}° rms left", brace.rms_rad.to_degrees());
    let mut visible = Vec::new();
    for shown in &brace.shown {
        let (quantity, truth) = (shown.quantity, truth(shown.quantity));
        print!("  {:24} {truth:10.5}  ", quantity.name());
        let QuantityResult::Seen(estimate) = shown.result else {
            println!("not visible");
            continue;
        };
        let it = Compared {
            quantity,
            estimate,
            truth,
        };
        println!(
            "{:10.5} ± {:8.5} {}",
            estimate.value,
            estimate.half_width,
            if it.holds() { "inside" } else { "OUTSIDE" }
        );
        visible.push(it);
    }
    visible
}
