//! What a joint is driven with in a trial: the exact input, as data.

use super::text::{Plain, Time};
use crepitus_model::parameters::PARAMETERS;
use crepitus_model::{Parameters, Settings};
use crepitus_plant::Motion;
use crepitus_plant::motion::VelocityKnot;
use std::fmt;

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
}

/// What a joint is driven with.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Input {
    /// A motion cut into steps; the true events are known.
    Sampled {
        /// The motion.
        shaft: Shaft,
        /// How long, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// The same step again and again, for runs too long to cut up.
    Repeated {
        /// Ω, rad/s.
        omega_rad_s: f64,
        /// How long, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A motion seen through the encoder at the motor and the estimator that
    /// ships.
    Encoder {
        /// The motion.
        shaft: Shaft,
        /// How long, s.
        duration_s: f64,
        /// How often the counter is read, Hz.
        rate_hz: f64,
        /// Lines of the encoder's disc.
        lines: f64,
        /// How far a reading is early or late at most, in periods.
        jitter: f64,
        /// The share of readings that are lost.
        lost: f64,
        /// Counter at the start; it wraps as a 32-bit timer does.
        first_count: i32,
    },
    /// Velocities without memory: every step ends at a random one, and every
    /// fourth begins with a jump to one.
    White {
        /// The largest speed, rad/s.
        most_rad_s: f64,
        /// Seed of the random numbers.
        seed: u64,
        /// How long, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A hand of inertia I with damping b on the joint, which it turns and
    /// whose torque it gets, held over each step: I·Ω̇ = −T − b·Ω.
    Hand {
        /// I, kg·m².
        inertia_kg_m2: f64,
        /// b, N·m·s/rad.
        damping_nms_per_rad: f64,
        /// Velocity at the start, rad/s.
        omega_rad_s: f64,
        /// How long, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A motion that is not always seen as it is.
    Faulty {
        /// The motion.
        shaft: Shaft,
        /// What goes wrong.
        fault: Fault,
        /// How long, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A frozen joint whose parameters change under way, ramped as the device
    /// does it.
    Changed {
        /// The motion.
        shaft: Shaft,
        /// When, and to what.
        changes: Vec<Change>,
        /// How long, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// A hand that shakes a joint as the device renders it.
    Shaken {
        /// How.
        shake: Shake,
        /// How long, s.
        duration_s: f64,
        /// The step, s.
        step_s: f64,
    },
    /// Settings and steps that must be refused.
    Refusals(Vec<Attempt>),
}

/// What goes wrong with samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Every so many samples one is no number, infinite, or what no shaft can
    /// do: each kind in turn.
    Impossible {
        /// Steps from one to the next.
        every: u64,
    },
    /// None is a number from this time on.
    Blind {
        /// Since the start, s.
        from_s: f64,
    },
    /// None is taken between two times.
    Gap {
        /// From, s.
        from_s: f64,
        /// To, s.
        to_s: f64,
    },
}

/// New parameters at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// When, s.
    pub at_s: f64,
    /// To what.
    pub parameters: Parameters,
}

/// φ = A·sin(2π·f·t), by a hand that feels the torque late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shake {
    /// A, rad.
    pub amplitude_rad: f64,
    /// f, Hz.
    pub frequency_hz: f64,
    /// Ticks between a sample and its torque.
    pub delay_ticks: usize,
    /// Whether the joint sees counts of the device's encoder, or the truth.
    pub counts: bool,
}

/// Something to be refused.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// What is wrong with it.
    pub what: &'static str,
    /// The settings.
    pub settings: Settings,
    /// The step, s.
    pub step_s: f64,
}

impl Shake {
    /// The motion of the hand.
    pub fn motion(&self) -> Motion {
        Motion::sine(self.amplitude_rad, self.frequency_hz, 0.0)
    }
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
        }
    }
}

impl Input {
    /// Duration and step, s; `None` where nothing runs.
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
            | Self::Changed {
                duration_s, step_s, ..
            }
            | Self::Shaken {
                duration_s, step_s, ..
            } => Some((duration_s, step_s)),
            Self::Encoder {
                duration_s,
                rate_hz,
                ..
            } => Some((duration_s, 1.0 / rate_hz)),
            Self::Refusals(_) => None,
        }
    }

    /// Whether the joint needs the check of its input that the device has.
    pub(super) fn needs_guard(&self) -> bool {
        match self {
            Self::Faulty { .. } => true,
            Self::Encoder { lost, .. } => *lost > 0.0,
            _ => false,
        }
    }

    /// Steps of a run; 0 where nothing runs.
    pub fn steps(&self) -> f64 {
        self.duration_and_step_s()
            .map_or(0.0, |(duration_s, step_s)| (duration_s / step_s).round())
    }
}

