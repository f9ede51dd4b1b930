//! Sampling rate conversion by convolution with a windowed sinc.
//!
//! ```text
//! y(t) = Σ xₙ·h(t − n/f) / Σ h(t − n/f)     h(t) = sinc(2·fc·t)·w(t),  w: Kaiser, ±64 zero crossings of the sinc
//! ```
//! The slower of both rates sets the band: it passes up to 0.45 of that rate, and what is beyond 0.5, which
//! would be an alias or an image, is 90 dB down. `h` is tabled finely and interpolated linearly
//! (−115 dB). Any ratio will do, since traces have any step.
//!
//! Before the first value and after the last the signal is held constant.
//!
//! Source: Smith, "Digital audio resampling", CCRMA; Kaiser's β and width as in Oppenheim and
//! Schafer, "Discrete-Time Signal Processing", 7.6.

use std::collections::VecDeque;
use std::f64::consts::PI;

/// Zero crossings of the kernel on either side.
const CROSSINGS: usize = 64;

/// Table entries per zero crossing.
const FINENESS: usize = 1024;

/// β of the Kaiser window for 90 dB: 0.1102·(90 − 8.7).
const BETA: f64 = 8.96;

/// Upper end of the passband, as a share of the slower rate.
pub(crate) const PASSED: f64 = 0.45;

/// Middle of the transition, as a share of the slower rate.
const CUTOFF: f64 = 0.475;

/// Streaming resampler; see the module.
#[derive(Debug)]
pub(crate) struct Resampler {
    /// Input values per output value.
    ratio: f64,
    /// Number of output values so far.
    made: u64,
    /// Last values of the input, and the number of those before them.
    window: VecDeque<f64>,
    gone: u64,
    /// Half the width of the kernel, in input values.
    reach: f64,
    /// Zero crossings per input value.
    crossings: f64,
    table: Vec<f64>,
}

impl Resampler {
    pub(crate) fn new(from_hz: f64, to_hz: f64) -> Self {
        let cutoff = CUTOFF * from_hz.min(to_hz) / from_hz;
        let crossings = 2.0 * cutoff;
        let table = (0..=CROSSINGS * FINENESS + 1)
            .map(|i| i as f64 / FINENESS as f64)
            .map(|x| sinc(x) * kaiser(x / CROSSINGS as f64))
            .collect();
        Self {
            ratio: from_hz / to_hz,
            made: 0,
            window: VecDeque::new(),
            gone: 0,
            reach: CROSSINGS as f64 / crossings,
            crossings,
            table,
        }
    }

    /// Takes the next value; passes the output values that are complete to `out`.
    pub(crate) fn push<E>(
        &mut self,
        value: f64,
        out: &mut impl FnMut(f64) -> Result<(), E>,
    ) -> Result<(), E> {
        if self.window.is_empty() && self.gone == 0 {
            // As if it had always been so.
            let before = whole(self.reach.ceil());
            self.window.extend((0..before).map(|_| value));
        }
        self.window.push_back(value);
        self.give(self.reach, out)
    }

    /// Passes the remaining output values, up to the time of the last input value, to `out`.
    pub(crate) fn finish<E>(mut self, out: &mut impl FnMut(f64) -> Result<(), E>) -> Result<(), E> {
        let Some(last) = self.window.back().copied() else {
            return Ok(());
        };
        let after = whole(self.reach.ceil()) + 1;
        self.window.extend((0..after).map(|_| last));
        self.give(after as f64, out)
    }

    /// Passes the output values that lie at least `before_end` input values before the end of the
    /// window to `out`.
    fn give<E>(
        &mut self,
        before_end: f64,
        out: &mut impl FnMut(f64) -> Result<(), E>,
    ) -> Result<(), E> {
        let padding = self.reach.ceil();
        loop {
            // In the window, whose first value may be long after the first of all.
            let at = self.made as f64 * self.ratio + padding - self.gone as f64;
            if at + before_end > (self.window.len() - 1) as f64 + 1e-9 {
                return Ok(());
            }
            let first = whole((at - self.reach).ceil());
            let last = whole((at + self.reach).floor());
            let values = self.window.range(first..=last.min(self.window.len() - 1));
            // Divided by the weights: a constant stays one at every phase, where the bare kernel
            // would turn it into a faint tone at the slower rate.
            let (mut sum, mut weights) = (0.0, 0.0);
            for (n, value) in (first..).zip(values) {
                let weight = self.kernel((at - n as f64).abs());
                sum += value * weight;
                weights += weight;
            }
            out(sum / weights)?;
            self.made += 1;
            let due = (self.made as f64 * self.ratio + padding - self.gone as f64) - self.reach;
            for _ in 1..whole(due.floor()) {
                if self.window.pop_front().is_some() {
                    self.gone += 1;
                }
            }
        }
    }

