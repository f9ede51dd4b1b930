//! How a curve is drawn: by colour, dashes and signs together, so that it is
//! told apart by the colour-blind and in grey print.

use super::marker::Marker;
use super::overlay::Overlay;
use crate::palette::{CURVES, Ink, TEXT};

/// The dashes of lines, in grid lines; none is a full line.
const DASHES: [&str; 5] = ["", "26 14", "7 11", "30 10 7 10", "52 16"];

/// See the module.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hand {
    pub(crate) ink: Ink,
    pub(crate) dashes: &'static str,
    pub(crate) marker: Marker,
}

impl Hand {
    /// Of no rung: for what is said of all.
    pub(crate) const NEUTRAL: Self = Self {
        ink: TEXT,
        dashes: "",
        marker: Marker::Circle,
    };

    /// Of the rung at this place. The numbers of colours, dashes and signs
    /// have no common divisor: the first 360 rungs all differ.
    pub(crate) fn of(rung: usize) -> Self {
        Self {
            ink: CURVES[rung % CURVES.len()],
            dashes: DASHES[rung % DASHES.len()],
            marker: Marker::ALL[rung % Marker::ALL.len()],
        }
    }

    /// For legends: a stretch of the curve.
    pub(crate) fn sample(self) -> String {
        let mut over = Overlay::default();
        over.line(&[(8, 32), (168, 32)], self);
        over.marker((88, 32), self, false, "");
        sample(&over.finish())
    }

    /// For legends: the sign, filled.
    pub(crate) fn filled_sample(self) -> String {
        let mut over = Overlay::default();
        over.marker((88, 32), self, true, "");
        sample(&over.finish())
    }
}

fn sample(elements: &str) -> String {
    format!(
        "<svg class=\"sample\" width=\"44\" height=\"16\" viewBox=\"0 0 176 64\" \
         aria-hidden=\"true\">{elements}</svg>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rung_has_its_own_hand() {
        let hands: Vec<Hand> = (0..360).map(Hand::of).collect();
        for (i, a) in hands.iter().enumerate() {
            for b in &hands[i + 1..] {
                assert!(a.ink.hex() != b.ink.hex() || a.dashes != b.dashes || a.marker != b.marker);
            }
        }
        // Two rungs of the ladder that share a colour share nothing else, and
        // hardly one shares dashes and colour in grey.
        for (i, a) in hands[..10].iter().enumerate() {
            for b in &hands[i + 1..10] {
                if a.ink.hex() == b.ink.hex() {
                    assert!(a.dashes != b.dashes && a.marker != b.marker);
                }
                assert!(a.dashes != b.dashes || a.marker != b.marker);
            }
        }
    }
}
