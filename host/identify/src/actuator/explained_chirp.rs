//! Fit of one chirp, and the checks that reject it.

use crate::actuator::bands::{Mean, bands};
use crate::actuator::derived::derived;
use crate::actuator::fit::{Explained, Fit, Residual};
use crate::actuator::refusal::Refusal;
use crate::actuator::spectrum::{Line, Spectrum};
use crate::actuator::{Band, Series};
use crepitus_plant::spectrum::Complex;
use std::f64::consts::TAU;

/// Least excitation of a band, as a share of the median of all: that of a linear
/// chirp over six octaves is 3 %.
const LEAST_EXCITATION: f64 = 0.01;

/// Least voltage, V rms.
const LEAST_V: f64 = 0.005;

/// Voltage of a coil at rest, as a share of the greatest one; and time at rest, s, that is checked
/// at the start, and at the end, where the mass has to settle.
const REST_SHARE: f64 = 0.02;
const REST_S: [f64; 2] = [0.01, 0.15];

/// Largest resistance of a coil, Ω.
const OPEN_OHM: f64 = 100.0;

/// Least motional impedance that counts as motion: in standard deviations, and as a share of the
/// impedance.
const SEEN: f64 = 8.0;
const LEAST_MOTIONAL_SHARE: f64 = 0.01;

/// Least distance of the resonance from the ends of the band, as a frequency ratio.
const FROM_START: f64 = 1.4;
const FROM_END: f64 = 2.5;

/// Largest residual, as a share of the motional current: in a narrow band, and over all; and the
/// floor of both, as a share of the current.
const UNEXPLAINED_THERE: f64 = 0.1;
const UNEXPLAINED: f64 = 0.05;
const LEAST_UNEXPLAINED: f64 = 0.003;

/// Least misfit of a narrow band that counts, standard deviations.
const MISFIT: f64 = 6.0;

/// Residual over noise from which the residual has a systematic part.
const OVER_NOISE: f64 = 1.15;

/// A second resonance counts from this height over its standard deviation and over
/// the first, and is the cause if it explains this share of the misfit. Stops and
/// friction reach a fifth.
const SECOND_DEVIATIONS: f64 = 10.0;
const SECOND_HEIGHT: f64 = 0.02;
const SECOND_SHARE: f64 = 0.35;

/// Tolerance of the mains frequency and its multiples, Hz.
const MAINS_HZ: f64 = 0.5;

/// Share of the misfit in two lines from which it is a hum.
const HUM_SHARE: f64 = 0.5;

/// A ring that is held softly hardly has a hump of its own, and yet moves the values:
/// below the first resonance, a second one counts from this height over its standard deviation
/// and this change of a value. Of the 300 chirps of hidden actuators in a vice none comes there.
const HELD_DEVIATIONS: f64 = 5.0;
const HELD_MOVED: f64 = 0.02;

/// A clipped current is at its limit for this share of the time that it is above 70 %
/// of it; a sine is within 0.4 % of its amplitude for 11 %.
const CLIPPED: f64 = 0.2;

/// Least level, in steps of the record, at which that can be detected: of a sine of fewer steps the
/// highest one alone is a fifth.
const FEWEST_STEPS: f64 = 45.0;

/// Difference of currents that is rounding of the computation, as a share of the level.
const ROUNDING: f64 = 1e-5;

/// A chirp that a single resonance explains.
#[derive(Clone, Debug)]
pub(crate) struct ExplainedChirp {
    pub(crate) fit: Fit,
    pub(crate) means: Vec<Mean>,
    /// Peak voltage, V.
    pub(crate) amplitude_v: f64,
}