impl fmt::Display for Shaft {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(omega) => write!(f, "Ω = {} rad/s", Plain(*omega)),
            Self::Sine {
                amplitude_rad,
                frequency_hz,
                phase_deg,
            } => {
                write!(
                    f,
                    "φ = {} rad · sin(2π · {} Hz · t",
                    Plain(*amplitude_rad),
                    Plain(*frequency_hz)
                )?;
                if *phase_deg == 0.0 {
                    f.write_str(")")
                } else {
                    write!(f, " {phase_deg:+}°)")
                }
            }
            Self::Knots(knots) => {
                f.write_str("Ω linear between (t s: Ω rad/s)")?;
                for (i, &(time_s, left, right)) in knots.iter().enumerate() {
                    let comma = if i == 0 { "" } else { "," };
                    write!(f, "{comma} {}: {}", Plain(time_s), Plain(left))?;
                    if left != right {
                        write!(f, "|{}", Plain(right))?;
                    }
                }
                Ok(())
            }
        }
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sampled { shaft, .. } => write!(f, "{shaft}")?,
            Self::Repeated { omega_rad_s, .. } => {
                write!(
                    f,
                    "one and the same step of Ω = {} rad/s",
                    Plain(*omega_rad_s)
                )?;
            }
            Self::Encoder {
                shaft,
                lines,
                rate_hz,
                jitter,
                lost,
                first_count,
                ..
            } => {
                write!(f, "{shaft}, encoder of {lines} lines read at {rate_hz} Hz")?;
                if *jitter > 0.0 {
                    write!(f, " ± {} % of a period", Plain(100.0 * jitter))?;
                }
                if *lost > 0.0 {
                    write!(f, ", {} % of the readings lost", Plain(100.0 * lost))?;
                }
                if *first_count != 0 {
                    write!(f, ", counter from {first_count}")?;
                }
            }
            Self::White {
                most_rad_s, seed, ..
            } => write!(
                f,
                "white velocity within ±{} rad/s, every fourth step a jump (seed {seed})",
                Plain(*most_rad_s)
            )?,
            Self::Hand {
                inertia_kg_m2,
                damping_nms_per_rad,
                omega_rad_s,
                ..
            } => write!(
                f,
                "a hand of {} kg·m² and {} N·m·s/rad that starts with {} rad/s, moved by the torque shown",
                Plain(*inertia_kg_m2),
                Plain(*damping_nms_per_rad),
                Plain(*omega_rad_s)
            )?,
            Self::Faulty { shaft, fault, .. } => write!(f, "{shaft}, {fault}")?,
            Self::Changed { shaft, changes, .. } => {
                write!(f, "{shaft}")?;
                for change in changes {
                    write!(f, ", {change}")?;
                }
            }
            Self::Shaken { shake, .. } => write!(f, "{shake}")?,
            Self::Refusals(attempts) => {
                for (i, attempt) in attempts.iter().enumerate() {
                    let comma = if i == 0 { "" } else { ", " };
                    write!(f, "{comma}{}", attempt.what)?;
                }
            }
        }
        match self.duration_and_step_s() {
            Some((duration_s, step_s)) => {
                write!(f, ", {} in steps of {}", Time(duration_s), Time(step_s))
            }
            None => Ok(()),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Impossible { every } => write!(
                f,
                "every {every}th sample no number, infinite, 1 rad or 60 rad/s off, in turn"
            ),
            Self::Blind { from_s } => write!(f, "no number from {} on", Time(from_s)),
            Self::Gap { from_s, to_s } => {
                write!(f, "no sample from {} to {}", Time(from_s), Time(to_s))
            }
        }
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at {}", Time(self.at_s))?;
        let (old, new) = (Parameters::default(), &self.parameters);
        for ((spec, value), paper) in PARAMETERS.iter().zip(new.values()).zip(old.values()) {
            if value != paper {
                write!(f, " {} = {} {}", spec.symbol, Plain(value), spec.unit)?;
            }
        }
        if *new == old {
            f.write_str(" the paper's")?;
        }
        Ok(())
    }
}

impl fmt::Display for Shake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "φ = {} rad · sin(2π · {} Hz · t), the torque {} ticks late, seen {}",
            Plain(self.amplitude_rad),
            Plain(self.frequency_hz),
            self.delay_ticks,
            if self.counts {
                "through the encoder"
            } else {
                "as it is"
            }
        )
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
}
