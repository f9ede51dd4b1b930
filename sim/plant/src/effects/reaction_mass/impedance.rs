//! The impedance of the coil on a carrier that stands still.
//!
//! ```text
//! Z(s) = R + s·L + b·s/(s² + γ·s + ω₀²)        b = Bl²/m,  γ = c/m,  ω₀² = k/m
//! ```
//!
//! and the current lags by a time τ, which is that of the measurement.

use crate::spectrum::Complex;

/// Number of parameters, in this order: R (Ω), L (H), b (Ω/s), ω₀ (rad/s), γ (1/s), τ (s).
pub const NUMBERS: usize = 6;

/// Parameters of the impedance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impedance {
    /// R, Ω.
    pub resistance: f64,
    /// L, H.
    pub inductance: f64,
    /// b = Bl²/m, Ω/s.
    pub coupling: f64,
    /// ω₀, rad/s.
    pub resonance: f64,
    /// γ = c/m, 1/s; mechanical damping alone.
    pub damping: f64,
    /// τ, s.
    pub delay: f64,
}

impl From<[f64; NUMBERS]> for Impedance {
    fn from(numbers: [f64; NUMBERS]) -> Self {
        let [resistance, inductance, coupling, resonance, damping, delay] = numbers;
        Self {
            resistance,
            inductance,
            coupling,
            resonance,
            damping,
            delay,
        }
    }
}

impl From<Impedance> for [f64; NUMBERS] {
    fn from(z: Impedance) -> Self {
        [
            z.resistance,
            z.inductance,
            z.coupling,
            z.resonance,
            z.damping,
            z.delay,
        ]
    }
}

impl Impedance {
    /// Returns s/(s² + γ·s + ω₀²).
    #[inline]
    pub fn swing(&self, s: Complex<f64>) -> Complex<f64> {
        s / (s * s + s * self.damping + self.resonance * self.resonance)
    }

    /// Returns Z at ω, Ω, without the delay.
    #[inline]
    pub fn at(&self, omega: f64) -> Complex<f64> {
        let s = Complex::i() * omega;
        s * self.inductance + self.swing(s) * self.coupling + self.resistance
    }

    /// Returns the admittance at ω, A/V, and its derivatives with respect to the parameters.
    #[inline]
    pub fn admittance(&self, omega: f64) -> (Complex<f64>, [Complex<f64>; NUMBERS]) {
        let s = Complex::i() * omega;
        let z = self.at(omega);
        let lag = (-s * self.delay).exp();
        let admittance = lag / z;
        let swing = self.swing(s);
        let square = swing * swing * self.coupling;
        let by_z = -admittance / z;
        let derivatives = [
            by_z,
            by_z * s,
            by_z * swing,
            // d/dω₀ of b·s/D is −2ω₀·b·s/D², and (s/D)² has one s too many.
            by_z * (-square / s * (2.0 * self.resonance)),
            by_z * -square,
            -s * admittance,
        ];
        (admittance, derivatives)
    }

    /// Returns the excursion per volt at ω, times m/Bl: 1/(D·Z).
    #[inline]
    pub fn reach(&self, omega: f64) -> f64 {
        let s = Complex::i() * omega;
        (self.swing(s) / s / self.at(omega)).norm()
    }

    /// Returns ζ with the coil connected: its current brakes the mass, Bl²/R beside c.
    pub fn damping_ratio(&self) -> f64 {
        0.5 * (self.damping + self.coupling / self.resistance) / self.resonance
    }

    /// Returns the motional resistance at the resonance, as a share of the total one.
    pub fn motional_share(&self) -> f64 {
        let added = self.coupling / self.damping;
        added / (self.resistance + added)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: Impedance = Impedance {
        resistance: 1.8,
        inductance: 2e-4,
        coupling: 20.0,
        resonance: 220.0,
        damping: 46.0,
        delay: 3e-5,
    };

    #[test]
    fn closed_forms_at_rest_at_resonance_and_far_above() {
        assert!((SOME.at(0.01).re - 1.8).abs() < 1e-6);
        let there = SOME.at(220.0);
        assert!((there.re - (1.8 + 20.0 / 46.0)).abs() < 1e-12);
        assert!((there.im - 220.0 * 2e-4).abs() < 1e-12);
        assert!((SOME.at(1e6).im / 200.0 - 1.0).abs() < 1e-3);
        // A voltage that hardly changes moves the mass to Bl/(R·k).
        assert!((SOME.reach(0.01) - 1.0 / (1.8 * 220.0 * 220.0)).abs() < 1e-9);
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let numbers = <[f64; NUMBERS]>::from(SOME);
        for omega in [60.0, 200.0, 220.0, 240.0, 3000.0] {
            let (_, derivatives) = SOME.admittance(omega);
            for (place, derivative) in derivatives.into_iter().enumerate() {
                let step = 1e-5 * numbers[place];
                let moved = |by: f64| {
                    let mut moved = numbers;
                    moved[place] += by;
                    Impedance::from(moved).admittance(omega).0
                };
                let difference = (moved(step) - moved(-step)) / (2.0 * step);
                let error = (difference - derivative).norm();
                assert!(
                    error < 1e-6 * derivative.norm(),
                    "{place} at {omega}: {error}"
                );
            }
        }
    }
}