impl ExplainedChirp {
    /// Fits a chirp and checks the fit. `mass_kg` only serves the text of a refusal.
    pub(crate) fn of(series: &Series, band: Band, mass_kg: Option<f64>) -> Result<Self, Refusal> {
        has_a_noise_band(series, band)?;
        let amplitude_v = at_rest_at_both_ends(series)?;
        let spectrum = Spectrum::of(series, band);
        let means: Vec<Mean> = bands(&spectrum.lines).map(Mean::of).collect();
        is_excited(&means)?;
        conducts(&spectrum.lines, series)?;
        let no_resonance = Refusal::NoResonance {
            from_hz: band.from_hz,
            to_hz: band.to_hz,
        };
        let no_resonance = || spoiled(series).unwrap_or_else(|| no_resonance.clone());
        let fit = Fit::of(&spectrum).ok_or_else(no_resonance)?;
        let examined = Self {
            fit,
            means,
            amplitude_v,
        };
        let coupling = derived(&examined.fit, |z| z.coupling);
        let is_seen = coupling.half_width * SEEN < 2.0 * coupling.value.abs()
            && examined.fit.impedance.motional_share().abs() > LEAST_MOTIONAL_SHARE;
        if !is_seen {
            return Err(no_resonance());
        }
        examined.is_explained(series, mass_kg)?;
        examined.is_inside(band)?;
        examined.is_possible()?;
        Ok(examined)
    }

    /// Returns the peak excursion, m, of a mass in kg.
    pub(crate) fn excursion_m(&self, mass_kg: f64) -> f64 {
        let z = &self.fit.impedance;
        let steps = (1..=400).map(|i| 0.005 * f64::from(i));
        let reach = steps
            .map(|step| z.reach(step * z.resonance))
            .fold(0.0, f64::max);
        (z.coupling / mass_kg).max(0.0).sqrt() * reach * self.amplitude_v
    }

    fn is_explained(&self, series: &Series, mass_kg: Option<f64>) -> Result<(), Refusal> {
        let z = &self.fit.impedance;
        let residual = &self.fit.residual;
        let most = |share: f64| f64::max(share * z.motional_share().abs(), LEAST_UNEXPLAINED);
        let is_systematic =
            residual.systematic > most(UNEXPLAINED_THERE) && residual.deviations > MISFIT;
        let is_noisy = residual.beyond_noise > most(UNEXPLAINED)
            && residual.over_noise.is_some_and(|ratio| ratio > OVER_NOISE);
        let is_double = residual.second.is_some_and(|second| {
            second.deviations > SECOND_DEVIATIONS && second.height > SECOND_HEIGHT
        });
        let is_held = residual
            .second
            .is_some_and(|second| self.shows_a_held_ring(&second));
        if !(is_systematic || is_noisy || is_double || is_held) {
            return Ok(());
        }
        Err(spoiled(series).unwrap_or_else(|| self.misfit(residual, mass_kg)))
    }

    fn shows_a_held_ring(&self, second: &Explained) -> bool {
        let z = &self.fit.impedance;
        // A first one that gives power is refused for that.
        (z.damping > 0.0 && TAU * second.hz < z.resonance)
            && second.deviations > HELD_DEVIATIONS
            && second.moved > HELD_MOVED
            && second.share > SECOND_SHARE
    }

    fn misfit(&self, residual: &Residual, mass_kg: Option<f64>) -> Refusal {
        let is_above = |hz: f64| TAU * hz > FROM_END * self.fit.impedance.resonance;
        if let Some(hum) = self.hum() {
            return hum;
        }
        let second = residual.second.filter(|second| {
            second.share > SECOND_SHARE && !(second.is_broad && is_above(second.hz))
        });
        if let Some(second) = second {
            return Refusal::SecondResonance {
                hz: second.hz,
                height: 100.0 * second.height,
                deviations: second.deviations,
            };
        }
        if is_above(residual.systematic_hz) && residual.deviations > MISFIT {
            return Refusal::NotAnInductance {
                hz: residual.systematic_hz,
                share: 100.0 * residual.systematic,
            };
        }
        Refusal::Nonlinear {
            share: 100.0 * residual.beyond_noise.max(residual.systematic),
            swing: mass_kg.map_or_else(String::new, |mass_kg| {
                let mm = 1e3 * self.excursion_m(mass_kg);
                format!(" (a linear one would swing by ±{mm:.2} mm)")
            }),
        }
    }

    /// Returns the hum that is most of the misfit; stops and friction spread over the band, and
    /// what is narrow elsewhere is a resonance of the ring.
    fn hum(&self) -> Option<Refusal> {
        let is_of_mains = |hz: f64| {
            let off = |mains: f64| (hz / mains - (hz / mains).round()).abs() * mains;
            off(50.0).min(off(60.0)) < MAINS_HZ
        };
        let hum = self.fit.residual.hum;
        let hum = hum.filter(|hum| hum.share > HUM_SHARE && is_of_mains(hum.hz))?;
        Some(Refusal::Hum {
            hz: hum.hz,
            share: 100.0 * hum.share,
        })
    }

