//! Parameters of an actuator, from one or two chirps.

use crate::actuator::bands::Mean;
use crate::actuator::derived::derived;
use crate::actuator::explained_chirp::ExplainedChirp;
use crate::actuator::fit::Fit;
use crate::actuator::mass::{Split, Weighed, agreed, by_added_mass, by_weight};
use crate::actuator::refusal::Refusal;
use crate::actuator::{Band, Series};
use crate::estimate::Estimate;
use crepitus_model::render::effects::vibration_actuator::VibrationActuatorSettings;
use crepitus_plant::effects::limb::STANDARD_GRAVITY;
use crepitus_plant::effects::reaction_mass::impedance::Impedance;
use crepitus_plant::spectrum::Complex;
use std::f64::consts::TAU;

/// Widest half interval of a proposed parameter, as a share of its value.
const MOST_UNCERTAIN: f64 = 0.05;

/// Evidence of the moving mass: a balance, a second chirp with a known mass added, or both, which
/// are compared.
#[derive(Clone, Copy, Debug)]
pub enum MassEvidence<'s> {
    /// The moving mass was weighed.
    Weighed(Weighed),
    /// A second chirp was recorded with this mass added.
    Added(&'s Series, Weighed),
    /// Both: the weighed mass, the second chirp, the added mass.
    Both(Weighed, &'s Series, Weighed),
}

impl MassEvidence<'_> {
    /// Returns the weighed mass, kg.
    fn known_kg(&self) -> Option<f64> {
        match self {
            Self::Weighed(weighed) | Self::Both(weighed, ..) => Some(weighed.mass_kg),
            Self::Added(..) => None,
        }
    }

    fn split(&self, fit: &Fit, band: Band) -> Result<Split, Refusal> {
        let known_kg = self.known_kg();
        let with_added = |with: &Series, added: Weighed| {
            let with = ExplainedChirp::of(with, band, known_kg.map(|kg| kg + added.mass_kg))?;
            by_added_mass(fit, &with.fit, added)
        };
        match *self {
            Self::Weighed(weighed) => Ok(by_weight(fit, weighed)),
            Self::Added(with, added) => with_added(with, added),
            Self::Both(weighed, with, added) => {
                agreed(by_weight(fit, weighed), with_added(with, added)?)
            }
        }
    }
}

/// Identified parameters of an actuator, with 95 % confidence intervals.
#[derive(Clone, Debug)]
pub struct Actuator {
    /// Resistance of the coil and of what feeds it, Ω.
    pub resistance_ohm: Estimate,
    /// Inductance of the coil, H.
    pub inductance_h: Estimate,
    /// Resonance of the mass on its flexure, Hz.
    pub resonance_hz: Estimate,
    /// Damping ratio of the flexure alone.
    pub mechanical_damping_ratio: Estimate,
    /// Damping ratio with the coil connected, as the stage's parameter is defined.
    pub damping_ratio: Estimate,
    /// Moving mass, kg.
    pub moving_mass_kg: Estimate,
    /// Force constant, N/A.
    pub force_constant_n_per_a: Estimate,
    /// Delay of the recorded current behind the voltage, s.
    pub delay_s: Estimate,
    /// Peak excursion of the mass in the chirp, m.
    pub excursion_m: f64,
    /// Peak voltage of the chirp, V.
    pub amplitude_v: f64,
    /// RMS noise of a current sample, A.
    pub noise_a: f64,
    /// Systematic residual: RMS beyond the noise, as a share of the RMS current.
    pub unexplained: f64,
    /// Whether a second chirp has confirmed the mass; otherwise its error is that of the balance.
    pub mass_is_checked: bool,
    /// Whether the moving mass was found by weighing and with an added mass, and both agree; they
    /// do not if the ring moves.
    pub ring_is_checked: bool,
    pub(crate) impedance: Impedance,
    pub(crate) means: Vec<Mean>,
    pub(crate) misfits: Vec<(f64, f64)>,
}

/// Impedance of the coil at a frequency.
#[derive(Clone, Copy, Debug)]
pub struct ImpedancePoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Measured, mean over a 24th of an octave, Ω.
    pub measured_ohm: Complex<f64>,
    /// Fitted, Ω, with the delay of the measurement in it.
    pub fitted_ohm: Complex<f64>,
}

impl Actuator {
    /// Returns the measured and the fitted impedance over the band.
    pub fn impedance_points(&self) -> impl Iterator<Item = ImpedancePoint> {
        self.means.iter().map(|mean| ImpedancePoint {
            frequency_hz: mean.omega / TAU,
            measured_ohm: mean.impedance,
            fitted_ohm: 1.0 / self.impedance.admittance(mean.omega).0,
        })
    }

