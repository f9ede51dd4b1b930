//! The shaft's motion near one instant, as Taylor series.
//!
//! A polynomial piece is shifted to the instant exactly. A sine satisfies
//! φ″ = −w²·φ, so from its value and slope
//!
//! ```text
//! φ = A·sin(2π(f·t + p)):   φₖ₊₂ = −(w·h)²·φₖ/((k+1)(k+2)),   w = 2πf
//! ```
//! with a remainder below |A|·(w·h)ⁿ/n! after n terms. Only the coefficients
//! of the motion's pieces are taken from `crepitus_plant`.

use crate::circle::sin_cos_turns;
use crate::double_double::Dd;
use crate::series::{Series, number, reciprocal};
use crepitus_plant::piece::{Curve, Piece};

/// Terms of a sine's series; with w·h ≤ 1 the remainder of Ω̇ is below 10⁻³⁶.
const SINE_TERMS: usize = 34;

/// The shaft from an instant on, over a length h.
#[derive(Clone, Copy, Debug)]
pub struct Shaft {
    /// Change of the angle since the instant, rad.
    pub turned: Series,
    /// Velocity Ω, rad/s.
    pub omega: Series,
    /// Acceleration Ω̇, rad/s².
    pub omega_dot: Series,
}

/// Relative changes of a motion's numbers, for the study of rounding; none of
/// them changes anything where all are zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct Changes(pub [f64; 6]);

impl Changes {
    fn of(&self, k: usize, x: f64) -> Dd {
        Dd::new(x) + Dd::new(x * self.0[k])
    }
}

/// The longest series of a piece, s: infinite for a polynomial.
pub fn longest_s(piece: &Piece) -> f64 {
    match piece.curve {
        Curve::Polynomial(_) => f64::INFINITY,
        Curve::Sine { frequency_hz, .. } => 1.0 / (std::f64::consts::TAU * frequency_hz.abs()),
    }
}

/// The size of the terms that Ω is the sum of, rad/s: what its rounding in
/// f64 is relative to.
pub fn speed_size_rad_s(piece: &Piece, time_s: Dd) -> f64 {
    match piece.curve {
        Curve::Polynomial(c) => {
            let tau = (time_s.to_f64() - piece.start_s).abs();
            let terms = c.iter().enumerate().skip(1).rev();
            terms.fold(0.0, |sum, (k, c)| sum * tau + number(k) * c.abs())
        }
        Curve::Sine {
            amplitude_rad,
            frequency_hz,
            ..
        } => (std::f64::consts::TAU * amplitude_rad * frequency_hz).abs(),
    }
}

impl Shaft {
    /// The shaft from `time_s` on, for `length_s`.
    pub fn new(piece: &Piece, changes: &Changes, time_s: Dd, length_s: Dd) -> Self {
        let per_s = Dd::ONE / length_s;
        let (turned, errors) = match piece.curve {
            Curve::Polynomial(c) => {
                let tau = time_s - Dd::new(piece.start_s);
                let mut coefficients = [0, 1, 2, 3, 4, 5].map(|k| changes.of(k, c[k]));
                shift(&mut coefficients, tau);
                let mut power = Dd::ONE;
                for c in &mut coefficients {
                    *c = *c * power;
                    power = power * length_s;
                }
                coefficients[0] = Dd::ZERO;
                let len = 1 + coefficients
                    .iter()
                    .rposition(|&c| c != Dd::ZERO)
                    .unwrap_or(0);
                (Series::of(&coefficients[..len], 0.0), [0.0; 2])
            }
            Curve::Sine {
                amplitude_rad,
                frequency_hz,
                phase_turns,
                ..
            } => {
                let (a, f, p) = (
                    changes.of(0, amplitude_rad),
                    changes.of(1, frequency_hz),
                    changes.of(2, phase_turns),
                );
                let (sin, cos) = sin_cos_turns(f * time_s + p);
                let wh = (Dd::PI * f).scaled(2.0) * length_s;
                let mut coefficients = [Dd::ZERO; SINE_TERMS];
                coefficients[0] = a * sin;
                coefficients[1] = a * cos * wh;
                let minus_wh2 = -(wh * wh);
                for k in 2..SINE_TERMS {
                    coefficients[k] =
                        minus_wh2 * coefficients[k - 2] * reciprocal(k) * reciprocal(k - 1);
                }
                coefficients[0] = Dd::ZERO;
                // |A|·(w·h)ⁿ/n! and what its derivatives leave out.
                let (wh, h) = (wh.to_f64().abs(), length_s.to_f64());
                let left = |n: usize| {
                    (1..=n).fold(amplitude_rad.abs(), |r, k| r * wh * reciprocal(k).to_f64())
                };
                let n = SINE_TERMS;
                (
                    Series::of(&coefficients, left(n)),
                    [left(n - 1) * wh / h, left(n - 2) * wh * wh / (h * h)],
                )
            }
        };
        let omega = turned.derivative(per_s, errors[0]);
        let omega_dot = omega.derivative(per_s, errors[1]);
        Self {
            turned,
            omega,
            omega_dot,
        }
    }
}

/// The coefficients about a point `by` further on, by repeated synthetic
/// division.
fn shift(c: &mut [Dd; 6], by: Dd) {
    for from in 0..5 {
        for k in (from..5).rev() {
            let higher = c[k + 1];
            c[k] += higher * by;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_plant::Motion;

    #[test]
    fn series_follow_the_pieces() {
        let polynomial = Piece {
            start_s: 0.5,
            end_s: 2.0,
            jump: false,
            curve: Curve::Polynomial([0.1, -0.4, 0.3, 1.1, -0.6, 0.2]),
        };
        let sine = Motion::sine(0.7, 0.3, 40.0).piece(0.0);
        for piece in [polynomial, sine] {
            let (from_s, length_s) = (0.8, 0.5);
            let shaft = Shaft::new(
                &piece,
                &Changes::default(),
                Dd::new(from_s),
                Dd::new(length_s),
            );
            for sigma in [0.0, 0.3, 1.0] {
                let expected = piece.at(from_s + length_s * sigma);
                let near = |series: &Series, x: f64| {
                    (series.value(Dd::new(sigma)).to_f64() - x).abs() < 1e-14
                };
                let turned = expected.phi_rad - piece.at(from_s).phi_rad;
                assert!(near(&shaft.turned, turned));
                assert!(near(&shaft.omega, expected.omega_rad_s));
                assert!(near(&shaft.omega_dot, expected.omega_dot));
            }
        }
    }

    #[test]
    fn two_halves_of_a_sine_are_the_whole_to_30_digits() {
        let sine = Motion::sine(0.7, 0.3, 40.0).piece(0.0);
        let at = |from_s: f64, length_s: f64| {
            Shaft::new(
                &sine,
                &Changes::default(),
                Dd::new(from_s),
                Dd::new(length_s),
            )
        };
        let whole = at(1.0, 0.5).turned.end();
        let halves = at(1.0, 0.25).turned.end() + at(1.25, 0.25).turned.end();
        assert!((whole - halves).abs().to_f64() < 1e-30);
    }
}
