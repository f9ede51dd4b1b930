//! Two signals in a band of frequencies: their size, and how alike they are.
//!
//! Hann windows that overlap by half, as in the spectrum; the cross-correlation in the
//! band is the inverse transform of the mean cross-power there,
//!
//! ```text
//! ρ(τ) = Σ Re(X*·Y·e^(iωτ)) / √(Σ|X|²·Σ|Y|²)
//! ```

use crate::spectrum::forward_transform;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// Longest window, samples.
const LONGEST: usize = 8_192;

/// Two signals by their frequencies.
#[derive(Clone, Debug)]
pub struct Cross {
    step_s: f64,
    length: usize,
    /// Mean of |X|², |Y|² and X*·Y of each bin, scaled so that the sum over a band is the
    /// mean square there.
    bins: Vec<(f64, f64, Complex<f64>)>,
}

/// Similarity of two signals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likeness {
    /// Largest correlation, 1 for the same shape.
    pub correlation: f64,
    /// Lag of the second signal at that correlation, s.
    pub lag_s: f64,
}

impl Cross {
    /// Spectra of two signals of one length, a value every `step_s`; `None` if they are shorter
    /// than a window of 256.
    pub fn new(x: &[f64], y: &[f64], step_s: f64) -> Option<Self> {
        let count = x.len().min(y.len());
        let mut length = LONGEST;
        while length > count {
            length /= 2;
        }
        if length < 256 {
            return None;
        }
        let fft = forward_transform(length);
        let hann: Vec<f64> = (0..length)
            .map(|i| 0.5 - 0.5 * (TAU * i as f64 / length as f64).cos())
            .collect();
        let transform = |signal: &[f64]| {
            let mean = signal.iter().sum::<f64>() / length as f64;
            let mut input = fft.make_input_vec();
            for ((out, value), weight) in input.iter_mut().zip(signal).zip(&hann) {
                *out = (value - mean) * weight;
            }
            let mut output = fft.make_output_vec();
            fft.process(&mut input, &mut output).ok()?;
            Some(output)
        };
        let mut bins = vec![(0.0, 0.0, Complex::default()); length / 2 + 1];
        let mut segments = 0.0;
        for from in (0..=count - length).step_by(length / 2) {
            let range = from..from + length;
            let (Some(x), Some(y)) = (transform(&x[range.clone()]), transform(&y[range])) else {
                return None;
            };
            for (bin, (x, y)) in bins.iter_mut().zip(x.iter().zip(&y)) {
                bin.0 += x.norm_sqr();
                bin.1 += y.norm_sqr();
                bin.2 += x.conj() * y;
            }
            segments += 1.0;
        }
        let power: f64 = hann.iter().map(|w| w * w).sum();
        let scale = 2.0 / (segments * power * length as f64);
        for bin in &mut bins {
            *bin = (bin.0 * scale, bin.1 * scale, bin.2 * scale);
        }
        Some(Self {
            step_s,
            length,
            bins,
        })
    }

    fn hz(&self, bin: usize) -> f64 {
        bin as f64 / (self.length as f64 * self.step_s)
    }

    fn band(
        &self,
        low_hz: f64,
        high_hz: f64,
    ) -> impl Iterator<Item = (f64, &(f64, f64, Complex<f64>))> {
        let all = self
            .bins
            .iter()
            .enumerate()
            .map(|(i, bin)| (self.hz(i), bin));
        all.filter(move |(hz, _)| (low_hz..=high_hz).contains(hz))
    }

    /// Root mean squares of both in a band, each frequency weighted.
    pub fn rms(&self, low_hz: f64, high_hz: f64, weight: impl Fn(f64) -> f64) -> (f64, f64) {
        let (x, y) = self
            .band(low_hz, high_hz)
            .fold((0.0, 0.0), |(x, y), (hz, bin)| {
                let square = weight(hz) * weight(hz);
                (x + square * bin.0, y + square * bin.1)
            });
        (x.sqrt(), y.sqrt())
    }

