//! Settings of the joint, and their validation.

use crate::joint::Parameters;
use crate::parameters::{OutOfRange, ParameterSpec, Tabled};
use core::fmt;

/// The longest step, s.
pub const LONGEST_STEP_S: f64 = 1.0;

/// The stiffest that everything together may be where all is elastic, N·m/rad:
/// dry friction of 0.1 N·m keeps a rotor with as much quiet.
pub const MOST_STIFFNESS_NM_PER_RAD: f64 = 1200.0;

crate::named! {
    /// Convention for the end of a slip. The paper admits three readings; the book's model page
    /// compares them.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Convention {
        /// Eqs. (10)–(11) to the letter: the slip lasts the closed-form time for
        /// the shaft speed at the break, whatever the shaft does meanwhile. Robust
        /// to velocity noise, and the grating goes on while the hand accelerates.
        #[default]
        Frozen => "frozen",
        /// Eqs. (7)–(8): the stick torque is kr·θ, a slip ends when θ̇ = Ω(t).
        Paper => "paper",
        /// `Paper` with the object's inertia and damping in the stick torque
        /// (kr·θ + J·Ω̇ + c·Ω): conserves energy to rounding.
        Physical => "physical",
    }
}

crate::named! {
    /// The torque with which a stick begins after a slip.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Restart {
        /// Eq. (1): the spring's torque at that angle, 2Tk − Ts.
        #[default]
        Elastic => "elastic",
        /// The paper's prose, "T changes between Tk and Ts": the stick starts at
        /// Tk. `Frozen` only.
        FromKinetic => "from-kinetic",
    }
}

/// Settings of the stick-slip object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// The numbers.
    pub parameters: Parameters,
    /// Convention for the end of a slip.
    pub convention: Convention,
    /// Torque with which a stick begins after a slip.
    pub restart: Restart,
}

/// A validated value; only this crate can construct one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Validated<T>(T);

impl<T> core::ops::Deref for Validated<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

/// Errors of settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SettingsError {
    /// A number is outside its range, or not a number at all.
    OutOfRange {
        /// The parameter, with its range.
        parameter: &'static ParameterSpec,
        /// The rejected value.
        value: f64,
    },
    /// Tk > Ts: a stick would break below the torque that slip shows.
    KineticAboveStatic {
        /// Tk, N·m.
        kinetic_nm: f64,
        /// Ts, N·m.
        static_nm: f64,
    },
    /// `Frozen` with c > 0: its closed form has no damping.
    FrozenWithDamping {
        /// c, N·m·s/rad.
        damping_nms_per_rad: f64,
    },
    /// `FromKinetic` needs `Frozen`: the others continue the spring's angle.
    RestartNeedsFrozen {
        /// The requested convention.
        convention: Convention,
    },
    /// The rung of the ladder has no meaning under the convention.
    Solver {
        /// Name of the rung.
        solver: &'static str,
        /// Reason.
        reason: &'static str,
    },
    /// Settings that exclude each other.
    Contradiction {
        /// Rule that holds between them, with their names.
        reason: &'static str,
    },
    /// The springs of all symptoms together are too stiff.
    TooStiff {
        /// Their sum, N·m/rad.
        sum_nm_per_rad: f64,
    },
    /// The step is not a positive, finite time.
    Step {
        /// The requested step, s.
        step_s: f64,
    },
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OutOfRange { parameter, value } => write!(
                f,
                "{} = {value} is not allowed: {} must be between {:e} and {:e} {}",
                parameter.key, parameter.symbol, parameter.min, parameter.max, parameter.unit
            ),
            Self::KineticAboveStatic {
                kinetic_nm,
                static_nm,
            } => write!(
                f,
                "kinetic_torque_nm = {kinetic_nm} is above static_torque_nm = {static_nm}: Tk ≤ Ts is required"
            ),
            Self::FrozenWithDamping {
                damping_nms_per_rad,
            } => write!(
                f,
                "damping_nms_per_rad = {damping_nms_per_rad} has no meaning under convention \"frozen\", whose \
                 slip time is a closed form without damping: use 0, or \"paper\" or \"physical\""
            ),
            Self::RestartNeedsFrozen { convention } => write!(
                f,
                "restart \"from-kinetic\" needs convention \"frozen\"; under \"{}\" the stick goes on from the \
                 angle that the object has",
                convention.name()
            ),
            Self::Solver { solver, reason } => {
                write!(f, "solver \"{solver}\" is refused: {reason}")
            }
            Self::Contradiction { reason } => f.write_str(reason),
            Self::TooStiff { sum_nm_per_rad } => write!(
                f,
                "what can be elastic at once has {sum_nm_per_rad:.0} N·m/rad together, and a sampled joint stays \
                 quiet with {MOST_STIFFNESS_NM_PER_RAD} at most: make the joint, the wall, the texture or another \
                 symptom softer"
            ),
            Self::Step { step_s } => {
                write!(
                    f,
                    "a step of {step_s} s is not allowed: it must be above 0 and at most {LONGEST_STEP_S} s"
                )
            }
        }
    }
}