    fn is_inside(&self, band: Band) -> Result<(), Refusal> {
        let hz = self.fit.impedance.resonance.abs() / TAU;
        if hz < FROM_START * band.from_hz || FROM_END * hz > band.to_hz {
            return Err(Refusal::AtEdge {
                resonance_hz: hz,
                from_hz: band.from_hz,
                to_hz: band.to_hz,
                below_hz: hz / FROM_START,
                above_hz: hz * FROM_END,
            });
        }
        Ok(())
    }

    fn is_possible(&self) -> Result<(), Refusal> {
        let z = &self.fit.impedance;
        // A coil may have next to no inductance: its interval has to reach zero at least.
        let inductance = derived(&self.fit, |z| z.inductance);
        let checked = [
            ("the resistance (Ω)", z.resistance),
            (
                "the inductance (mH)",
                1e3 * (inductance.value + 2.0 * inductance.half_width),
            ),
            ("Bl²/m (Ω/s)", z.coupling),
            ("the flexure's damping ratio", 0.5 * z.damping / z.resonance),
        ];
        match checked.into_iter().find(|(_, value)| *value <= 0.0) {
            Some((what, value)) => Err(Refusal::Negative { what, value }),
            None => Ok(()),
        }
    }
}

/// Rejects a recording without frequencies above the band: its noise would be unknown.
fn has_a_noise_band(series: &Series, band: Band) -> Result<(), Refusal> {
    let rows_per_s = 1.0 / series.step_s();
    let needed_per_s = Spectrum::least_rate(band, series.duration_s());
    if rows_per_s < needed_per_s {
        return Err(Refusal::FewRows {
            rows_per_s,
            to_hz: band.to_hz,
            needed_per_s: needed_per_s.ceil(),
        });
    }
    Ok(())
}

/// Rejects a recording that does not begin and end at rest; returns the peak voltage, V.
fn at_rest_at_both_ends(series: &Series) -> Result<f64, Refusal> {
    let mean = series.volts().iter().sum::<f64>() / series.volts().len() as f64;
    let rms = |part: &mut dyn Iterator<Item = &f64>, samples: usize| {
        (part.map(|v| (v - mean).powi(2)).sum::<f64>() / samples as f64).sqrt()
    };
    let volts = series.volts();
    let all_v = rms(&mut volts.iter(), volts.len());
    if all_v < LEAST_V {
        return Err(Refusal::NoVoltage { volts: all_v });
    }
    let greatest_v = volts
        .iter()
        .fold(0.0, |most, v| f64::max(most, (v - mean).abs()));
    let samples = REST_S.map(|rest_s| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small positive number"
        )]
        let samples = (rest_s / series.step_s()).ceil() as usize;
        samples.clamp(1, volts.len())
    });
    let begins = rms(&mut volts.iter().take(samples[0]), samples[0]);
    let ends = rms(&mut volts.iter().rev().take(samples[1]), samples[1]);
    for (place, volts) in [("begins", begins), ("ends", ends)] {
        if volts > REST_SHARE * greatest_v {
            return Err(Refusal::NotAtRest { place, volts });
        }
    }
    Ok(greatest_v)
}

/// Rejects a voltage that does not excite every band.
fn is_excited(means: &[Mean]) -> Result<(), Refusal> {
    // A logarithmic chirp has the same in each band.
    let mut all: Vec<f64> = means.iter().map(|mean| mean.excitation).collect();
    all.sort_by(f64::total_cmp);
    let median = all.get(all.len() / 2).copied().unwrap_or(0.0);
    match means
        .iter()
        .find(|mean| mean.excitation < LEAST_EXCITATION * median)
    {
        Some(mean) => Err(Refusal::LittleExcitation {
            hz: mean.omega / TAU,
            share: 100.0 * LEAST_EXCITATION,
        }),
        None => Ok(()),
    }
}