    /// Returns the kernel at a distance in input values.
    fn kernel(&self, distance: f64) -> f64 {
        let place = distance * self.crossings * FINENESS as f64;
        let index = whole(place);
        match self.table.get(index..index + 2) {
            Some([a, b]) => a + (b - a) * (place - index as f64),
            _ => 0.0,
        }
    }
}

/// Converts a number to a count, rounded down; negative numbers give 0.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturating, and far less than 2^53"
)]
fn whole(x: f64) -> usize {
    x as usize
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 {
        1.0
    } else {
        (PI * x).sin() / (PI * x)
    }
}

/// Returns the Kaiser window at a distance from its middle; 1 is its end.
fn kaiser(x: f64) -> f64 {
    if x > 1.0 {
        return 0.0;
    }
    bessel_i0(BETA * (1.0 - x * x).max(0.0).sqrt()) / bessel_i0(BETA)
}

/// Returns the modified Bessel function I₀, by its series, which has positive terms only.
fn bessel_i0(x: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..60 {
        term *= (0.5 * x / f64::from(k)).powi(2);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;
    use std::f64::consts::TAU;

    fn resampled(from_hz: f64, to_hz: f64, count: u32, value: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut out = Vec::new();
        let mut take = |y| {
            out.push(y);
            Ok::<(), Infallible>(())
        };
        let mut resampler = Resampler::new(from_hz, to_hz);
        for i in 0..count {
            let Ok(()) = resampler.push(value(f64::from(i) / from_hz), &mut take);
        }
        let Ok(()) = resampler.finish(&mut take);
        out
    }

    /// Returns the largest difference from a signal, 0.1 s away from both ends.
    fn off(found: &[f64], to_hz: f64, value: impl Fn(f64) -> f64) -> f64 {
        let margin = whole(0.1 * to_hz);
        (margin..found.len() - margin)
            .map(|i| (found[i] - value(i as f64 / to_hz)).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn sines_within_the_band_pass_at_any_ratio() {
        for from_hz in [
            20_000.0, 1_000.0, 44_100.0, 96_000.0, 14_285.714, 1e5, 48_000.0,
        ] {
            let slower = f64::min(from_hz, 48_000.0);
            for share in [0.01, 0.2, 0.4] {
                let sine = |t: f64| (TAU * share * slower * t + 0.3).sin();
                let count = u32::try_from(whole(0.6 * from_hz)).unwrap();
                let found = resampled(from_hz, 48_000.0, count, sine);
                let off = off(&found, 48_000.0, sine);
                assert!(off < 1e-4, "{from_hz} Hz, {share}: {off}");
                let expected = f64::from(count - 1) * 48_000.0 / from_hz + 1.0;
                assert!(
                    (found.len() as f64 - expected).abs() <= 1.0,
                    "{}",
                    found.len()
                );
            }
        }
    }

    #[test]
    fn what_would_be_an_alias_is_gone() {
        // 30 kHz at 100 kHz would be 18 kHz at 48 kHz.
        let found = resampled(1e5, 48_000.0, 60_000, |t| (TAU * 30_000.0 * t).sin());
        assert!(off(&found, 48_000.0, |_| 0.0) < 1e-4);
    }

    #[test]
    fn a_constant_stays_one_to_the_ends() {
        for from_hz in [20_000.0, 3_333.3] {
            for y in resampled(from_hz, 48_000.0, 5_000, |_| 0.7) {
                assert!((y - 0.7).abs() < 1e-14, "{y}");
            }
        }
        assert!(resampled(20_000.0, 48_000.0, 0, |_| 0.0).is_empty());
        assert_eq!(resampled(20_000.0, 48_000.0, 1, |_| 0.5).len(), 1);
    }
}
