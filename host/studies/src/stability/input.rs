//! The exact input of a joint in a trial, as data.

mod actuator;
mod device;
mod scene;
mod symptom;
mod words;

pub use actuator::{ActuatorLoop, ActuatorRun, Upset};
pub use device::{Attempt, Change, Fault, Lost, Rendered, Shake};
pub use scene::SceneRun;
pub use symptom::{RefusedSymptoms, SymptomRun};

use crepitus_plant::Motion;
use crepitus_plant::motion::{Strokes, VelocityKnot};
use crepitus_plant::recording::{Samples, smooth};

/// A prescribed motion of the shaft.
#[derive(Clone, Debug, PartialEq)]
pub enum Shaft {
    /// φ = Ω·t, Ω in rad/s.
    Constant(f64),
    /// φ = A·sin(2π·f·t + phase).
    Sine {
        /// A, rad.
        amplitude_rad: f64,
        /// f, Hz.
        frequency_hz: f64,
        /// Phase at the start, degrees.
        phase_deg: f64,
    },
    /// Velocity linear between knots: time s, Ω just before and just after it,
    /// rad/s.
    Knots(&'static [(f64, f64, f64)]),
    /// Minimum-jerk strokes there and back, with a pause after each.
    Strokes(Strokes),
    /// A recording: time s and angle rad of each row, smoothed.
    Rows {
        /// The rows.
        rows: &'static [(f64, f64)],
        /// Sign of the angles, 1 or −1.
        sign: f64,
        /// Cutoff of the low-pass, Hz.
        cutoff_hz: f64,
    },
}

/// The input of a joint.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Input {
    /// A motion cut into steps; the true events are known.
    Sampled {
        /// The motion.
        shaft: Shaft,
        /// Duration, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// One step repeated, for runs too long to cut into steps.
    Repeated {
        /// Ω, rad/s.
        omega_rad_s: f64,
        /// Duration, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A motion measured by the encoder at the motor and the estimator that
    /// ships.
    Encoder {
        /// The motion.
        shaft: Shaft,
        /// Duration, s.
        duration_s: f64,
        /// Rate of reading the counter, Hz.
        rate_hz: f64,
        /// Lines of the encoder's disc.
        lines: f64,
        /// Largest jitter of a reading, in periods.
        jitter: f64,
        /// The share of lost readings.
        lost: f64,
        /// Counter at the start; it wraps as a 32-bit timer does.
        first_count: i32,
    },
    /// White velocities: every step ends at a random one, and every fourth
    /// begins with a jump to one.
    White {
        /// The largest speed, rad/s.
        most_rad_s: f64,
        /// Seed of the random numbers.
        seed: u64,
        /// Duration, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A hand of inertia I with damping b that turns the joint against its
    /// torque, held over each step: I·Ω̇ = −T − b·Ω.
    Hand {
        /// I, kg·m².
        inertia_kg_m2: f64,
        /// b, N·m·s/rad.
        damping_nms_per_rad: f64,
        /// Velocity at the start, rad/s.
        omega_rad_s: f64,
        /// Duration, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A motion with faulty samples.
    Faulty {
        /// The motion.
        shaft: Shaft,
        /// The fault.
        fault: Fault,
        /// Duration, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A frozen joint whose parameters change during the run, ramped as in the
    /// device.
    ParameterChanges {
        /// The motion.
        shaft: Shaft,
        /// The changes.
        changes: Vec<Change>,
        /// Duration, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A hand that shakes a joint as the device renders it.
    ShakingHand {
        /// The shaking motion.
        shake: Shake,
        /// Duration, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A frozen joint as the device renders it, with lost samples and commits.
    Rendered(Rendered),
    /// Symptoms besides crepitus, as the device renders them.
    Symptoms(SymptomRun),
    /// A scene.
    Scene(SceneRun),
    /// A device with the vibration actuator, on a leg in a hand.
    Actuator(ActuatorRun),
    /// The loop from the vibration actuator to the encoder and back, linear.
    ActuatorLoop(ActuatorLoop),
    /// Settings and steps that must be refused.
    Refusals(Vec<Attempt>),
    /// Symptoms that must be refused.
    SymptomRefusals(Vec<RefusedSymptoms>),
}

impl Shaft {
    /// The motion itself.
    pub fn motion(&self) -> Motion {
        match self {
            Self::Constant(omega_rad_s) => Motion::constant(*omega_rad_s),
            Self::Sine {
                amplitude_rad,
                frequency_hz,
                phase_deg,
            } => Motion::sine(*amplitude_rad, *frequency_hz, *phase_deg),
            Self::Knots(knots) => {
                let knots: Vec<_> = knots
                    .iter()
                    .map(
                        |&(time_s, omega_left_rad_s, omega_right_rad_s)| VelocityKnot {
                            time_s,
                            omega_left_rad_s,
                            omega_right_rad_s,
                        },
                    )
                    .collect();
                Motion::velocity_knots(&knots)
            }
            Self::Strokes(strokes) => Motion::Strokes(*strokes),
            Self::Rows {
                rows,
                sign,
                cutoff_hz,
            } => {
                let samples = Samples {
                    time_s: rows.iter().map(|row| row.0).collect(),
                    angle_rad: rows.iter().map(|row| sign * row.1).collect(),
                    ..Samples::default()
                };
                // The catalogue's rows can be smoothed; a test says so.
                smooth(&samples, *cutoff_hz)
                    .map_or_else(|_| Motion::rest(0.0), |pieces| Motion::recording(&pieces))
            }
        }
    }
}

impl Input {
    /// Duration and step, s; `None` if nothing runs.
    pub fn duration_and_step_s(&self) -> Option<(f64, f64)> {
        match *self {
            Self::Sampled {
                duration_s, step_s, ..
            }
            | Self::Repeated {
                duration_s, step_s, ..
            }
            | Self::White {
                duration_s, step_s, ..
            }
            | Self::Hand {
                duration_s, step_s, ..
            }
            | Self::Faulty {
                duration_s, step_s, ..
            }
            | Self::ParameterChanges {
                duration_s, step_s, ..
            }
            | Self::ShakingHand {
                duration_s, step_s, ..
            }
            | Self::Rendered(Rendered {
                duration_s, step_s, ..
            })
            | Self::Symptoms(SymptomRun {
                duration_s, step_s, ..
            })
            | Self::Scene(SceneRun {
                duration_s, step_s, ..
            })
            | Self::Actuator(ActuatorRun {
                duration_s, step_s, ..
            }) => Some((duration_s, step_s)),
            Self::Encoder {
                duration_s,
                rate_hz,
                ..
            } => Some((duration_s, 1.0 / rate_hz)),
            Self::ActuatorLoop(_) | Self::Refusals(_) | Self::SymptomRefusals(_) => None,
        }
    }

    /// Returns whether it applies to the reference, which takes no samples.
    pub(super) fn suits_the_reference(&self) -> bool {
        match self {
            Self::Sampled { .. } => true,
            Self::Symptoms(run) => run.suits_the_reference(),
            Self::Scene(run) => run.is_compared,
            _ => false,
        }
    }

    /// Returns whether the joint needs the check of its input that the device has.
    pub(super) fn needs_guard(&self) -> bool {
        match self {
            Self::Faulty { .. } => true,
            Self::Encoder { lost, .. } => *lost > 0.0,
            _ => false,
        }
    }

    /// Returns whether each step is that of the motion to f64 precision: without an
    /// encoder and without catching up.
    pub(super) fn is_exact(&self) -> bool {
        !matches!(self, Self::Encoder { .. } | Self::Faulty { .. })
    }

    /// Steps of a run; 0 if nothing runs.
    pub fn steps(&self) -> f64 {
        self.duration_and_step_s()
            .map_or(0.0, |(duration_s, step_s)| (duration_s / step_s).round())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_holds_every_number() {
        let input = Input::Sampled {
            shaft: Shaft::Knots(&[(0.0, 1.0, 1.0), (0.5, 1.0, -0.25)]),
            duration_s: 2.0,
            step_s: 5e-5,
        };
        assert_eq!(
            input.to_string(),
            "Ω linear between (t s: Ω rad/s) 0: 1, 0.5: 1|-0.25, 2 s in steps of 50 µs"
        );
        assert_eq!(input.steps(), 40_000.0);
        let sine = Shaft::Sine {
            amplitude_rad: 0.003,
            frequency_hz: 1.0,
            phase_deg: -90.0,
        };
        assert_eq!(sine.to_string(), "φ = 0.003 rad · sin(2π · 1 Hz · t -90°)");
    }

    #[test]
    fn the_rows_of_the_catalogue_can_be_smoothed() {
        let mut seen = 0;
        for case in crate::stability::catalogue::all() {
            for trial in crate::stability::Subject::all()
                .into_iter()
                .flat_map(case.trials)
            {
                if let Input::Sampled {
                    shaft: shaft @ Shaft::Rows { .. },
                    duration_s,
                    ..
                } = &trial.input
                {
                    let motion = shaft.motion();
                    assert!(motion.at(0.5 * duration_s).phi_rad.abs() > 0.1);
                    assert!(motion.piece(*duration_s).end_s > *duration_s);
                    seen += 1;
                }
            }
        }
        assert!(seen > 0);
    }

    #[test]
    fn bursts_begin_and_repeat_on_time() {
        let lost = |every, from_s| Lost {
            ticks: 2,
            every,
            from_s,
        };
        let taken = |lost: Lost| {
            (1..=9)
                .filter(|n| lost.takes(*n, 1.0))
                .collect::<Vec<u64>>()
        };
        assert_eq!(taken(lost(4, 0.0)), [1, 2, 5, 6, 9]);
        assert_eq!(taken(lost(0, 3.0)), [4, 5]);
        assert!(taken(Lost::NONE).is_empty());
    }
}