/// Rejects an open coil and a reversed current.
fn conducts(lines: &[Line], series: &Series) -> Result<(), Refusal> {
    let common: Complex<f64> = lines.iter().map(|l| l.amperes * l.volts.conj()).sum();
    let excitation: f64 = lines.iter().map(|l| l.volts.norm_sqr()).sum();
    let conductance = common.re / excitation;
    if conductance.abs() * OPEN_OHM < 1.0 {
        let rms = |values: &[f64]| {
            (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
        };
        return Err(Refusal::CoilOpen {
            amperes: rms(series.amperes()),
            volts: rms(series.volts()),
            limit_ohm: OPEN_OHM,
        });
    }
    if conductance < 0.0 {
        return Err(Refusal::Reversed {
            resistance_ohm: 1.0 / conductance,
        });
    }
    Ok(())
}

/// Detects a current that is clipped at a level, or too weak for the steps in which it is recorded.
fn spoiled(series: &Series) -> Option<Refusal> {
    let mut amperes: Vec<f64> = series.amperes().iter().map(|a| a.abs()).collect();
    amperes.sort_by(f64::total_cmp);
    // Noise on what is just below the level reaches further.
    let level = *amperes.get(amperes.len() - amperes.len() / 100 - 1)?;
    let step = (amperes.windows(2))
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > ROUNDING * level)
        .fold(f64::INFINITY, f64::min);
    if level < FEWEST_STEPS * step {
        return Some(Refusal::Weak {
            milliamperes: 1e3 * level,
            step_ma: 1e3 * step,
        });
    }
    let between = |low: f64, high: f64| {
        let below = |limit: f64| amperes.partition_point(|a| *a < limit * level);
        (below(high) - below(low)) as f64
    };
    let share = between(0.998, 1.002) / between(0.7, f64::INFINITY).max(1.0);
    (share > CLIPPED).then_some(Refusal::Clipped {
        amperes: level,
        share: 100.0 * share,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::synthetic::{Added, NOISE, NOMINAL, band, played};

    fn resonance_hz(examined: &ExplainedChirp) -> f64 {
        examined.fit.impedance.resonance / TAU
    }

    /// Their noise was called stops, friction or a dead time.
    #[test]
    fn slow_recordings_are_fitted_or_told_to_be_slow() {
        // 1000 and 500 rows a second.
        for (ticks, to_hz) in [(20, 300.0), (40, 180.0), (20, 350.0)] {
            let series = played(&NOMINAL, to_hz, ticks, NOISE);
            let found = ExplainedChirp::of(&series, band(to_hz), None).unwrap();
            let hz = resonance_hz(&found);
            assert!((hz / 35.0 - 1.0).abs() < 0.01, "{ticks}, {to_hz}: {hz}");
        }
        for (ticks, to_hz) in [(20, 500.0), (40, 500.0), (40, 250.0)] {
            let series = played(&NOMINAL, to_hz, ticks, NOISE);
            let refusal = ExplainedChirp::of(&series, band(to_hz), None).unwrap_err();
            assert!(matches!(refusal, Refusal::FewRows { .. }), "{refusal}");
            assert!(refusal.to_string().contains("sample faster"), "{refusal}");
        }
    }

    #[test]
    fn mains_hum_is_named_by_its_frequency() {
        // 60.03 Hz lie between two lines.
        for hz in [50.0, 60.03, 100.0] {
            for amperes in [0.005, 0.01] {
                let hum = Added {
                    hum: (amperes, hz),
                    ..NOISE
                };
                let series = played(&NOMINAL, 500.0, 5, hum);
                let refusal = ExplainedChirp::of(&series, band(500.0), None).unwrap_err();
                let Refusal::Hum { hz: found_hz, .. } = refusal else {
                    panic!("{hz} Hz, {amperes} A: {refusal}");
                };
                assert!((found_hz - hz).abs() < 0.1, "{found_hz} {hz}");
                assert!(refusal.to_string().contains("mains hum"), "{refusal}");
            }
        }
        // What depends on the current is not.
        let dead = Added {
            lost_a: 0.02,
            ..NOISE
        };
        let series = played(&NOMINAL, 500.0, 5, dead);
        let refusal = ExplainedChirp::of(&series, band(500.0), None).unwrap_err();
        assert!(matches!(refusal, Refusal::Nonlinear { .. }), "{refusal}");
    }
}
