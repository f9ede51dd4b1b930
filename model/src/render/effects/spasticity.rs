//! `spasticity`: a muscle that resists a fast stretch and not a slow one.
//!
//! Two forms of one disorder, with one table of severities (the modified Ashworth
//! scale, MAS):
//!
//! - `catch`, what an examiner describes: nothing, then a catch whose angle comes the
//!   earlier the faster the stretch, then what is left. It is a play and gives no
//!   energy.
//! - `reflex`, a mechanism: the threshold of the stretch reflex falls with velocity
//!   (λ model), the muscle answers late. It pushes back after a stop, so a tank pays
//!   for it.

mod caught;
mod reflex;

use super::symptom::{Bounds, ClinicWords, Hear, Law, Word, sense};
use super::{EffectSpec, Owner, PhaseSpec, Timing};
use crate::joint::SettingsError;
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::position::{Position, Travel, rise};
use caught::{Caught, CaughtCoefficients};
use reflex::{Reflex, ReflexCoefficients};

settings! {
    /// A spastic muscle.
    pub struct SpasticitySettings, group "spasticity" {
        render (72 always) ["off", "on"], 0, "whether a muscle resists fast stretches";
    } chosen {
        form (73 always) ["catch", "reflex"], 0, "as an examiner describes it, or as the stretch reflex makes it";
        muscles (74 always) ["extensors", "flexors"], 0, "which muscles: extensors resist flexion, flexors extension";
    } {
        threshold_deg (75 always) "λ" "deg", -30.0..=170.0, 75.0,
            "angle at which a slow stretch meets the threshold (estimate)";
        velocity_shift_s (76 always) "μ" "s", 0.0..=0.5, 0.25,
            "how much earlier the threshold is for each rad/s of stretch (sourced; of a reflex, 0.27)";
        torque_nm (77 always) "Tmax" "N·m", 0.0..=6.5, 4.5, "largest torque of the muscle (derived)";
        threshold_velocity_deg_s (78 always) "Ωth" "deg/s", 5.0..=200.0, 40.0,
            "speed of stretch below which there is no catch (estimate); form catch";
        velocity_torque_nms_per_rad (79 always) "b" "N·m·s/rad", 0.0..=2.0, 0.67,
            "torque of the catch for each rad/s of stretch (sourced); form catch";
        residual_share (80 always) "r" "1", 0.0..=1.0, 0.5,
            "share of the catch that is left after its release (estimate); form catch";
        stiffness_nm_per_rad (81 always) "k" "N·m/rad", 0.0..=10.0, 1.0,
            "how it grows beyond the catch (estimate); form catch";
        release_s (82 always) "τ" "s", 0.01..=1.0, 0.06, "time in which the catch releases (estimate); form catch";
        catch_stiffness_nm_per_rad (83 always) "σ" "N·m/rad", 10.0..=300.0, 60.0,
            "stiffness with which the catch builds up (estimate); form catch";
        rearm_deg (84 always) "Δ" "deg", 2.0..=60.0, 10.0,
            "retreat from the catch after which there can be another (estimate); form catch";
        gain_nm_per_rad (85 always) "k" "N·m/rad", 0.0..=20.0, 2.43,
            "torque of the muscle for each radian beyond the threshold (sourced); form reflex";
        delay_s (86 always) "τd" "s", 0.0..=0.1, 0.05, "time from stretch to answer (sourced); form reflex";
        activation_s (87 always) "τa" "s", 0.002..=0.1, 0.01,
            "time in which the muscle builds up its torque (sourced); form reflex";
    }
}

impl SpasticitySettings {
    /// Returns whether it has the form `catch`; otherwise `reflex`.
    pub fn catches(&self) -> bool {
        self.form == 0
    }
}

/// The threshold of a muscle: s·(φ − λ + μΩ), rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Threshold<F> {
    place: Position<F>,
    shift_s: F,
    /// ±1: the sense of φ in which the muscle is stretched.
    sense: F,
}

impl<F: Real> Threshold<F> {
    /// Distance of the joint beyond the threshold at the end of a travel.
    #[inline]
    fn end_beyond(&self, travel: &Travel<F>) -> F {
        self.sense * (travel.end_beyond(&self.place) + self.shift_s * travel.omega_end_rad_s)
    }

    /// Distance of the joint beyond the threshold at the beginning of a travel.
    #[inline]
    fn start_beyond(&self, travel: &Travel<F>) -> F {
        self.sense
            * (travel.end_beyond(&self.place) - travel.delta_rad
                + self.shift_s * travel.omega_start_rad_s)
    }

    /// The share of a travel at which a joint that begins so far beyond has come to
    /// `level` from below.
    fn rises_to(&self, level: F, start_beyond: F, travel: &Travel<F>) -> F {
        if start_beyond >= level {
            return F::ZERO;
        }
        let faster = self.shift_s * (travel.omega_end_rad_s - travel.omega_start_rad_s);
        let slope = self.sense * (travel.delta_rad - travel.bend_rad + faster);
        rise(slope, self.sense * travel.bend_rad, level - start_beyond)
    }

