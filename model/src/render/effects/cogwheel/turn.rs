//! Turn of the wheel between two ticks, and the edges on its way.

use crate::real::Real;

/// Fractions of a tooth that are shifted out for a ratio of two of them.
const COARSE: u32 = 24;

/// Turn of the wheel in a travel, 2⁻⁶⁴ of a tooth.
pub(super) struct Turn {
    pub(super) before: u64,
    pub(super) turned: u64,
    pub(super) back: bool,
}

impl Turn {
    /// Distance from a place in a tooth to another, in the sense of the turn.
    pub(super) fn distance(&self, from: u64, to: u64) -> u64 {
        if self.back {
            from.wrapping_sub(to)
        } else {
            to.wrapping_sub(from)
        }
    }

    /// The share of the travel after which it came to an edge; 0 if that was
    /// before.
    pub(super) fn share<F: Real>(&self, edge: u64) -> F {
        let passed = self.distance(self.before, edge);
        if passed > self.turned {
            return F::ZERO;
        }
        let whole = (self.turned >> COARSE).max(1);
        F::from_whole(passed >> COARSE) / F::from_whole(whole)
    }
}