    /// Similarity of both in a band, at the best lag of at most `most_lag_s` either way.
    pub fn likeness(&self, low_hz: f64, high_hz: f64, most_lag_s: f64) -> Likeness {
        let (x, y) = self.rms(low_hz, high_hz, |_| 1.0);
        let at = |lag_s: f64| -> f64 {
            let sum: f64 = self
                .band(low_hz, high_hz)
                .map(|(hz, bin)| {
                    let (sin, cos) = (TAU * hz * lag_s).sin_cos();
                    bin.2.re * cos - bin.2.im * sin
                })
                .sum();
            sum / (x * y)
        };
        let reach = (most_lag_s / self.step_s).round();
        let mut best = Likeness {
            correlation: f64::NEG_INFINITY,
            lag_s: 0.0,
        };
        let mut step = -reach;
        while step <= reach {
            let lag_s = step * self.step_s;
            let correlation = at(lag_s);
            if correlation > best.correlation {
                best = Likeness { correlation, lag_s };
            }
            step += 1.0;
        }
        best
    }

    /// Amplitude spectra of both: frequency, Hz, and the root mean square in its bin.
    pub fn lines(&self, high_hz: f64) -> Vec<(f64, f64, f64)> {
        self.band(0.0, high_hz)
            .map(|(hz, bin)| (hz, bin.0.sqrt(), bin.1.sqrt()))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise, smoothed.
    fn noise(count: usize) -> Vec<f64> {
        let (mut random, mut y) = (fastrand::Rng::with_seed(1), 0.0);
        (0..count)
            .map(|_| {
                y += 0.1 * (random.f64() - 0.5 - y);
                y
            })
            .collect()
    }

    #[test]
    fn what_is_delayed_is_alike_at_its_lag() {
        let signal = noise(40_000);
        let late: Vec<f64> = [0.0; 7]
            .into_iter()
            .chain(signal.iter().map(|x| 3.0 * x))
            .collect();
        let cross = Cross::new(&signal, &late, 5e-5).expect("long enough");
        let like = cross.likeness(15.0, 500.0, 2e-3);
        assert!(like.correlation > 0.999, "{like:?}");
        assert!((like.lag_s - 3.5e-4).abs() < 1e-9);
        let (x, y) = cross.rms(15.0, 500.0, |_| 1.0);
        assert!((y / x - 3.0).abs() < 0.01);
        let (halved, _) = cross.rms(15.0, 500.0, |_| 0.5);
        assert!((halved / x - 0.5).abs() < 1e-12);
    }

    #[test]
    fn the_whole_band_has_the_whole_variance_and_strangers_are_not_alike() {
        let signal = noise(80_000);
        let other: Vec<f64> = noise(160_000).split_off(80_000);
        let cross = Cross::new(&signal, &other, 1e-3).expect("long enough");
        let mean = signal.iter().sum::<f64>() / 80_000.0;
        let variance: f64 = signal.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 80_000.0;
        let (x, _) = cross.rms(0.0, 500.0, |_| 1.0);
        assert!((x / variance.sqrt() - 1.0).abs() < 0.02, "{x}");
        assert!(cross.likeness(1.0, 500.0, 0.02).correlation < 0.2);
        let total: f64 = cross.lines(500.0).iter().map(|line| line.1 * line.1).sum();
        assert!((total.sqrt() / x - 1.0).abs() < 1e-12);
        assert!(Cross::new(&signal[..200], &other, 1e-3).is_none());
    }

    #[test]
    fn a_sine_is_in_its_band() {
        let signal: Vec<f64> = (0..40_000)
            .map(|n| 2.0 * (TAU * 100.0 * f64::from(n) * 5e-5).sin())
            .collect();
        let cross = Cross::new(&signal, &signal, 5e-5).expect("long enough");
        let (inside, _) = cross.rms(80.0, 120.0, |_| 1.0);
        assert!((inside - 2.0_f64.sqrt()).abs() < 1e-3, "{inside}");
        assert!(cross.rms(150.0, 500.0, |_| 1.0).0 < 1e-3);
    }
}
