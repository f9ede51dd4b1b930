//! The amplitude spectrum of a torque as points to draw; how it comes about
//! is in [`crepitus_plant`].
//!
//! Where there is a plant the torque at the hand holds the weight of a leg,
//! thousands of times what crepitus vibrates, which would leak from below into
//! all the rest. So there the spectrum is that of the second difference, and
//! what differencing does to each frequency is undone. To undo it where next to
//! nothing is left would make a mountain of what leaks down from above: below
//! [`SLOW_HZ`] the spectrum is that of the torque itself.

use crepitus_plant::spectrum;

use crate::plot::Point;

/// Spectrum at the end of a run.
#[derive(Clone, Debug)]
pub(crate) struct Spectrum {
    /// Frequency, Hz, and amplitude, in the unit of the samples.
    pub(crate) points: Vec<Point>,
    pub(crate) resolution_hz: f64,
    pub(crate) segments: u64,
    whole: spectrum::Spectrum,
    gain: Gain,
}

impl Spectrum {
    /// Root mean square of what vibrates between two frequencies, in the unit
    /// of the samples; NaN where the samples are too few, or too far apart, to
    /// tell.
    pub(crate) fn rms(&self, low_hz: f64, high_hz: f64) -> f64 {
        self.whole.rms(low_hz, high_hz, |hz| self.gain.at(hz))
    }
}

/// Filter applied to the samples before.
#[derive(Clone, Copy, Debug)]
enum Gain {
    /// No filter.
    One,
    /// Second differences over this step, s.
    Difference(f64),
}

impl Gain {
    fn at(self, hz: f64) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Difference(step_s) => (2.0 * (std::f64::consts::PI * step_s * hz).sin()).powi(2),
        }
    }
}

/// Frequency below which the spectrum is that of the torque itself, Hz.
const SLOW_HZ: f64 = 2.5;

/// See [`spectrum::Welch`].
#[derive(Debug)]
pub(crate) struct Welch {
    of: spectrum::Welch,
    gain: Gain,
    /// Spectrum of the torque itself, where `of` is that of differences.
    slow: Option<spectrum::Welch>,
    /// The last two samples.
    last: [Option<f64>; 2],
}

impl Welch {
    pub(crate) const SHORTEST: usize = spectrum::Welch::SHORTEST;

    pub(crate) fn new(step_s: f64, expected: u64) -> Option<Self> {
        Self::with(step_s, expected, Gain::One, None)
    }

    /// Estimator by second differences, see the module.
    pub(crate) fn differencing(step_s: f64, expected: u64) -> Option<Self> {
        let expected = expected.saturating_sub(2);
        let slow = spectrum::Welch::new(step_s, expected);
        Self::with(step_s, expected, Gain::Difference(step_s), slow)
    }

    fn with(step_s: f64, expected: u64, gain: Gain, slow: Option<spectrum::Welch>) -> Option<Self> {
        spectrum::Welch::new(step_s, expected).map(|of| Self {
            of,
            gain,
            slow,
            last: [None; 2],
        })
    }

    /// The next sample. One that is not finite repeats the one before.
    pub(crate) fn push(&mut self, value: f64) {
        let Gain::Difference(_) = self.gain else {
            self.of.push(value);
            return;
        };
        let value = if value.is_finite() {
            value
        } else {
            self.last[1].unwrap_or(0.0)
        };
        if let [Some(a), Some(b)] = self.last {
            self.of.push(value - 2.0 * b + a);
            if let Some(slow) = &mut self.slow {
                slow.push(value);
            }
        }
        self.last = [self.last[1], Some(value)];
    }

    /// Samples are missing before the next one.
    pub(crate) fn gap(&mut self) {
        self.last = [None; 2];
        self.of.gap();
        if let Some(slow) = &mut self.slow {
            slow.gap();
        }
    }

    pub(crate) fn finish(self) -> Option<Spectrum> {
        let whole = self.of.finish()?;
        let slow = self.slow.and_then(spectrum::Welch::finish);
        let mut points: Vec<Point> = whole
            .amplitudes
            .iter()
            .enumerate()
            .map(|(i, amplitude)| {
                let hz = i as f64 * whole.resolution_hz;
                let gain = self.gain.at(hz);
                // Second differences have no information about a mean.
                let amplitude = if gain > 0.0 { amplitude / gain } else { 0.0 };
                Point::new(hz, amplitude)
            })
            .collect();
        // Equal windows, so equal frequencies.
        for (point, amplitude) in points
            .iter_mut()
            .zip(slow.iter().flat_map(|s| &s.amplitudes))
        {
            if point.x < SLOW_HZ {
                point.y = *amplitude;
            }
        }
        Some(Spectrum {
            points,
            resolution_hz: whole.resolution_hz,
            segments: whole.segments,
            whole,
            gain: self.gain,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_slow_sine_is_as_high_as_it_is_below_what_vibrates() {
        // Grating of 0.4 N·m, whose own leak differences make a mountain of.
        let torque = |t: f64| 0.26 * (TAU * 1.25 * t).sin() + 0.4 * (31.8 * t).fract();
        let mut welch = Welch::differencing(1e-3, 16_384).expect("a step");
        for i in 0..16_384_u32 {
            welch.push(torque(f64::from(i) * 1e-3));
        }
        let spectrum = welch.finish().expect("enough samples");
        let slow = spectrum.points.iter().filter(|p| p.x < 5.0);
        let highest = slow.fold(0.0_f64, |high, p| high.max(p.y));
        assert!((0.85 * 0.26..1.1 * 0.26).contains(&highest), "{highest}");
    }

    #[test]
    fn the_weight_of_a_leg_does_not_leak_into_the_bands() {
        let torque = |t: f64| {
            let weight = -20.0 + 7.0 * (TAU * 0.31 * t).cos() - 4.0 * (TAU * 0.57 * t).sin();
            weight + 0.002 * (TAU * 100.0 * t).sin()
        };
        let bands = |mut welch: Welch| {
            for i in 0..80_000_u32 {
                welch.push(if i == 7 {
                    f64::NAN
                } else {
                    torque(f64::from(i) * 5e-5)
                });
            }
            let spectrum = welch.finish().expect("enough samples");
            [(10.0, 50.0), (50.0, 250.0)].map(|(low, high)| spectrum.rms(low, high))
        };
        let [low, high] = bands(Welch::differencing(5e-5, 80_000).expect("a step"));
        assert!(low < 1e-4, "{low}");
        assert!((high - 0.002 / 2_f64.sqrt()).abs() < 1e-5, "{high}");
        let [leaked, _] = bands(Welch::new(5e-5, 80_000).expect("a step"));
        assert!(leaked > 10.0 * low, "{leaked}");
    }
}
