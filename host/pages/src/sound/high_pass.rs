//! Second-order Butterworth high-pass filter, by the bilinear transform.
//!
//! ```text
//! H(s) = s² / (s² + √2 s + 1)     −3 dB at the corner, 12 dB an octave below it
//! ```
//! Source: Bristow-Johnson, "Cookbook formulae for audio EQ biquad filter coefficients", HPF with
//! Q = 1/√2.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Corner of the high-pass, Hz.
pub const HIGH_PASS_HZ: f64 = 30.0;

/// High-pass filter in transposed direct form II.
#[derive(Debug)]
pub(crate) struct HighPass {
    b: [f64; 3],
    a: [f64; 2],
    state: Option<[f64; 2]>,
}

impl HighPass {
    pub(crate) fn new(rate_hz: f64) -> Self {
        let omega = TAU * HIGH_PASS_HZ / rate_hz;
        let alpha = omega.sin() / (2.0 * FRAC_1_SQRT_2);
        let a0 = 1.0 + alpha;
        let b = 0.5 * (1.0 + omega.cos()) / a0;
        Self {
            b: [b, -2.0 * b, b],
            a: [-2.0 * omega.cos() / a0, (1.0 - alpha) / a0],
            state: None,
        }
    }

    /// Filters the next value. The filter starts in the steady state of the first one.
    pub(crate) fn next(&mut self, x: f64) -> f64 {
        let [b0, b1, b2] = self.b;
        let [s1, s2] = self.state.unwrap_or([-b0 * x, b2 * x]);
        let y = b0 * x + s1;
        self.state = Some([b1 * x - self.a[0] * y + s2, b2 * x - self.a[1] * y]);
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_is_silence_from_the_first_sample_on() {
        let mut filter = HighPass::new(48_000.0);
        for _ in 0..10_000 {
            assert!(filter.next(0.37).abs() < 1e-12);
        }
    }

    #[test]
    fn the_gain_is_that_of_butterworth() {
        for (hz, gain) in [(7.5, 0.062_4), (30.0, FRAC_1_SQRT_2), (300.0, 0.999_95)] {
            let mut filter = HighPass::new(48_000.0);
            let mut peak = 0.0_f64;
            for i in 0..96_000 {
                let y = filter.next((TAU * hz * f64::from(i) / 48_000.0).sin());
                if i > 48_000 {
                    peak = peak.max(y.abs());
                }
            }
            assert!((peak - gain).abs() < 5e-4, "{hz} Hz: {peak}");
        }
    }
}