    /// Or from above.
    fn falls_to(&self, level: F, start_beyond: F, travel: &Travel<F>) -> F {
        let mirrored = Self {
            sense: -self.sense,
            ..*self
        };
        mirrored.rises_to(-level, -start_beyond, travel)
    }
}

/// Coefficients of [`Spasticity`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpasticityCoefficients<F> {
    /// Coefficients of the form `catch`.
    Catch(CaughtCoefficients<F>),
    /// Coefficients of the form `reflex`.
    Reflex(ReflexCoefficients<F>),
}

impl<F: Real> Default for SpasticityCoefficients<F> {
    fn default() -> Self {
        Self::Catch(CaughtCoefficients::default())
    }
}

/// Form of spasticity that is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Catch,
    Reflex,
}

/// The muscle. It has the memory of both forms: a commit moves none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spasticity<F: Real> {
    form: Form,
    caught: Caught<F>,
    reflex: Reflex<F>,
}

impl<F: Real> Law for Spasticity<F> {
    type Real = F;
    type Settings = SpasticitySettings;
    type Coefficients = SpasticityCoefficients<F>;

    const SPEC: EffectSpec = EffectSpec {
        name: "spasticity",
        adds: "a muscle that resists a fast stretch and not a slow one",
        states: &[
            "stretch of the catch",
            "its decay",
            "the reflex’s delay and torque",
        ],
        column: "spasticity_nm",
        unit: "N·m",
        title: "Spasticity, part of the model’s torque",
        phases: Some(PhaseSpec {
            column: "spasticity_phase",
            names: &["silent", "caught", "reflex", "reflex-at-its-largest"],
        }),
        needs: &[],
        parameters: SpasticitySettings::TABLE,
        choices: SpasticitySettings::CHOICES,
        of: Owner::Knee,
        sides: &[],
    };

    const WORDS: ClinicWords = ClinicWords {
        title: "Spasticity",
        states: &[
            "silent",
            "caught",
            "the reflex answers",
            "the reflex at its largest",
        ],
        changes: &[
            (0, 1, Word::Catch, "catch"),
            (1, 0, Word::Rearm, "can catch again"),
            (0, 2, Word::Onset, "the reflex begins"),
            (2, 3, Word::Cap, "at its largest"),
            (3, 2, Word::Uncap, "falls again"),
            (2, 0, Word::Offset, "the reflex ends"),
        ],
        within: &[],
    };

    fn check(s: &SpasticitySettings) -> Result<(), SettingsError> {
        s.validate()?;
        // Rounding must not refuse the least shift itself.
        if s.form == 1 && s.velocity_shift_s * (1.0 + 1e-9) < s.delay_s + s.activation_s {
            return Err(SettingsError::Contradiction {
                reason: "spasticity: in the form reflex velocity_shift_s must be no less than delay_s + activation_s: \
                         otherwise it gives energy at every speed",
            });
        }
        Ok(())
    }

    fn bounds(s: &SpasticitySettings) -> Bounds {
        Bounds {
            torque_nm: s.torque_nm,
            slope_nm_per_rad: s.stiffness_nm_per_rad,
            stiffness_nm_per_rad: if s.catches() {
                s.catch_stiffness_nm_per_rad
            } else {
                0.0
            },
            is_wall: false,
        }
    }

    fn coefficients(
        settings: &SpasticitySettings,
        timing: &Timing,
    ) -> Result<SpasticityCoefficients<F>, SettingsError> {
        Self::check(settings)?;
        let threshold = Threshold {
            place: timing.sensing.position(settings.threshold_deg.to_radians()),
            shift_s: F::from_f64(settings.velocity_shift_s),
            sense: sense(settings.muscles),
        };
        Ok(if settings.form == 0 {
            SpasticityCoefficients::Catch(CaughtCoefficients::new(settings, threshold, timing)?)
        } else {
            SpasticityCoefficients::Reflex(ReflexCoefficients::new(settings, threshold, timing)?)
        })
    }

    fn new(coefficients: SpasticityCoefficients<F>) -> Self {
        let mut spasticity = Self {
            form: Form::Catch,
            caught: Caught::new(CaughtCoefficients::default()),
            reflex: Reflex::new(ReflexCoefficients::default()),
        };
        spasticity.adopt(coefficients, F::ZERO);
        spasticity
    }

    fn rest(&mut self, place: &Position<F>) {
        match self.form {
            Form::Catch => self.caught.rest(place),
            Form::Reflex => self.reflex.rest(),
        }
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        match self.form {
            Form::Catch => self.caught.follow(travel, on_change),
            Form::Reflex => self.reflex.follow(travel, on_change),
        }
    }

