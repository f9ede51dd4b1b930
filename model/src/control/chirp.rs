//! A logarithmic chirp of voltage, for the identification of an actuator.
//!
//! ```text
//! V(t) = A·w(t)·sin(2π∫f dt)      f(t) = f₁·(f₂/f₁)^(t/T)      w: smooth fades at both ends
//! ```
//!
//! Equal time for every octave: the resonance, low in the band, gets as much of it
//! as two decades of resistance and inductance. The fades begin and end at
//! rest, so that what the coil answers dies out within the recording.
//!
//! The drive and the host run this code. Its voltages have the same bits
//! everywhere, so the host knows the voltage of every tick without a report of it.

use crate::joint::SettingsError;
use crate::real::{Real, single};

/// Time of a tick, s.
pub const TICK_S: f32 = 5e-5;

/// Shortest and longest sweep, ticks: 0.5 s, 60 s.
pub const SHORTEST_TICKS: u32 = 10_000;
/// See [`SHORTEST_TICKS`].
pub const LONGEST_TICKS: u32 = 1_200_000;

/// Range of the frequencies, Hz.
pub const LOWEST_HZ: f32 = 1.0;
/// See [`LOWEST_HZ`]. A tick is a twentieth of its period.
pub const HIGHEST_HZ: f32 = 1000.0;

/// Greatest amplitude, V: that of the greatest supply.
pub const GREATEST_V: f32 = 12.0;

/// Share of the sweep over which it fades, at either end.
const FADE_SHARE: f32 = 1.0 / 32.0;

/// Settings of a chirp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChirpSettings {
    /// A, V: above 0, up to [`GREATEST_V`].
    pub amplitude_v: f32,
    /// f₁, Hz: from [`LOWEST_HZ`] on.
    pub from_hz: f32,
    /// f₂, Hz: above f₁, up to [`HIGHEST_HZ`].
    pub to_hz: f32,
    /// T, ticks: [`SHORTEST_TICKS`] to [`LONGEST_TICKS`].
    pub duration_ticks: u32,
}

impl Default for ChirpSettings {
    /// 0.4 V from 8 to 500 Hz in 10 s: 0.7 mm of 1.6 for the default actuator, with
    /// room for one that is softer by half.
    fn default() -> Self {
        Self {
            amplitude_v: 0.4,
            from_hz: 8.0,
            to_hz: 500.0,
            duration_ticks: 200_000,
        }
    }
}

impl ChirpSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`SettingsError::Contradiction`] with the first rule that is broken.
    pub fn check(&self) -> Result<(), SettingsError> {
        let rules = [
            (
                self.amplitude_v > 0.0 && self.amplitude_v <= GREATEST_V,
                "chirp: expected an amplitude above 0 V, up to 12 V",
            ),
            (
                self.from_hz >= LOWEST_HZ && self.to_hz <= HIGHEST_HZ,
                "chirp: expected frequencies from 1 Hz to 1000 Hz",
            ),
            (
                self.from_hz < self.to_hz,
                "chirp: expected a first frequency below the last",
            ),
            (
                (SHORTEST_TICKS..=LONGEST_TICKS).contains(&self.duration_ticks),
                "chirp: expected a duration from 0.5 s to 60 s",
            ),
        ];
        match rules.into_iter().find(|(holds, _)| !holds) {
            Some((_, reason)) => Err(SettingsError::Contradiction { reason }),
            None => Ok(()),
        }
    }
}

/// The generator: one call a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chirp {
    amplitude_v: f32,
    /// Phase as part of a period, 0 to 1.
    turns: f32,
    frequency_hz: f32,
    /// Growth of the frequency in a tick, relative.
    growth: f32,
    played_ticks: u32,
    duration_ticks: u32,
    per_fade_tick: f32,
}

impl Chirp {
    /// A chirp at its beginning.
    ///
    /// # Errors
    /// As [`ChirpSettings::check`].
    pub fn new(settings: &ChirpSettings) -> Result<Self, SettingsError> {
        settings.check()?;
        let ratio = f64::from(settings.to_hz) / f64::from(settings.from_hz);
        let ticks = f64::from(settings.duration_ticks);
        Ok(Self {
            amplitude_v: settings.amplitude_v,
            turns: 0.0,
            frequency_hz: settings.from_hz,
            growth: f32::from_f64(libm::expm1(libm::log(ratio) / ticks)),
            played_ticks: 0,
            duration_ticks: settings.duration_ticks,
            per_fade_tick: f32::from_f64(1.0 / (f64::from(FADE_SHARE) * ticks)),
        })
    }

    /// The voltage from now to the next tick, V; 0 once it is over.
    #[inline]
    pub fn tick(&mut self) -> f32 {
        if self.is_over() {
            return 0.0;
        }
        let (sine, _) = single::sin_cos_in_range(core::f32::consts::TAU * self.turns);
        let volts = self.amplitude_v * self.window() * sine;
        self.turns += self.frequency_hz * TICK_S;
        if self.turns >= 1.0 {
            self.turns -= 1.0;
        }
        self.frequency_hz += self.frequency_hz * self.growth;
        self.played_ticks += 1;
        volts
    }

