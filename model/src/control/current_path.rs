//! Corrections for the way from a voltage to the current that is measured of it.
//!
//! ```text
//!             ├ bottom of the PWM       middle of the tick ┤
//! half A  ▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔╲________________│________________╱▔▔▔▔▔▔    share ½ + d/2
//! half B  ▔▔▔▔▔▔▔╲____________________________│____________________________╱   ½ − d/2
//! current ╲_____   ╱▔▔▔▔▔▔▔▔▔▔╲______________ i ______________╲  ╱▔▔▔
//! ```
//!
//! **Which amplifier.** Each current amplifier is thrown off by the edge of its own half and needs 9.6 to 9.8 µs
//! until it has settled to 0.5 % (TI on INA240 and TIDA-00913, E2E thread 796955). The edges of the two halves come
//! h/4·(1 ∓ d) before the middle. That of the half that switched earlier is 12.5 µs or more away, whatever the duty d:
//! [`earlier_half_a`].
//!
//! **Lag.** Around the middle both lower switches are closed, so L·di/dt = −(R·i + E). Amplifier and filter show what
//! was λ before, (R·i + E)·λ/L too much. The loop knows R·i + E: the voltage that it explains by current and
//! back-EMF. A dead time delays the pulses by half of itself, so the current at the middle is that of td/2 before
//! their centre, which adds to λ.
//!
//! **Dead time.** While both switches of a half are open its current chooses the level: a half that the current
//! leaves is low, one that it enters is high, by a diode more. Of the four edges of a tick two come at the lowest
//! current of the ripple, i − Δ, and two at the highest, i + Δ. Each pair costs or gives a pulse of td:
//!
//! ```text
//! loss = Vd·½·(sgn(i − Δ) + sgn(i + Δ)),   Vd = (2U + 4Ud)·td/h,   Δ = U·h/4L·|d|·(1 − |d|)
//! ```
//!
//! Without dead time's help a current that reaches zero within a dead time stays there, so the sign is a ramp: U·td/L
//! times 1 − |d| wide at the edge that begins a pulse, |d| at the one that ends it; half of it is taken for both.
//! What is fed forward follows the current that the loop is *expected* to have in the tick in which the voltage acts,
//! not the measured one: a measurement that is fed forward is fed back, with a gain of Vd over the ramp, and rings.
//!
//! Ud is an estimate ([`DIODE_V`]).

use crate::real::Real;

/// Voltage over a diode of the bridge that conducts, V: an estimate for body diodes of MOSFETs at an ampere.
pub const DIODE_V: f64 = 0.8;

/// Slope of the change from one amplifier to the other, and the duty up to which it lasts, 1/8: there the later edge
/// is 9.4 µs and more before the first sample, so both are settled. Gains that differ make no step.
const CHANGE: f64 = 4.0;

/// The least half of a ramp's width, A: below it is a sign.
const LEAST_WIDTH_A: f64 = 1e-6;

/// The current by the amplifier of the half that switched earlier, A: that of half A where the duty is negative, of
/// half B where it is positive.
#[inline]
pub fn earlier_half_a<F: Real>(half_a: F, half_b: F, duty: F) -> F {
    let share = F::HALF + (F::from_f64(CHANGE) * duty).within(F::HALF);
    half_a + share * (half_b - half_a)
}

/// The way that is corrected, and the winding behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathNumbers {
    /// L, H.
    pub inductance_h: f64,
    /// U, V.
    pub supply_v: f64,
    /// td, s.
    pub dead_time_s: f64,
    /// λ, s.
    pub lag_s: f64,
}

/// Corrections of one loop, and what they remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathCorrection<F> {
    /// λ/L, A/V.
    lag: F,
    /// td/2L, A/V.
    half_dead: F,
    /// Vd, V.
    dead_v: F,
    /// U·h/4L, A.
    ripple_a: F,
    /// 1/U, 1/V.
    per_supply: F,
    /// Reciprocal of half of the ramp's width, 1/A.
    per_width: F,
    /// Share of what the current lacks that it gains in a tick.
    reach: F,
    /// Current that is expected in the tick in which the last voltage acts, A.
    expected_a: F,
    /// Difference of setpoint and expected current a tick ago, A.
    lacked_a: F,
    /// Share of the dead time's voltage that was fed forward last.
    share: F,
}

impl<F: Real> PathCorrection<F> {
    /// Corrections in ticks of `step_s`; none if there is nothing to correct. `reach` is the share of what the current
    /// lacks that the loop gives it in a tick.
    pub fn new(numbers: &PathNumbers, step_s: f64, reach: f64) -> Option<Self> {
        let PathNumbers {
            inductance_h,
            supply_v,
            dead_time_s: dead_s,
            lag_s,
        } = *numbers;
        if dead_s <= 0.0 && lag_s <= 0.0 {
            return None;
        }
        let width_a = (0.5 * supply_v * dead_s / inductance_h).max(LEAST_WIDTH_A);
        Some(Self {
            lag: F::from_f64(lag_s / inductance_h),
            half_dead: F::from_f64(0.5 * dead_s / inductance_h),
            dead_v: F::from_f64((2.0 * supply_v + 4.0 * DIODE_V) * dead_s / step_s),
            ripple_a: F::from_f64(0.25 * supply_v * step_s / inductance_h),
            per_supply: F::from_f64(1.0 / supply_v),
            per_width: F::from_f64(1.0 / width_a),
            reach: F::from_f64(reach),
            expected_a: F::ZERO,
            lacked_a: F::ZERO,
            share: F::ZERO,
        })
    }

    /// The current in the middle of the pulses, A, of the one measured: `explained_v` is R·i + E.
    #[inline]
    pub fn corrected_a(&self, measured_a: F, explained_v: F) -> F {
        measured_a - (self.lag + self.half_dead * self.share.abs()) * explained_v
    }

    /// The voltage to add to one of the loop, V, for this setpoint.
    #[inline]
    pub fn feed_v(&mut self, setpoint_a: F, volts: F) -> F {
        let expected_a = self.expected_a + self.reach * self.lacked_a;
        self.lacked_a = setpoint_a - self.expected_a;
        self.expected_a = expected_a.settled();
        let duty = (volts * self.per_supply).abs();
        let ripple_a = self.ripple_a * duty * (F::ONE - duty);
        let low = ((expected_a - ripple_a) * self.per_width).within(F::ONE);
        let high = ((expected_a + ripple_a) * self.per_width).within(F::ONE);
        self.share = F::HALF * (low + high);
        self.dead_v * self.share
    }

    /// Forgets the current: a bridge that floats has none.
    pub fn reset(&mut self) {
        (self.expected_a, self.lacked_a, self.share) = (F::ZERO, F::ZERO, F::ZERO);
    }
}

#[cfg(test)]
mod tests;
