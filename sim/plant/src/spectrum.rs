//! # The amplitude spectrum of a torque
//!
//! By Welch's method while samples stream
//! by: Hann windows that overlap by half, their powers averaged.
//!
//! The scale is that of a sine: a steady sine of 1 mN·m shows as 1 mN·m at
//! its frequency (up to 15 % less between two bins). [`cross`] compares two signals.

// Counts that become numbers; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

pub mod cross;

use std::fmt;
use std::sync::Arc;

pub use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};

/// Estimate of the spectrum at the end of a run.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// Amplitude at each whole multiple of the resolution, from 0 on, in the
    /// unit of the samples.
    pub amplitudes: Vec<f64>,
    /// Step from one amplitude to the next, Hz.
    pub resolution_hz: f64,
    /// Windows that it is the mean of.
    pub segments: u64,
}

impl Spectrum {
    /// Root mean square of what vibrates from `low_hz` up to `high_hz`; NaN
    /// where the samples are too few, or too far apart, to tell. What the
    /// samples went through before multiplied a sine by `gain` of its
    /// frequency.
    pub fn rms(&self, low_hz: f64, high_hz: f64, gain: impl Fn(f64) -> f64) -> f64 {
        let bins = self.amplitudes.len().saturating_sub(1) as f64;
        if low_hz < 2.0 * self.resolution_hz || high_hz > bins * self.resolution_hz {
            return f64::NAN;
        }
        let squares: f64 = self
            .amplitudes
            .iter()
            .enumerate()
            .map(|(i, amplitude)| (i as f64 * self.resolution_hz, amplitude))
            .filter(|(hz, _)| (low_hz..high_hz).contains(hz))
            .map(|(hz, amplitude)| (amplitude / gain(hz)).powi(2) / 2.0)
            .sum();
        // The window spreads the power of a sine over so many bins.
        (squares / 1.5).sqrt()
    }
}

/// The plan of a transform of so many real values. A crate that transforms takes it from here: the planner
/// is generic, and each crate that calls it would compile all its kernels.
pub fn forward_transform(length: usize) -> Arc<dyn RealToComplex<f64>> {
    RealFftPlanner::new().plan_fft_forward(length)
}

/// See the module.
pub struct Welch {
    rate: f64,
    fft: Arc<dyn RealToComplex<f64>>,
    hann: Vec<f64>,
    segment: Vec<f64>,
    work: Vec<f64>,
    scratch: Vec<Complex<f64>>,
    transform: Vec<Complex<f64>>,
    power: Vec<f64>,
    segments: u64,
    last: f64,
}

impl fmt::Debug for Welch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Welch")
            .field("rate", &self.rate)
            .field("length", &self.hann.len())
            .field("segments", &self.segments)
            .finish_non_exhaustive()
    }
}

impl Welch {
    /// Fewer samples than this make no spectrum worth looking at.
    pub const SHORTEST: usize = 1024;
    const LONGEST: usize = 65_536;

    /// A resolution of about 1 Hz, coarser if so few samples are expected
    /// that not one segment would fill; 0 means unknown.
    pub fn new(step_s: f64, expected: u64) -> Option<Self> {
        let rate = 1.0 / step_s;
        if !(rate.is_finite() && rate > 0.0) {
            return None;
        }
        let mut length = Self::SHORTEST;
        while length < Self::LONGEST && (length as f64) * std::f64::consts::SQRT_2 < rate {
            length *= 2;
        }
        while length > Self::SHORTEST && expected != 0 && expected < length as u64 {
            length /= 2;
        }
        let fft = forward_transform(length);
        let turn = std::f64::consts::TAU / length as f64;
        Some(Self {
            rate,
            hann: (0..length)
                .map(|i| 0.5 - 0.5 * (turn * i as f64).cos())
                .collect(),
            segment: Vec::with_capacity(length),
            work: fft.make_input_vec(),
            scratch: fft.make_scratch_vec(),
            transform: fft.make_output_vec(),
            power: vec![0.0; length / 2 + 1],
            fft,
            segments: 0,
            last: 0.0,
        })
    }