    /// w: 0 at the first and the last tick, 1 between the fades.
    #[inline]
    fn window(&self) -> f32 {
        let left_ticks = self.duration_ticks - 1 - self.played_ticks;
        let nearest_end = self.played_ticks.min(left_ticks);
        let share = f32::from_whole(u64::from(nearest_end)) * self.per_fade_tick;
        let share = share.at_most(1.0);
        share * share * (3.0 - 2.0 * share)
    }

    /// Returns whether all of it has been played.
    pub fn is_over(&self) -> bool {
        self.played_ticks >= self.duration_ticks
    }

    /// The frequency that is played now, Hz.
    pub fn frequency_hz(&self) -> f32 {
        self.frequency_hz
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn played(settings: &ChirpSettings) -> Vec<f32> {
        let mut chirp = Chirp::new(settings).unwrap();
        (0..settings.duration_ticks).map(|_| chirp.tick()).collect()
    }

    #[test]
    fn it_follows_the_closed_form() {
        let settings = ChirpSettings::default();
        let (f1, f2) = (f64::from(settings.from_hz), f64::from(settings.to_hz));
        let total_s = f64::from(settings.duration_ticks) * f64::from(TICK_S);
        let rate = libm::log(f2 / f1) / total_s;
        let mut chirp = Chirp::new(&settings).unwrap();
        for n in 0..settings.duration_ticks {
            let t = f64::from(n) * 5e-5;
            let hz = f1 * libm::exp(rate * t);
            assert!((f64::from(chirp.frequency_hz()) / hz - 1.0).abs() < 1e-3);
            let volts = f64::from(chirp.tick());
            // A frequency that is off by 1e-4 is half a period off at the end: the phase
            // is compared in the first quarter.
            if t > 0.4 && t < 0.25 * total_s {
                let turns = f1 * (libm::exp(rate * t) - 1.0) / rate;
                let expected = 0.4 * libm::sin(core::f64::consts::TAU * turns);
                assert!((volts - expected).abs() < 0.05, "{t}: {volts} {expected}");
            }
        }
        assert!(chirp.is_over());
        assert_eq!(chirp.tick(), 0.0);
    }

    #[test]
    fn it_begins_and_ends_at_rest_and_keeps_its_amplitude() {
        let volts = played(&ChirpSettings::default());
        let greatest = |part: &[f32]| part.iter().fold(0.0_f32, |most, v| most.max(v.abs()));
        assert_eq!(volts[0], 0.0);
        assert_eq!(volts[volts.len() - 1], 0.0);
        assert!(greatest(&volts[..200]) < 2e-3 && greatest(&volts[199_800..]) < 2e-3);
        for tenth in volts[10_000..190_000].chunks(18_000) {
            assert!((greatest(tenth) - 0.4).abs() < 1e-3);
        }
        // No tick steps further than its frequency and the fade let it.
        let steepest = 0.4 * core::f32::consts::TAU * 505.0 * TICK_S;
        assert!(volts.windows(2).all(|w| (w[1] - w[0]).abs() < steepest));
    }

    #[test]
    fn it_has_the_same_bits_everywhere() {
        // FNV-1a of all bits: a changed rounding on any machine or target shows.
        let hash = played(&ChirpSettings::default())
            .iter()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, volts| {
                (hash ^ u64::from(volts.to_bits())).wrapping_mul(0x0000_0100_0000_01b3)
            });
        assert_eq!(hash, 0xe99d_d786_0049_eed1, "{hash:#018x}");
    }

    #[test]
    fn what_is_out_of_range_is_refused() {
        let good = ChirpSettings::default();
        let ticks = |duration_ticks| ChirpSettings {
            duration_ticks,
            ..good
        };
        let band = |from_hz, to_hz| ChirpSettings {
            from_hz,
            to_hz,
            ..good
        };
        let volts = |amplitude_v| ChirpSettings {
            amplitude_v,
            ..good
        };
        for bad in [
            volts(0.0),
            volts(-1.0),
            volts(f32::NAN),
            volts(12.5),
            band(0.9, 500.0),
            band(8.0, 1001.0),
            band(8.0, 8.0),
            band(f32::NAN, 500.0),
            band(8.0, f32::NAN),
            ticks(SHORTEST_TICKS - 1),
            ticks(LONGEST_TICKS + 1),
            ticks(0),
        ] {
            assert!(Chirp::new(&bad).is_err(), "{bad:?}");
        }
        for fine in [
            good,
            volts(12.0),
            band(1.0, 1000.0),
            ticks(SHORTEST_TICKS),
            ticks(LONGEST_TICKS),
        ] {
            let volts = played(&fine);
            assert!(
                volts
                    .iter()
                    .all(|v| v.abs() <= fine.amplitude_v * 1.000_001)
            );
        }
    }
}
