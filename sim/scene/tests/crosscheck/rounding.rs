//! Sensitivity to the rounding of an f64 solver.
//!
//! A disagreement is meaningful only if the answer does not depend on the
//! last bit of an f64. So the same problem is solved again, as exactly, but
//! with every number that an f64 solver has to store replaced by a neighbour:
//! the parameters and the motion's numbers once, and the time, the angle and
//! the velocity at the end of every step and at every event. A change is
//! uniform within ± `units` · 2⁻⁵³ of the number's natural size.

/// A source of rounding.
#[derive(Clone, Debug)]
pub struct Rounding {
    units: f64,
    rng: fastrand::Rng,
}

impl Rounding {
    /// No rounding at all.
    pub fn none() -> Self {
        Self {
            units: 0.0,
            rng: fastrand::Rng::with_seed(0),
        }
    }

    /// Rounding of up to `units` · 2⁻⁵³, repeatable by its seed.
    pub fn of(units: f64, seed: u64) -> Self {
        Self {
            units,
            rng: fastrand::Rng::with_seed(seed),
        }
    }

    /// Returns whether anything is changed.
    pub fn is_some(&self) -> bool {
        self.units > 0.0
    }

    /// A change of something of this size.
    pub fn change(&mut self, size: f64) -> f64 {
        if !self.is_some() {
            return 0.0;
        }
        let unit = f64::EPSILON / 2.0;
        (2.0 * self.rng.f64() - 1.0) * self.units * unit * size
    }
}
