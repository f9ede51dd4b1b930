//! Torque and slew limits.
//!
//! While the bridge floats the limit is zero; from arming on it grows with the
//! slew limit up to the joint's largest torque, so a stick under full torque
//! does not jolt.

use super::{Limit, Limits, Shown};
use crate::real::Real;

/// The largest torque, and how fast it may be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimits<F> {
    most_nm: F,
    /// Growth of the limit in a tick, N·m.
    slew_nm: F,
    /// Present limit, N·m.
    allowance_nm: F,
    is_energised: bool,
}

impl<F: Real> TorqueLimits<F> {
    /// Limits of a device that is not armed.
    pub fn new(most_nm: F, slew_nm: F) -> Self {
        Self {
            most_nm,
            slew_nm,
            allowance_nm: F::ZERO,
            is_energised: false,
        }
    }

    /// Limits of a device that was armed long ago.
    pub fn armed(most_nm: F, slew_nm: F) -> Self {
        Self {
            allowance_nm: most_nm,
            is_energised: true,
            ..Self::new(most_nm, slew_nm)
        }
    }

    /// Applies these numbers from the next tick on.
    pub fn change(&mut self, most_nm: F, slew_nm: F) {
        self.most_nm = most_nm;
        self.slew_nm = slew_nm;
    }

    /// Returns whether the bridge is driven in the next tick.
    #[inline]
    pub fn set_energised(&mut self, is_energised: bool) {
        self.is_energised = is_energised;
    }
}

impl<F: Real> Limits<F> for TorqueLimits<F> {
    #[inline]
    fn tick(&mut self, shown: &mut Shown<F>) {
        if !self.is_energised {
            self.allowance_nm = F::ZERO;
            shown.torque_nm = F::ZERO;
            shown.limit = Limit::NotArmed;
            return;
        }
        let most_nm = if self.allowance_nm > self.most_nm {
            // The limit was lowered, and is followed as torque is: no jolt.
            shown.settling = true;
            (self.allowance_nm - self.slew_nm).at_least(self.most_nm)
        } else {
            (self.allowance_nm + self.slew_nm).at_most(self.most_nm)
        };
        self.allowance_nm = most_nm;
        // NaN compares false with every limit: it passes, and is detected
        // by what follows.
        if shown.torque_nm.abs() > most_nm {
            self.cut(shown);
        }
    }
}

impl<F: Real> TorqueLimits<F> {
    /// Shows no more than the allowance.
    #[cold]
    fn cut(&self, shown: &mut Shown<F>) {
        let (wanted_nm, most_nm) = (shown.torque_nm, self.allowance_nm);
        shown.limit = if most_nm == self.most_nm {
            Limit::Torque
        } else {
            Limit::Slew
        };
        shown.torque_nm = if wanted_nm < F::ZERO {
            -most_nm
        } else {
            most_nm
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(torque_nm: f32) -> Shown<f32> {
        Shown {
            torque_nm,
            ..Shown::nothing()
        }
    }

    fn after(limits: &mut TorqueLimits<f32>, torque_nm: f32) -> (f32, Limit) {
        let mut shown = shown(torque_nm);
        limits.tick(&mut shown);
        (shown.torque_nm, shown.limit)
    }

    #[test]
    fn from_arming_on_the_limit_grows() {
        let mut limits = TorqueLimits::new(1.0, 0.25);
        assert_eq!(after(&mut limits, 0.5), (0.0, Limit::NotArmed));
        limits.set_energised(true);
        assert_eq!(after(&mut limits, -0.5), (-0.25, Limit::Slew));
        assert_eq!(after(&mut limits, -0.5), (-0.5, Limit::None));
        assert_eq!(after(&mut limits, 2.0), (0.75, Limit::Slew));
        assert_eq!(after(&mut limits, 2.0), (1.0, Limit::Torque));
        assert_eq!(after(&mut limits, -2.0), (-1.0, Limit::Torque));
        // Disarmed, it begins again.
        limits.set_energised(false);
        assert_eq!(after(&mut limits, 0.1), (0.0, Limit::NotArmed));
        limits.set_energised(true);
        assert_eq!(after(&mut limits, 2.0), (0.25, Limit::Slew));
    }

    #[test]
    fn a_limit_that_is_lowered_is_followed_without_a_jolt() {
        let mut limits = TorqueLimits::armed(1.0, 0.25);
        assert_eq!(after(&mut limits, 2.0), (1.0, Limit::Torque));
        limits.change(0.4, 0.25);
        assert_eq!(after(&mut limits, 2.0), (0.75, Limit::Slew));
        assert_eq!(after(&mut limits, 2.0), (0.5, Limit::Slew));
        assert_eq!(after(&mut limits, 2.0), (0.4, Limit::Torque));
        assert_eq!(after(&mut limits, 0.4), (0.4, Limit::None));
    }

    #[test]
    fn until_a_lowered_limit_is_reached_parameters_settle() {
        let mut limits = TorqueLimits::armed(1.0, 0.25);
        limits.change(0.4, 0.25);
        let mut settles = || {
            let mut shown = shown(0.0);
            limits.tick(&mut shown);
            shown.settling
        };
        assert!(settles() && settles() && settles());
        assert!(!settles());
    }

    #[test]
    fn nan_passes_and_an_earlier_reason_is_kept() {
        let mut limits = TorqueLimits::armed(1.0, 0.25);
        assert!(after(&mut limits, f32::NAN).0.is_nan());
        let mut held = shown(0.3);
        held.limit = Limit::Holding;
        limits.tick(&mut held);
        assert_eq!((held.torque_nm, held.limit), (0.3, Limit::Holding));
    }
}