impl core::error::Error for SettingsError {}

impl From<OutOfRange> for SettingsError {
    fn from(OutOfRange { parameter, value }: OutOfRange) -> Self {
        Self::OutOfRange { parameter, value }
    }
}

impl Settings {
    /// Validates ranges and combinations.
    ///
    /// # Errors
    /// The first rule that is broken, as [`SettingsError`].
    pub fn validate(self) -> Result<Validated<Self>, SettingsError> {
        let p = &self.parameters;
        p.validate()?;
        if p.kinetic_torque_nm > p.static_torque_nm {
            return Err(SettingsError::KineticAboveStatic {
                kinetic_nm: p.kinetic_torque_nm,
                static_nm: p.static_torque_nm,
            });
        }
        if self.convention == Convention::Frozen && p.damping_nms_per_rad > 0.0 {
            return Err(SettingsError::FrozenWithDamping {
                damping_nms_per_rad: p.damping_nms_per_rad,
            });
        }
        if self.restart == Restart::FromKinetic && self.convention != Convention::Frozen {
            return Err(SettingsError::RestartNeedsFrozen {
                convention: self.convention,
            });
        }
        Ok(Validated(self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::mem::discriminant;

    fn refused(change: impl Fn(&mut Settings)) -> SettingsError {
        let mut settings = Settings::default();
        change(&mut settings);
        settings.validate().expect_err("must be refused")
    }

    #[test]
    fn the_papers_numbers_are_valid() {
        assert!(Settings::default().validate().is_ok());
    }

    #[test]
    fn every_number_is_held_to_its_range() {
        for (i, spec) in Parameters::TABLE.iter().enumerate() {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e300] {
                let error = refused(|s| {
                    for (j, v) in s.parameters.values_mut().into_iter().enumerate() {
                        if i == j {
                            *v = bad;
                        }
                    }
                });
                assert!(
                    matches!(error, SettingsError::OutOfRange { parameter, .. } if parameter.key == spec.key),
                    "{error}"
                );
            }
        }
        for zero in [0, 1] {
            let error = refused(|s| *s.parameters.values_mut()[zero] = 0.0);
            assert!(matches!(error, SettingsError::OutOfRange { .. }));
        }
    }

    #[test]
    fn numbers_are_held_against_each_other() {
        let cases = [
            (
                refused(|s| s.parameters.kinetic_torque_nm = 0.5),
                SettingsError::KineticAboveStatic {
                    kinetic_nm: 0.0,
                    static_nm: 0.0,
                },
            ),
            (
                refused(|s| s.parameters.damping_nms_per_rad = 1e-3),
                SettingsError::FrozenWithDamping {
                    damping_nms_per_rad: 0.0,
                },
            ),
            (
                refused(|s| {
                    s.convention = Convention::Paper;
                    s.restart = Restart::FromKinetic;
                }),
                SettingsError::RestartNeedsFrozen {
                    convention: Convention::Paper,
                },
            ),
        ];
        for (got, expected) in cases {
            assert_eq!(discriminant(&got), discriminant(&expected), "{got}");
        }
    }

    #[test]
    fn an_error_gives_the_cause_and_the_valid_values() {
        use std::string::ToString;
        for (error, parts) in [
            (
                refused(|s| s.parameters.inertia_kg_m2 = -1.0),
                ["inertia_kg_m2 = -1", "between 1e-12 and 1e3 kg·m²"],
            ),
            (
                refused(|s| s.parameters.kinetic_torque_nm = 0.5),
                ["kinetic_torque_nm = 0.5", "Tk ≤ Ts"],
            ),
            (
                refused(|s| s.parameters.damping_nms_per_rad = 1e-3),
                ["damping_nms_per_rad = 0.001", "\"physical\""],
            ),
            (
                SettingsError::Step { step_s: 2.0 },
                ["a step of 2 s", "at most 1 s"],
            ),
            (
                SettingsError::Solver {
                    solver: "rk4",
                    reason: "because",
                },
                ["\"rk4\"", "because"],
            ),
        ] {
            let text = error.to_string();
            assert!(parts.iter().all(|part| text.contains(part)), "{text}");
        }
    }

    #[test]
    fn names_are_those_of_the_files() {
        assert_eq!(
            Convention::ALL.map(Convention::name),
            ["frozen", "paper", "physical"]
        );
        assert_eq!(Restart::ALL.map(Restart::name), ["elastic", "from-kinetic"]);
    }
}
