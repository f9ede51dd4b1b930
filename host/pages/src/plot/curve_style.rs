//! Style of a curve: drawn by colour, dashes and signs together, so that it is
//! distinguishable for the colour-blind and in grey print.

use crate::plot::marker::Marker;
use crate::plot::palette::{CURVES, Ink, TEXT};
use crate::plot::stroke::Stroke;

/// The dashes of lines, CSS pixels; none is a full line.
const DASHES: [&str; 5] = ["", "6.5 3.5", "1.75 2.75", "7.5 2.5 1.75 2.5", "13 4"];

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct CurveStyle {
    /// Colour of line and sign.
    pub ink: Ink,
    /// Lengths of dashes and gaps, CSS pixels.
    pub dashes: &'static str,
    /// The sign of its points.
    pub marker: Marker,
}

impl CurveStyle {
    /// Style of no curve: for entries that apply to all.
    pub const NEUTRAL: Self = Self {
        ink: TEXT,
        dashes: "",
        marker: Marker::Circle,
    };

    /// Style of the curve at this place. The numbers of colours, dashes and signs
    /// have no common divisor: the first 360 curves all differ.
    pub fn of(place: usize) -> Self {
        Self {
            ink: CURVES[place % CURVES.len()],
            dashes: DASHES[place % DASHES.len()],
            marker: Marker::ALL[place % Marker::ALL.len()],
        }
    }

    /// The line of the curve.
    pub fn stroke(self) -> Stroke {
        Stroke {
            ink: self.ink,
            width: 1.75,
            dashes: self.dashes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_has_its_own_style() {
        let styles: Vec<CurveStyle> = (0..360).map(CurveStyle::of).collect();
        for (i, a) in styles.iter().enumerate() {
            for b in &styles[i + 1..] {
                assert!(a.ink != b.ink || a.dashes != b.dashes || a.marker != b.marker);
            }
        }
        // Two of the first ten that share a colour share nothing else, and
        // hardly one shares dashes and colour in grey.
        for (i, a) in styles[..10].iter().enumerate() {
            for b in &styles[i + 1..10] {
                if a.ink == b.ink {
                    assert!(a.dashes != b.dashes && a.marker != b.marker);
                }
                assert!(a.dashes != b.dashes || a.marker != b.marker);
            }
        }
    }
}
