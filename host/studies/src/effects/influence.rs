//! Statistics of a torque over a run, and of its difference from another.

use crepitus_model::Real;
use crepitus_plant::spectrum::Welch;
use serde::Serialize;

/// Frequency bands in use for the vibration of joints, Hz.
pub const BANDS_HZ: [(f64, f64); 3] = [(10.0, 50.0), (50.0, 250.0), (250.0, 450.0)];

/// Statistics of a torque over a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Torque {
    /// Root mean square, N·m.
    pub rms_nm: f64,
    /// Largest magnitude, N·m.
    pub peak_nm: f64,
    /// Root mean square within each of [`BANDS_HZ`], N·m; NaN if the run is too
    /// short or the tick too long.
    pub bands_nm: [f64; 3],
}

impl Torque {
    /// Root mean square of the vibration, 10 to 450 Hz, N·m; NaN where the bands are.
    pub fn vibration_nm(&self) -> f64 {
        self.bands_nm.iter().map(|nm| nm * nm).sum::<f64>().sqrt()
    }
}

/// Difference of two torques, tick by tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Root mean square, N·m.
    pub rms_nm: f64,
    /// Largest magnitude, N·m.
    pub peak_nm: f64,
    /// Relative difference of the numbers of events; infinite if the scene has
    /// none.
    pub events_relative: f64,
}

/// Running root mean square and largest magnitude.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Size {
    pub(super) count: u64,
    pub(super) squares: f64,
    pub(super) peak: f64,
}

impl Size {
    pub(super) fn push(&mut self, x: f64) {
        self.count += 1;
        self.squares += x * x;
        self.peak = self.peak.max(x.abs());
    }

    pub(super) fn rms(&self) -> f64 {
        (self.squares / f64::from_whole(self.count.max(1))).sqrt()
    }
}

/// Running statistics of a torque.
///
/// The weight of a leg is thousands of times the vibration of crepitus, and
/// would leak from below into the bands. So the spectrum is that of the second
/// difference, which is small for a slow torque, and the gain of differencing
/// is divided out bin by bin.
#[derive(Debug)]
pub(super) struct TorqueStatistics {
    size: Size,
    tick_s: f64,
    /// The last two samples.
    last: [Option<f64>; 2],
    welch: Option<Welch>,
}

impl TorqueStatistics {
    /// Statistics for this number of ticks of this length.
    pub(super) fn new(tick_s: f64, ticks: u64) -> Self {
        Self {
            size: Size::default(),
            tick_s,
            last: [None; 2],
            welch: Welch::new(tick_s, ticks.max(1)),
        }
    }

    pub(super) fn push(&mut self, torque_nm: f64) {
        self.size.push(torque_nm);
        if let (Some(welch), [Some(a), Some(b)]) = (&mut self.welch, self.last) {
            welch.push(torque_nm - 2.0 * b + a);
        }
        self.last = [self.last[1], Some(torque_nm)];
    }

    pub(super) fn finish(self) -> Torque {
        let spectrum = self.welch.and_then(Welch::finish);
        let turn = std::f64::consts::PI * self.tick_s;
        let differencing = |hz: f64| (2.0 * (turn * hz).sin()).powi(2);
        Torque {
            rms_nm: self.size.rms(),
            peak_nm: self.size.peak,
            bands_nm: BANDS_HZ.map(|(low, high)| {
                spectrum
                    .as_ref()
                    .map_or(f64::NAN, |spectrum| spectrum.rms(low, high, differencing))
            }),
        }
    }
}

/// Difference of numbers of events over that of the scene.
pub(super) fn relative(events: u64, scene: u64) -> f64 {
    if events == scene {
        0.0
    } else {
        f64::from_whole(events.abs_diff(scene)) / f64::from_whole(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(tick_s: f64, ticks: u32, torque: impl Fn(f64) -> f64) -> Torque {
        let mut statistics = TorqueStatistics::new(tick_s, u64::from(ticks));
        for n in 0..ticks {
            statistics.push(torque(f64::from(n) * tick_s));
        }
        statistics.finish()
    }

    #[test]
    fn a_sine_is_in_its_band_alone() {
        for (band, frequency_hz) in [30.0, 100.0, 350.0].into_iter().enumerate() {
            let sine = |t: f64| 2.0 + 0.3 * (std::f64::consts::TAU * frequency_hz * t).sin();
            let torque = measured(5e-5, 100_000, sine);
            let rms = 0.3 / 2_f64.sqrt();
            for (i, found) in torque.bands_nm.into_iter().enumerate() {
                let expected = if i == band { rms } else { 0.0 };
                assert!((found - expected).abs() < 5e-3 * rms, "{torque:?}");
            }
            assert!((torque.rms_nm - (4.0 + rms * rms).sqrt()).abs() < 1e-3);
            assert!((torque.peak_nm - 2.3).abs() < 1e-4);
        }
    }

    #[test]
    fn steps_spread_over_the_bands_as_their_harmonics_do() {
        // A square wave of 20 Hz: sines of 4/(π·n) at n·20 Hz, n odd.
        let square = |t: f64| if (t * 20.0).fract() < 0.5 { 1.0 } else { -1.0 };
        let torque = measured(5e-5, 200_000, square);
        for ((low, high), found) in BANDS_HZ.into_iter().zip(torque.bands_nm) {
            let power: f64 = (0..20)
                .map(|i| f64::from(2 * i + 1))
                .filter(|n| (low..high).contains(&(20.0 * n)))
                .map(|n| 8.0 / (std::f64::consts::PI * n).powi(2))
                .sum();
            assert!((found / power.sqrt() - 1.0).abs() < 0.02, "{low} {found}");
        }
        assert!((torque.rms_nm - 1.0).abs() < 1e-12 && torque.peak_nm == 1.0);
    }

    #[test]
    fn a_great_weight_does_not_leak_into_the_bands() {
        let tau = std::f64::consts::TAU;
        let weight = |t: f64| 14.0 * (tau * 0.7 * t).sin() + 3.0 * t;
        let torque = measured(5e-5, 80_000, weight);
        assert!(torque.bands_nm.iter().all(|nm| *nm < 5e-5), "{torque:?}");
        let grating = measured(5e-5, 80_000, |t| weight(t) + 1e-3 * (tau * 30.0 * t).sin());
        let rms = 1e-3 / 2_f64.sqrt();
        assert!(
            (grating.bands_nm[0] / rms - 1.0).abs() < 0.01,
            "{grating:?}"
        );
    }

    #[test]
    fn a_run_too_short_or_too_coarse_has_no_bands() {
        assert!(measured(5e-5, 1000, f64::sin).bands_nm[0].is_nan());
        let coarse = measured(2e-3, 5000, f64::sin).bands_nm;
        assert!(coarse[0].is_finite() && coarse[1].is_finite() && coarse[2].is_nan());
        assert!(measured(5e-5, 1000, f64::sin).rms_nm > 0.0);
    }

    #[test]
    fn events_are_relative_to_those_of_the_scene() {
        assert_eq!(relative(90, 100), 0.1);
        assert_eq!(relative(0, 0), 0.0);
        assert_eq!(relative(3, 0), f64::INFINITY);
    }
}
