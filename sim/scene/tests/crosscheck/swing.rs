//! The object's free motion in a slip, as Taylor series.
//!
//! With x = θ − s·Tk/kr the object satisfies J·x″ + c·x′ + kr·x = 0, so the
//! coefficients of x(t₀ + h·σ) follow one from another,
//!
//! ```text
//! xₖ₊₂ = −[(c·h/J)·(k+1)·xₖ₊₁ + (kr·h²/J)·xₖ]/((k+1)(k+2))
//! ```
//! The remainder is bounded by the energy. Every derivative
//! of x satisfies the same equation, and R² = (x⁽ⁿ⁺¹⁾)² + ωn²·(x⁽ⁿ⁾)² never grows
//! under it, for no damping, critical damping or any other. So, by Lagrange's
//! form of the remainder, with R of the first omitted derivative at the
//! beginning of the step,
//!
//! ```text
//! |v − Σ| ≤ R·hⁿ/n! = √(((n+1)·xₙ₊₁/h)² + (ωn·xₙ)²)
//! ```
//! and the step is halved until this is below 2⁻¹⁰⁰ of the velocity's size.

use crate::double_double::Dd;
use crate::series::{MOST, Series, number, reciprocal};

/// The degree n of x.
const DEGREE: usize = MOST - 2;
/// Largest remainder of a step, relative to √(v² + ωn²x²): 2⁻¹⁰⁰.
const LEFT_OUT: f64 = 8e-31;

/// The numbers of the free motion.
#[derive(Clone, Copy, Debug)]
pub struct Object {
    /// c/J, 1/s.
    pub damping_per_s: Dd,
    /// kr/J, 1/s².
    pub stiffness_per_s2: Dd,
}

/// The object from an instant on, over a length.
#[derive(Clone, Copy, Debug)]
pub struct Swing {
    /// The length, s.
    pub length_s: Dd,
    /// θ − s·Tk/kr, rad.
    pub x: Series,
    /// θ̇, rad/s.
    pub v: Series,
}

impl Object {
    /// ωn, rad/s.
    pub fn natural_rad_s(&self) -> f64 {
        self.stiffness_per_s2.to_f64().sqrt()
    }

    /// √(v² + ωn²·x²), rad/s: the most that the velocity can be from here on.
    pub fn reach_rad_s(&self, x: Dd, v: Dd) -> f64 {
        v.to_f64().hypot(self.natural_rad_s() * x.to_f64())
    }

    /// A step from (x, v) of at most `longest_s`.
    pub fn swing(&self, x: Dd, v: Dd, longest_s: Dd) -> Swing {
        let reach = self.reach_rad_s(x, v);
        let natural = self.natural_rad_s();
        let start = 1.7 / natural;
        let mut length_s = longest_s.min(Dd::new(start));
        loop {
            let c = self.coefficients(x, v, length_s);
            let h = length_s.to_f64();
            let last = number(DEGREE + 1) * c[DEGREE + 1].to_f64() / h;
            let error = last.hypot(natural * c[DEGREE].to_f64());
            if error <= LEFT_OUT * reach {
                let x = Series::of(&c[..=DEGREE], error * h / number(DEGREE + 1));
                return Swing {
                    length_s,
                    v: x.derivative(Dd::ONE / length_s, error),
                    x,
                };
            }
            length_s = length_s.scaled(0.5);
        }
    }

    fn coefficients(&self, x: Dd, v: Dd, length_s: Dd) -> [Dd; MOST] {
        let first = self.damping_per_s * length_s;
        let second = self.stiffness_per_s2 * length_s * length_s;
        let mut c = [Dd::ZERO; MOST];
        (c[0], c[1]) = (x, v * length_s);
        for k in 2..MOST {
            let mut sum = second * c[k - 2] * reciprocal(k - 1);
            if first != Dd::ZERO {
                sum += first * c[k - 1];
            }
            c[k] = -(sum * reciprocal(k));
        }
        c
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The state after `steps` steps that add up to `time_s`.
    fn after(object: &Object, time_s: f64, parts: u32) -> (Dd, Dd) {
        let (mut x, mut v) = (Dd::new(0.7), Dd::new(-0.2));
        for part in 1..=parts {
            let end = Dd::new(time_s * f64::from(part) / f64::from(parts));
            let mut t = Dd::new(time_s * f64::from(part - 1) / f64::from(parts));
            while t < end {
                let swing = object.swing(x, v, end - t);
                (x, v) = (swing.x.end(), swing.v.end());
                t += swing.length_s;
            }
        }
        (x, v)
    }

    #[test]
    fn the_closed_form_in_every_regime() {
        for zeta in [0.0, 0.3, 0.999_999, 1.0, 1.000_001, 5.0] {
            let object = Object {
                damping_per_s: Dd::new(2.0 * zeta * 3.0),
                stiffness_per_s2: Dd::new(9.0),
            };
            let (x, v) = after(&object, 2.0, 1);
            // v = x′ and E of the equation, in f64.
            let (a, d) = (3.0 * zeta, 9.0 * (1.0 - zeta * zeta));
            let w = d.abs().sqrt();
            let (c, s) = if d > 0.0 {
                ((w * 2.0).cos(), (w * 2.0).sin() / w)
            } else if d < 0.0 {
                ((w * 2.0).cosh(), (w * 2.0).sinh() / w)
            } else {
                (1.0, 2.0)
            };
            let e = (-a * 2.0_f64).exp();
            let expected = e * ((c + a * s) * 0.7 - 0.2 * s);
            assert!((x.to_f64() - expected).abs() < 1e-11, "{zeta}");
            let expected = e * (-9.0 * s * 0.7 - (c - a * s) * 0.2);
            assert!((v.to_f64() - expected).abs() < 1e-11, "{zeta}");
            // With other steps the same to 29 digits.
            let (x2, v2) = after(&object, 2.0, 7);
            assert!((x - x2).abs().to_f64() < 1e-28 && (v - v2).abs().to_f64() < 1e-28);
        }
    }

    #[test]
    fn without_damping_the_energy_stays_to_29_digits() {
        let object = Object {
            damping_per_s: Dd::ZERO,
            stiffness_per_s2: Dd::new(9.0),
        };
        let energy = |x: Dd, v: Dd| v * v + x * x * 9.0;
        let (x, v) = after(&object, 100.0, 1);
        let change = energy(x, v) - energy(Dd::new(0.7), Dd::new(-0.2));
        assert!(change.abs().to_f64() < 1e-28, "{change:?}");
    }
}
