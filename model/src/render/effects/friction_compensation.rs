//! Feed-forward against the gear's dry friction, which is larger than the
//! crepitus that is to be felt through it.
//!
//! ```text
//!  added torque, N·m                 T = −share·friction·sat(Ω/fade)
//!   +0.4 ─────╲
//!              ╲
//!   ────────────╲──────────── Ω      T > 0 opposes growing φ, so what is
//!                ╲                   added pushes along
//!   −0.4          ╲─────────
//!          −0.05  0  0.05 rad/s
//! ```
//!
//! Only a share is cancelled, because what is left is what keeps a sampled
//! spring passive: it gives away kr·τ·∫Ω² dt, τ = h·(½ + d) being the mean lag,
//! 0.21 ms ([`energy_observer`](crate::control::energy_observer) has d), and a friction F
//! takes more than that up to Ω = F/(kr·τ). No stick can drive a shaft of
//! inertia J faster than Ts/√(kr·J), so whatever the cuff and the hand are
//!
//! ```text
//! (1 − share)·friction ≥ Ts·τ·√(kr/J)         J = 0.061 kg·m², rotor and brace
//! ```
//!
//! keeps a resting hand quiet: 7, 3 and 21 mN·m for the presets ([`least_left_nm`]).
//! The largest share is 0.9: of 0.5 N·m it leaves 50. Near standstill the sign of
//! the speed is noise of the encoder (one count is 0.011 rad/s), so there it fades
//! out. `crepitus stability --coupled` maps what happens with less.
//!
//! **Energy.** |T| ≤ share·friction, so over any motion the hand gets at most
//! share·friction·∫|dφ|, whatever the delay or the noise of Ω, and a gear whose
//! friction is at least that takes it all:
//!
//! ```text
//! gear + compensation take ≥ (true − share·friction)·∫|dφ|
//! ```
//!
//! A delay never adds to what the hand gets: after a reversal the torque of the
//! old sense opposes the hand until it changes sign, at most
//! share·friction·min(1, Ω̇·d/fade) over a travel of Ω̇·d²/2 for a delay d; at
//! 200 rad/s² and 0.1 ms that is 0.16 N·m over 1 µrad.
//!
//! The compensation is wrong where the gear has less friction than share·friction: a warm
//! gear, another motor, a motion inside the backlash. Then the joint pushes a
//! moving leg with the difference, up to share·friction. Set the least friction
//! that is ever measured.
//!
//! Sources: friction 0.5 N·m at the joint is the paper's; the share and the
//! fade are engineering estimates (the fade is 4.5 counts of the encoder at the
//! estimator's 50 Hz).

use crate::joint::{Parameters, SettingsError};
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::Shown;
use crate::render::effects::{
    DeviceEffect, EffectSpec, Need, Observe, Owner, Slewed, Tick, Timing,
};

settings! {
    /// Assumed friction of the gear, and the share of it to cancel.
    pub struct FrictionCompensationSettings, group "friction-compensation" {
        render (9 always) ["off", "on"], 0, "whether a share of the gear's friction is cancelled";
    } {
        friction_nm (10 always) "Tf" "N·m", 0.0..=2.0, 0.5,
            "dry friction of the gear that the device assumes, at the joint";
        share (11 always) "σ" "1", 0.0..=0.9, 0.8,
            "share of the friction that is cancelled; the rest keeps sampled springs passive";
        fade_rad_s (12 always) "Ωf" "rad/s", 1e-3..=10.0, 0.05,
            "speed of the joint below which the compensation fades out to zero";
    }
}

/// The least dry friction that has to be left, N·m, for this joint to keep a
/// resting hand quiet by friction alone: what acts lags behind by `lag_s` on
/// average, and the shaft has this inertia.
pub fn least_left_nm(joint: &Parameters, lag_s: f64, inertia_kg_m2: f64) -> f64 {
    let radians_per_s = libm::sqrt(joint.stiffness_nm_per_rad / inertia_kg_m2);
    joint.static_torque_nm * lag_s * radians_per_s
}

/// The feed-forward; it has no state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionCompensation<F> {
    /// share·friction, N·m.
    most_nm: F,
    /// share·friction/fade, N·m·s/rad.
    slope: F,
}

impl<F: Real> DeviceEffect<F> for FrictionCompensation<F> {
    type Settings = FrictionCompensationSettings;
    type Coefficients = Self;
    type Switched = Slewed<F, Self>;

