//! The free motion of the object, for as long as a slip lasts.
//!
//! The model keeps the change over a step, C − 1, which is what a short step
//! needs. Over a long one a damped object loses its initial state: there C
//! itself, with its common factor e^(−a·u), keeps the digits of what is left.

use crepitus_model::Parameters;
use crepitus_model::joint::oscillator::Oscillator;

/// Up to this a·u the change over the time is the exact one to use.
const SHORT: f64 = 0.5;

/// The object's free motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swing {
    oscillator: Oscillator<f64>,
    /// ωn², rad²/s².
    natural_squared: f64,
    /// a = c/2J, 1/s.
    decay: f64,
    /// Whether it swings at all: below critical damping.
    swings: bool,
    /// √|ωn² − a²|, rad/s.
    root: f64,
}

impl Swing {
    pub(super) fn of(parameters: &Parameters) -> Self {
        let natural = parameters.natural_rad_s();
        let decay = 0.5 * parameters.damping_nms_per_rad / parameters.inertia_kg_m2;
        let discriminant = (natural - decay) * (natural + decay);
        Self {
            oscillator: Oscillator::of(parameters),
            natural_squared: parameters.stiffness_nm_per_rad / parameters.inertia_kg_m2,
            decay,
            swings: discriminant > 0.0,
            root: discriminant.abs().sqrt(),
        }
    }

    /// The oscillator, for its bounds.
    pub(super) fn oscillator(&self) -> &Oscillator<f64> {
        &self.oscillator
    }

    /// A bound of |v̈| from (x, v) on, rad/s³. Far above critical damping the model's would
    /// make a search look every few nanoseconds for as long as a slip lasts:
    /// x = A·e^(−λ·t) + B·e^(−Λ·t), and each of the two only falls.
    pub(super) fn jerk_bound(&self, x: f64, v: f64) -> f64 {
        let bound = self.oscillator.jerk_bound(x, v);
        if self.swings || self.root < 0.5 * self.decay {
            return bound;
        }
        let fast = self.decay + self.root;
        let slow = self.natural_squared / fast;
        let fast_part = (v + slow * x).abs() + 4.0 * f64::EPSILON * (v.abs() + slow * x.abs());
        let slow_part = v.abs() + fast * x.abs();
        let parts = slow.powi(3) * slow_part + fast.powi(3) * fast_part;
        bound.min(parts / (fast - slow))
    }

    /// (x, v) after `time_s` ≥ 0.
    pub(super) fn after(&self, x: f64, v: f64, time_s: f64) -> (f64, f64) {
        if self.decay * time_s <= SHORT {
            return self.oscillator.transition(time_s).apply(x, v);
        }
        // S, and C − a·S and C + a·S.
        let (sine, less, more) = if self.swings {
            let left = (-(self.decay * time_s)).exp();
            let (sin, cos) = (self.root * time_s).sin_cos();
            let sine = left * sin / self.root;
            (
                sine,
                left * cos - self.decay * sine,
                left * cos + self.decay * sine,
            )
        } else {
            self.overdamped(time_s)
        };
        (
            more * x + sine * v,
            less * v - self.natural_squared * sine * x,
        )
    }

    /// Two decaying exponentials, without the difference of like numbers.
    fn overdamped(&self, time_s: f64) -> (f64, f64, f64) {
        let fast = self.decay + self.root;
        let slow = self.natural_squared / fast;
        let (e_fast, e_slow) = ((-(fast * time_s)).exp(), (-(slow * time_s)).exp());
        if self.root * time_s < SHORT {
            let apart = 2.0 * self.root * time_s;
            // (e^2ru − 1)/2r, which is u where the roots are one.
            let grown = if apart > 0.0 {
                apart.exp_m1() / apart * time_s
            } else {
                time_s
            };
            let sine = e_fast * grown;
            let cosine = 0.5 * (e_fast + e_slow);
            return (sine, cosine - self.decay * sine, cosine + self.decay * sine);
        }
        let sine = 0.5 * (e_slow - e_fast) / self.root;
        (
            sine,
            0.5 * (e_fast * fast - e_slow * slow) / self.root,
            0.5 * (e_slow * fast - e_fast * slow) / self.root,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_time_is_many_short_ones() {
        for ratio in [0.0, 1e-3, 0.3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 30.0] {
            let mut p = Parameters::default();
            p.damping_nms_per_rad = 2.0 * ratio * p.impedance_nms_per_rad();
            let swing = Swing::of(&p);
            // Ten swings; each step is short, and loses only its own rounding.
            let (mut x, mut v) = (1e-3, 0.7);
            for n in 1..=1000_u32 {
                (x, v) = swing.after(x, v, 1e-4);
                let long = swing.after(1e-3, 0.7, 1e-4 * f64::from(n));
                let scale = v.abs() + p.natural_rad_s() * x.abs();
                assert!(
                    (long.0 - x).abs() * p.natural_rad_s() + (long.1 - v).abs() <= 1e-11 * scale,
                    "ζ = {ratio}, step {n}: {long:?} {:?}",
                    (x, v)
                );
            }
        }
    }

    #[test]
    fn no_jerk_ahead_is_larger_than_its_bound() {
        for ratio in [0.0, 0.3, 1.0, 1.1, 1.2, 1.5, 30.0, 1e3, 1e5] {
            let mut p = Parameters::default();
            p.damping_nms_per_rad = 2.0 * ratio * p.impedance_nms_per_rad();
            let swing = Swing::of(&p);
            let jerk = |x: f64, v: f64| {
                let acceleration = swing.oscillator.acceleration(x, v);
                -swing.natural_squared * v - 2.0 * swing.decay * acceleration
            };
            for (x, v) in [(1e-3, 0.7), (1e-3, -0.7), (-1e-3, 0.0), (0.0, 1.0)] {
                // From fractions of the fast decay to many of the slow one.
                let times = (-120..40).map(|n| 10.0_f64.powf(0.1 * f64::from(n)));
                let states: Vec<_> = times.map(|t| swing.after(x, v, t)).collect();
                for (n, from) in states.iter().enumerate() {
                    let bound = swing.jerk_bound(from.0, from.1);
                    for to in &states[n..] {
                        // What rounding makes of two large terms that cancel.
                        let noise = 1e-15 * (2.0 * swing.decay).powi(2) * to.1.abs();
                        let jerk = jerk(to.0, to.1).abs();
                        assert!(jerk <= 1.000_001 * bound + 8.0 * noise, "ζ = {ratio}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_left_after_a_long_decay_has_all_its_digits() {
        let mut p = Parameters::default();
        p.damping_nms_per_rad = 2.0 * 0.2 * p.impedance_nms_per_rad();
        let swing = Swing::of(&p);
        let half = swing.after(1e-3, 31.0, 0.5);
        let whole = swing.after(1e-3, 31.0, 1.0);
        let twice = swing.after(half.0, half.1, 0.5);
        assert!(whole.1.abs() < 1e-15 && whole.1 != 0.0);
        assert!((whole.1 / twice.1 - 1.0).abs() < 1e-12);
        assert!((whole.0 / twice.0 - 1.0).abs() < 1e-12);
    }
}