    fn torque_nm(&self) -> F {
        match self.form {
            Form::Catch => self.caught.torque_nm(),
            Form::Reflex => self.reflex.torque_nm(),
        }
    }

    fn adopt(&mut self, coefficients: SpasticityCoefficients<F>, slew_nm: F) {
        match (self.form, coefficients) {
            (Form::Catch, SpasticityCoefficients::Catch(with)) => {
                self.caught.adopt(with, slew_nm);
            }
            (Form::Reflex, SpasticityCoefficients::Reflex(with)) => self.reflex.adopt(with),
            (Form::Reflex, SpasticityCoefficients::Catch(with)) => {
                self.form = Form::Catch;
                self.caught = Caught::new(with);
            }
            (Form::Catch, SpasticityCoefficients::Reflex(with)) => {
                self.form = Form::Reflex;
                self.reflex.rest();
                self.reflex.adopt(with);
            }
        }
    }

    fn retime(&mut self, settings: &SpasticitySettings, timing: &Timing, _: f64) {
        match self.form {
            Form::Catch => self.caught.retime(settings, timing),
            Form::Reflex => self.reflex.retime(settings, timing),
        }
    }

    fn forget_part(&mut self, before: &Self) {
        self.reflex.forget_part(&before.reflex);
    }

    fn release(&mut self, slew_nm: F) {
        match self.form {
            Form::Catch => self.caught.release(slew_nm),
            Form::Reflex => self.reflex.release(slew_nm),
        }
    }

    fn is_active(&self) -> bool {
        self.form == Form::Reflex
    }

    fn phase(&self) -> u16 {
        match self.form {
            Form::Catch => u16::from(self.caught.is_caught()),
            Form::Reflex => self.reflex.phase(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::ShaftStep;
    use crate::real::counted::{Counted, operations};
    use crate::render::effects::tests::TIMING;
    use crate::render::input_check::Checked;
    use crate::render::position::tests::travel;
    use crate::render::position::{Scale, Sensing};

    #[test]
    fn a_level_is_met_where_angle_and_velocity_make_it() {
        for (from, to) in [(1.0, 1.0), (1.0, 4.0), (0.5, 9.0), (4.0, 3.0)] {
            for (sense, shift_s) in [(1.0, 0.0), (-1.0, 0.0), (1.0, 1e-5), (-1.0, 1e-5)] {
                let travel = travel(sense * from, sense * to);
                let threshold = Threshold {
                    place: Sensing::IDEAL.position(1.0),
                    shift_s,
                    sense,
                };
                let beyond = |fraction: f64| {
                    let place = travel.place(fraction);
                    let angle_rad = place.beyond(&threshold.place, travel.rad_per_count);
                    sense * (angle_rad + shift_s * travel.omega_rad_s(fraction))
                };
                let start = threshold.start_beyond(&travel);
                assert!((start - beyond(0.0)).abs() < 1e-15);
                assert!((threshold.end_beyond(&travel) - beyond(1.0)).abs() < 1e-15);
                for fraction in [0.1, 0.5, 0.9] {
                    let found = threshold.rises_to(beyond(fraction), start, &travel);
                    assert!((found - fraction).abs() < 1e-6, "{found} {fraction}");
                    // The motion seen from the other side falls.
                    let other = Threshold {
                        sense: -sense,
                        ..threshold
                    };
                    let level = -beyond(fraction);
                    let found = other.falls_to(level, other.start_beyond(&travel), &travel);
                    assert!((found - fraction).abs() < 1e-6, "{found} {fraction}");
                }
                assert_eq!(threshold.rises_to(start, start, &travel), 0.0);
            }
        }
    }

    /// Two velocities tell a muscle that waits that it goes on to wait.
    #[test]
    fn a_slow_stretch_is_passed_over_before_anything_is_located() {
        let f = Counted::from_f64;
        for muscles in [0, 1] {
            let settings = SpasticitySettings {
                muscles,
                ..SpasticitySettings::default()
            };
            let coefficients = Spasticity::<Counted>::coefficients(&settings, &TIMING).unwrap();
            let mut law = <Spasticity<Counted> as Law>::new(coefficients);
            // 40 deg/s are 0.7 rad/s.
            let mut cost = |rad_s: f64| {
                let shaft = ShaftStep {
                    delta_phi_rad: f(rad_s * TIMING.step_s),
                    omega_start_rad_s: f(rad_s),
                    omega_end_rad_s: f(rad_s),
                };
                let to = Sensing::IDEAL.position(1.0);
                let scale = Scale::new(&Sensing::IDEAL, TIMING.step_s);
                let travel = Travel::of(&Checked::Step(shaft), &to, &scale).unwrap();
                operations(|| law.follow(&travel, &mut ())).1.all()
            };
            // The torque, which is none, has a sign, too.
            for rad_s in [-0.5, 0.0, 0.5] {
                let done = cost(rad_s);
                assert!(done <= 4, "{rad_s} rad/s: {done}");
            }
        }
    }
}