    /// The next sample. One that is not finite repeats the one before.
    pub fn push(&mut self, value: f64) {
        if value.is_finite() {
            self.last = value;
        }
        self.segment.push(self.last);
        let length = self.hann.len();
        if self.segment.len() == length {
            self.add_segment();
            self.segment.drain(..length / 2);
        }
    }

    /// Samples are missing here: the segment restarts, as one across them
    /// would have a step that there was not.
    pub fn gap(&mut self) {
        self.segment.clear();
    }

    fn add_segment(&mut self) {
        // The mean is not vibration, and would leak into the lowest bins.
        let mean = self.segment.iter().sum::<f64>() / self.segment.len() as f64;
        for ((out, value), weight) in self.work.iter_mut().zip(&self.segment).zip(&self.hann) {
            *out = (value - mean) * weight;
        }
        let done =
            self.fft
                .process_with_scratch(&mut self.work, &mut self.transform, &mut self.scratch);
        // The lengths are those that the plan itself made: it cannot fail.
        if done.is_ok() {
            for (power, bin) in self.power.iter_mut().zip(&self.transform) {
                *power += bin.norm_sqr();
            }
            self.segments += 1;
        }
    }

    /// The spectrum, or `None` if not one segment filled.
    pub fn finish(self) -> Option<Spectrum> {
        if self.segments == 0 {
            return None;
        }
        let resolution_hz = self.rate / self.hann.len() as f64;
        let scale = 2.0 / self.hann.iter().sum::<f64>();
        let amplitudes = self
            .power
            .iter()
            .map(|power| (power / self.segments as f64).sqrt() * scale)
            .collect();
        Some(Spectrum {
            amplitudes,
            resolution_hz,
            segments: self.segments,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_shows_its_amplitude_at_its_frequency() {
        let rate = 20_000.0;
        let mut welch = Welch::new(1.0 / rate, 0).expect("valid step");
        let resolution = rate / welch.hann.len() as f64;
        assert!((0.7..1.5).contains(&resolution));
        let frequency = 93.0 * resolution;
        for i in 0..200_000_u32 {
            let angle = std::f64::consts::TAU * frequency * f64::from(i) / rate;
            welch.push(if i == 777 {
                f64::NAN
            } else {
                3.0 + 0.25 * angle.sin()
            });
        }
        let spectrum = welch.finish().expect("segments");
        assert!(spectrum.segments > 20);
        assert!((spectrum.amplitudes[93] - 0.25).abs() < 1e-4);
        assert!(spectrum.amplitudes.iter().all(|a| *a < 0.2501));
        assert!(spectrum.amplitudes[0] < 1e-3);
        let rms = spectrum.rms(50.0, 250.0, |_| 1.0);
        assert!((rms - 0.25 / 2_f64.sqrt()).abs() < 1e-4, "{rms}");
        assert!(spectrum.rms(250.0, 450.0, |_| 1.0) < 1e-3);
        assert!(spectrum.rms(450.0, 10_001.0, |_| 1.0).is_nan());
        assert!(spectrum.rms(1.0, 450.0, |_| 1.0).is_nan());
        let halved = spectrum.rms(50.0, 250.0, |_| 2.0);
        assert!((halved / rms - 0.5).abs() < 1e-12);
    }

    #[test]
    fn noise_is_in_a_band_by_its_width() {
        let mut welch = Welch::new(1e-3, 0).expect("valid step");
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..400_000 {
            welch.push(random.f64() - 0.5);
        }
        let spectrum = welch.finish().expect("segments");
        // White noise of variance 1/12, of whose 500 Hz the band has 200.
        let expected = (200.0 / 500.0 / 12.0_f64).sqrt();
        let rms = spectrum.rms(50.0, 250.0, |_| 1.0);
        assert!((rms / expected - 1.0).abs() < 0.02, "{rms} {expected}");
    }

    #[test]
    fn too_few_samples_make_no_spectrum() {
        let mut welch = Welch::new(1e-3, 500).expect("valid step");
        for _ in 0..500 {
            welch.push(1.0);
        }
        assert!(welch.finish().is_none());
        assert!(Welch::new(0.0, 5).is_none());
        assert!(Welch::new(f64::NAN, 5).is_none());
    }
}