    const SPEC: EffectSpec = EffectSpec {
        name: "friction-compensation",
        adds: "the device's feed-forward against a share of the gear's dry friction",
        states: &[],
        column: "compensation_nm",
        unit: "N·m",
        title: "Friction compensation, added to the model’s torque",
        phases: None,
        needs: &[Need {
            effect: "drivetrain",
            why: "without it there is no friction to compensate",
        }],
        parameters: FrictionCompensationSettings::TABLE,
        choices: FrictionCompensationSettings::CHOICES,
        of: Owner::Brace,
        sides: &[],
    };

    fn coefficients(
        settings: &FrictionCompensationSettings,
        _: &Timing,
    ) -> Result<Self, SettingsError> {
        settings.validate()?;
        let most_nm = settings.share * settings.friction_nm;
        Ok(Self {
            most_nm: F::from_f64(most_nm),
            slope: F::from_f64(most_nm / settings.fade_rad_s),
        })
    }

    fn new(coefficients: Self) -> Self {
        coefficients
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn added(&mut self, tick: &Tick<'_, F>, _: &mut Shown<F>, _: &mut impl Observe<F>) -> F {
        self.torque_nm(tick.omega_rad_s)
    }
}

impl<F: Real> FrictionCompensation<F> {
    /// The torque to add at the joint's speed, N·m; 0 at a speed that is not
    /// finite.
    #[inline]
    pub fn torque_nm(&self, omega_rad_s: F) -> F {
        if !omega_rad_s.is_finite() {
            return F::ZERO;
        }
        let along_nm = self.slope * omega_rad_s;
        -along_nm.within(self.most_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::effects::tests::{TIMING, law};

    fn compensation<F: Real>() -> FrictionCompensation<F> {
        law(&FrictionCompensationSettings::default())
    }

    #[test]
    fn settings_are_their_table_and_are_held_to_it() {
        type Settings = FrictionCompensationSettings;
        crate::parameters::tests::is_its_table_and_is_held_to_it::<3, Settings>();
        let s = Settings::default();
        assert_eq!((s.friction_nm, s.share, s.fade_rad_s), (0.5, 0.8, 0.05));
        let beyond = Settings { share: 0.91, ..s };
        assert!(FrictionCompensation::<f32>::coefficients(&beyond, &TIMING).is_err());
    }

    #[test]
    fn the_papers_joint_needs_little_friction() {
        let need = least_left_nm(&Parameters::default(), 210.4e-6, 0.061);
        assert!((need - 6.81e-3).abs() < 1e-5, "{need}");
    }

    fn curve<F: Real>() {
        let (c, f) = (compensation::<F>(), F::from_f64);
        for (omega, along) in [
            (0.0, 0.0),
            (0.01, 0.08),
            (0.025, 0.2),
            (0.05, 0.4),
            (3.0, 0.4),
            (1e30, 0.4),
        ] {
            for sign in [1.0, -1.0] {
                let torque = c.torque_nm(f(sign * omega)).to_f64();
                assert!((torque + sign * along).abs() < 1e-7, "{omega}: {torque}");
            }
            assert_eq!(c.torque_nm(f(-omega)), -c.torque_nm(f(omega)));
        }
        for none in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(c.torque_nm(f(none)), F::ZERO);
        }
    }

    #[test]
    fn it_pushes_along_by_its_share_and_fades_out_at_rest() {
        curve::<f32>();
        curve::<f64>();
    }

    #[test]
    fn what_a_late_reversal_costs_is_bounded() {
        // Ω from − to + at 200 rad/s², the torque 0.1 ms late.
        let (c, acceleration, late_s) = (compensation::<f64>(), 200.0, 1e-4);
        let (n, mut wrong_j, mut wrong_nm) = (10_000_u32, 0.0, 0.0_f64);
        let dt = late_s / f64::from(n);
        for i in 0..n {
            let omega = acceleration * (f64::from(i) + 0.5) * dt;
            let torque = c.torque_nm(omega - acceleration * late_s);
            assert!(torque >= 0.0);
            wrong_j += torque * omega * dt;
            wrong_nm = wrong_nm.max(torque);
        }
        assert!((wrong_nm - 0.16).abs() < 1e-4, "{wrong_nm}");
        assert!(wrong_j > 0.0 && wrong_j < 0.16e-6, "{wrong_j}");
    }
}
