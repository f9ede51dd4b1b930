//! Quantities with their identification results.

use crate::Estimate;
use crate::brace::quantity::Quantity;

/// Identification result of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub enum Result {
    /// Value in the unit of the quantity's [spec](Quantity::spec), with its 95 % confidence
    /// interval.
    Seen(Estimate),
    /// Not identifiable from these recordings.
    NotVisible {
        /// Reason, and what to record to see it.
        why: String,
    },
}

/// A quantity with its identification result.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The quantity.
    pub quantity: Quantity,
    /// Value of the quantity, or why it is not visible.
    pub result: Result,
}