    /// Returns the frequency, Hz, and what the fit leaves there, as a share.
    pub fn misfits(&self) -> impl Iterator<Item = (f64, f64)> {
        self.misfits
            .iter()
            .map(|(omega, share)| (omega / TAU, *share))
    }
}

/// Identifies an actuator from a chirp.
///
/// # Errors
/// [`Refusal`]: what the recording shows instead.
pub fn identify(
    series: &Series,
    band: Band,
    evidence: &MassEvidence<'_>,
) -> Result<Actuator, Refusal> {
    let examined = ExplainedChirp::of(series, band, evidence.known_kg())?;
    let fit = &examined.fit;
    let split = evidence.split(fit, band)?;
    let actuator = Actuator {
        resistance_ohm: derived(fit, |z| z.resistance),
        inductance_h: derived(fit, |z| z.inductance),
        resonance_hz: derived(fit, |z| z.resonance / TAU),
        mechanical_damping_ratio: derived(fit, |z| 0.5 * z.damping / z.resonance),
        damping_ratio: derived(fit, Impedance::damping_ratio),
        moving_mass_kg: split.mass_kg,
        force_constant_n_per_a: split.force_constant,
        delay_s: derived(fit, |z| z.delay),
        excursion_m: examined.excursion_m(split.mass_kg.value),
        amplitude_v: examined.amplitude_v,
        noise_a: fit.residual.noise_a,
        unexplained: fit.residual.beyond_noise,
        mass_is_checked: !matches!(evidence, MassEvidence::Weighed(_)),
        ring_is_checked: matches!(evidence, MassEvidence::Both(..)),
        impedance: fit.impedance,
        misfits: fit.misfits.clone(),
        means: examined.means,
    };
    actuator.is_certain()?;
    Ok(actuator)
}

impl Actuator {
    /// Returns the settings in use with these parameters in their place.
    ///
    /// # Errors
    /// [`Refusal::Settings`] where the device would reject them.
    pub fn settings(
        &self,
        in_use: &VibrationActuatorSettings,
    ) -> Result<VibrationActuatorSettings, Refusal> {
        let proposed = VibrationActuatorSettings {
            resonance_hz: self.resonance_hz.value,
            damping_ratio: self.damping_ratio.value,
            moving_mass_g: 1e3 * self.moving_mass_kg.value,
            force_constant_n_per_a: self.force_constant_n_per_a.value,
            resistance_ohm: self.resistance_ohm.value,
            ..*in_use
        };
        proposed.check().map_err(Refusal::Settings)?;
        Ok(proposed)
    }

    /// Returns warnings about the use of these parameters.
    pub fn notes(&self, in_use: &VibrationActuatorSettings) -> Vec<String> {
        let mut notes = Vec::new();
        if !self.mass_is_checked {
            notes.push(
                "nothing in the current tells a wrong mass: force constant and mass are as good as the mass that was \
                 given; a second chirp with an added mass would check it"
                    .to_owned(),
            );
        }
        if !self.ring_is_checked {
            notes.push(format!(
                "a ring that a hand holds can pass for one in a vice: with {:.1} mA of noise in the current its \
                 resonance may not show; a weighed mass and a second chirp with an added one would check it",
                1e3 * self.noise_a
            ));
        }
        let sag_m = STANDARD_GRAVITY / (TAU * self.resonance_hz.value).powi(2);
        let (excursion_mm, sag_mm) = (1e3 * self.excursion_m, 1e3 * sag_m);
        if excursion_mm + sag_mm > in_use.stroke_mm {
            notes.push(format!(
                "the mass swings by ±{excursion_mm:.2} mm and sags by {sag_mm:.2} mm, more than stroke_mm = {}, but \
                 does not hit a stop: is stroke_mm right?",
                in_use.stroke_mm
            ));
        }
        notes
    }

    fn is_certain(&self) -> Result<(), Refusal> {
        let checked = [
            ("the resistance", self.resistance_ohm),
            ("the resonance", self.resonance_hz),
            ("the damping ratio", self.damping_ratio),
            ("the moving mass", self.moving_mass_kg),
            ("the force constant", self.force_constant_n_per_a),
        ];
        let uncertain = checked
            .into_iter()
            // Not below the limit, NaN included.
            .find(|(_, estimate)| !matches!(estimate.share(), share if share <= MOST_UNCERTAIN));
        match uncertain {
            Some((what, estimate)) => Err(Refusal::Uncertain {
                what,
                share: 100.0 * estimate.share(),
                limit: 100.0 * MOST_UNCERTAIN,
                noise_ma: 1e3 * self.noise_a,
            }),
            None => Ok(()),
        }
    }
}
