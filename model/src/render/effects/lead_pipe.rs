//! `lead-pipe`: rigidity that is the same in both directions, over the whole
//! range, and at any speed.
//!
//! ```text
//! T = play(σ, ±Tc) + ke·(φ − φ₀)        σ = Tc/δ
//! ```
//!
//! A loop over ±A takes 4·Tc·(A − δ); after a turn it takes 2δ to push the other
//! way. "Elastic coefficient" and "difference of bias", 2Tc, are the components
//! that physicians perceive (Endo et al. 2013).
//!
//! Sources: δ is the short-range stiffness, to 1.5° (De Groote et al. 2018);
//! torques are estimates.

use super::play::{Hold, Limits, Part, Play};
use super::symptom::{Bounds, ClinicWords, Hear, Law};
use super::{EffectSpec, Owner, PhaseSpec, Timing};
use crate::joint::SettingsError;
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::position::{Position, Scale, Travel};

settings! {
    /// Lead-pipe rigidity.
    pub struct LeadPipeSettings, group "lead-pipe" {
        render (52 always) ["off", "on"], 0, "whether the joint resists as a lead pipe does";
    } {
        torque_nm (53 always) "Tc" "N·m", 0.0..=4.5, 1.2,
            "resistance, the same in both directions and at any speed (estimate)";
        presliding_deg (54 always) "δ" "deg", 0.2..=10.0, 1.5, "travel over which the resistance builds up (sourced)";
        elastic_nm_per_rad (55 always) "ke" "N·m/rad", 0.0..=10.0, 0.0,
            "stiffness about the neutral angle (estimate)";
        neutral_deg (56 always) "φ₀" "deg", 0.0..=140.0, 45.0,
            "angle at which the stiffness has no torque (estimate)";
    }
}

/// Coefficients of [`LeadPipe`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeadPipeCoefficients<F> {
    scale: Scale<F>,
    torque_nm: F,
    stiffness: F,
    elastic: F,
    neutral: Position<F>,
}

/// The rigidity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadPipe<F> {
    with: LeadPipeCoefficients<F>,
    play: Play<F>,
    elastic_nm: F,
}

impl<F: Real> Law for LeadPipe<F> {
    type Real = F;
    type Settings = LeadPipeSettings;
    type Coefficients = LeadPipeCoefficients<F>;

    const SPEC: EffectSpec = EffectSpec {
        name: "lead-pipe",
        adds: "rigidity that is the same in both directions and at any speed",
        states: &["stretch"],
        column: "lead_pipe_nm",
        unit: "N·m",
        title: "Lead-pipe rigidity, part of the model’s torque",
        phases: Some(PhaseSpec {
            column: "lead_pipe_phase",
            names: &["held", "sliding"],
        }),
        needs: &[],
        parameters: LeadPipeSettings::TABLE,
        choices: LeadPipeSettings::CHOICES,
        of: Owner::Knee,
        sides: &[],
    };

    const WORDS: ClinicWords = ClinicWords {
        title: "Lead-pipe rigidity",
        states: &["resistance builds up or turns over", "even resistance"],
        changes: &[],
        within: &[],
    };

    fn check(s: &LeadPipeSettings) -> Result<(), SettingsError> {
        s.validate()?;
        Ok(())
    }

    fn bounds(s: &LeadPipeSettings) -> Bounds {
        Bounds {
            torque_nm: s.torque_nm,
            slope_nm_per_rad: s.elastic_nm_per_rad,
            stiffness_nm_per_rad: s.torque_nm / s.presliding_deg.to_radians()
                + s.elastic_nm_per_rad,
            is_wall: false,
        }
    }

    fn coefficients(
        settings: &LeadPipeSettings,
        timing: &Timing,
    ) -> Result<LeadPipeCoefficients<F>, SettingsError> {
        Self::check(settings)?;
        let s = settings;
        Ok(LeadPipeCoefficients {
            scale: timing.scale()?,
            torque_nm: F::from_f64(s.torque_nm),
            stiffness: F::from_f64(s.torque_nm / s.presliding_deg.to_radians()),
            elastic: F::from_f64(s.elastic_nm_per_rad),
            neutral: timing.sensing.position(s.neutral_deg.to_radians()),
        })
    }

    fn new(coefficients: LeadPipeCoefficients<F>) -> Self {
        Self {
            with: coefficients,
            play: Play::new(),
            elastic_nm: F::ZERO,
        }
    }

    fn rest(&mut self, place: &Position<F>) {
        self.play.rest(place);
        self.elastic_nm = F::ZERO;
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let with = &self.with;
        self.elastic_nm = with.elastic * travel.end_beyond(&with.neutral);
        let limits = Limits::both(with.torque_nm);
        let part = Part::whole(F::ONE);
        self.play
            .follow(travel, part, with.stiffness, |_| limits, on_change)
            + self.elastic_nm
    }

    fn torque_nm(&self) -> F {
        self.play.torque_nm() + self.elastic_nm
    }

    fn resting_nm(&self, place: &Position<F>) -> F {
        let with = &self.with;
        with.elastic * place.beyond(&with.neutral, with.scale.rad_per_count)
    }

    fn adopt(&mut self, coefficients: LeadPipeCoefficients<F>, slew_nm: F) {
        let (from, to) = (self.with.stiffness, coefficients.stiffness);
        self.play.change(from, to, slew_nm);
        self.with = coefficients;
    }

    fn release(&mut self, slew_nm: F) {
        self.play.release(slew_nm);
        self.elastic_nm = self.elastic_nm - self.elastic_nm.within(slew_nm);
    }

    fn is_active(&self) -> bool {
        false
    }

    fn phase(&self) -> u16 {
        u16::from(self.play.hold() != Hold::Elastic)
    }
}
