//! Moving mass and force constant, which the current alone shows only as b = Bl²/m.
//!
//! Either the moving mass is weighed, or a second chirp is played with a known mass Δ
//! on it. That lowers ω₀² and b by the same ratio
//!
//! ```text
//! ρ = (m + Δ)/m = (ω₀/ω₀')² = b/b'        m = Δ/(ρ − 1)        Bl = √(b·m)
//! ```
//!
//! so that each checks the other.

use crate::actuator::derived::{derived, variance};
use crate::actuator::fit::Fit;
use crate::actuator::refusal::Refusal;
use crate::estimate::{DEVIATIONS, Estimate};
use crepitus_plant::effects::reaction_mass::impedance::Impedance;
use std::f64::consts::TAU;

/// A weighed mass with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Half width of its 95 % confidence interval, as a share of the mass.
    pub share: f64,
}

/// Mass and force constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Split {
    pub(crate) mass_kg: Estimate,
    pub(crate) force_constant: Estimate,
}

/// Relative difference of two estimates that is tolerated, whatever the noise.
const SAME: f64 = 0.02;

/// Least ρ − 1.
const LEAST_CHANGE: f64 = 0.08;

/// Largest relative change of the resistance between two chirps: 13 K of copper.
const WARM: f64 = 0.05;

/// Returns mass and force constant from a weighed mass.
pub(crate) fn by_weight(fit: &Fit, weighed: Weighed) -> Split {
    let mass_kg = Estimate::known(weighed.mass_kg, weighed.share);
    let of_fit = derived(fit, |z| (z.coupling * weighed.mass_kg).sqrt());
    let of_mass = 0.5 * weighed.share * of_fit.value;
    Split {
        mass_kg,
        force_constant: Estimate {
            half_width: of_fit.half_width.hypot(of_mass),
            ..of_fit
        },
    }
}

/// Returns mass and force constant from a second chirp with a known mass added.
pub(crate) fn by_added_mass(fit: &Fit, with: &Fit, added: Weighed) -> Result<Split, Refusal> {
    is_as_cold(fit, with)?;
    let (z, z_with) = (fit.impedance, with.impedance);
    let by_resonance = |z: &Impedance, with: &Impedance| 2.0 * (z.resonance / with.resonance).ln();
    let by_coupling = |z: &Impedance, with: &Impedance| (z.coupling / with.coupling).ln();
    let (resonance, coupling) = (by_resonance(&z, &z_with), by_coupling(&z, &z_with));
    let of_resonance =
        variance(fit, |z| by_resonance(z, &z_with)) + variance(with, |with| by_resonance(&z, with));
    if resonance < -DEVIATIONS * of_resonance.sqrt() {
        return Err(Refusal::Swapped {
            without_hz: z.resonance / TAU,
            with_hz: z_with.resonance / TAU,
        });
    }
    if resonance.exp() - 1.0 < LEAST_CHANGE {
        return Err(Refusal::AddedMassSmall {
            without_hz: z.resonance / TAU,
            with_hz: z_with.resonance / TAU,
        });
    }
    let of_coupling =
        variance(fit, |z| by_coupling(z, &z_with)) + variance(with, |with| by_coupling(&z, with));
    let most = DEVIATIONS * (of_resonance + of_coupling).sqrt();
    if (resonance - coupling).abs() > most.hypot(SAME) {
        return Err(Refusal::AddedMassLoose {
            by_resonance: resonance.exp(),
            by_coupling: coupling.exp(),
        });
    }
    // Each as much as it is certain.
    let weight = of_coupling / (of_resonance + of_coupling);
    let mass = |z: &Impedance, with: &Impedance, added_kg: f64| {
        let log = weight * by_resonance(z, with) + (1.0 - weight) * by_coupling(z, with);
        added_kg / log.exp_m1()
    };
    let constant = |z: &Impedance, with: &Impedance, added_kg: f64| {
        (z.coupling * mass(z, with, added_kg)).sqrt()
    };
    // Mass goes with Δ, force constant with its root.
    let estimate = |of: &dyn Fn(&Impedance, &Impedance, f64) -> f64, power: f64| {
        let value = of(&z, &z_with, added.mass_kg);
        let of_fits = variance(fit, |z| of(z, &z_with, added.mass_kg))
            + variance(with, |with| of(&z, with, added.mass_kg));
        Estimate {
            value,
            half_width: (DEVIATIONS * of_fits.sqrt()).hypot(power * added.share * value),
        }
    };
    Ok(Split {
        mass_kg: estimate(&mass, 1.0),
        force_constant: estimate(&constant, 0.5),
    })
}

/// Returns the more certain of two results; rejects results that contradict each other.
pub(crate) fn agreed(weighed: Split, added: Split) -> Result<Split, Refusal> {
    let (a, b) = (weighed.mass_kg, added.mass_kg);
    let most = a.half_width.hypot(b.half_width).hypot(SAME * a.value);
    if (a.value - b.value).abs() > most {
        return Err(Refusal::WrongMass {
            found_g: 1e3 * b.value,
            weighed_g: 1e3 * a.value,
        });
    }
    Ok(if a.half_width <= b.half_width {
        weighed
    } else {
        added
    })
}

fn is_as_cold(fit: &Fit, with: &Fit) -> Result<(), Refusal> {
    let (first_ohm, second_ohm) = (fit.impedance.resistance, with.impedance.resistance);
    if (second_ohm / first_ohm - 1.0).abs() > WARM {
        return Err(Refusal::Warm {
            first_ohm,
            second_ohm,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::explained_chirp::ExplainedChirp;
    use crate::actuator::synthetic::{NOISE, NOMINAL, band, played};

    #[test]
    fn swapped_recordings_are_told_so() {
        let fitted = |ratio: f64| {
            let z = Impedance {
                coupling: NOMINAL.coupling / ratio,
                damping: NOMINAL.damping / ratio,
                resonance: NOMINAL.resonance / ratio.sqrt(),
                ..NOMINAL
            };
            let series = played(&z, 500.0, 5, NOISE);
            ExplainedChirp::of(&series, band(500.0), None).unwrap().fit
        };
        let added = Weighed {
            mass_kg: 0.03,
            share: 0.01,
        };
        let (bare, with) = (fitted(1.0), fitted(1.5));
        let found = by_added_mass(&bare, &with, added).unwrap();
        assert!((found.mass_kg.value / 0.06 - 1.0).abs() < 0.02);
        let swapped = by_added_mass(&with, &bare, added).unwrap_err();
        assert!(swapped.to_string().contains("swapped"), "{swapped}");
        // Equal fits mean too small a mass.
        let same = by_added_mass(&bare, &bare, added).unwrap_err();
        assert!(matches!(same, Refusal::AddedMassSmall { .. }), "{same}");
    }

    #[test]
    fn of_two_masses_that_agree_the_more_certain_one_is_reported() {
        let split = |mass_kg, share| Split {
            mass_kg: Estimate::known(mass_kg, share),
            force_constant: Estimate::known(60.0 * mass_kg, share),
        };
        let (certain, rough) = (split(0.06, 0.005), split(0.0605, 0.02));
        assert_eq!(agreed(certain, rough).unwrap(), certain);
        assert_eq!(agreed(rough, certain).unwrap(), certain);
    }
}
