//! Style of a line: colour, width, dashes.

use crate::plot::palette::{Ink, TEXT};

/// Style of a line.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Colour of the line.
    pub ink: Ink,
    /// CSS pixels.
    pub width: f64,
    /// Lengths of dashes and gaps, CSS pixels; empty for a full line.
    pub dashes: &'static str,
}

impl Stroke {
    /// The dotted line of a moment.
    pub(crate) const MOMENT: Self = Self {
        ink: TEXT,
        width: 1.0,
        dashes: "2 3",
    };

    /// A full line.
    pub fn new(ink: Ink, width: f64) -> Self {
        Self {
            ink,
            width,
            dashes: "",
        }
    }

    /// A dashed line.
    pub fn dashed(ink: Ink, width: f64) -> Self {
        Self {
            dashes: "6 4",
            ..Self::new(ink, width)
        }
    }
}
