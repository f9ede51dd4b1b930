//! Inputs as people read them: text and number stand once.

use super::{Change, Fault, Input, Shaft, Shake};
use crate::stability::text::{Plain, Time};
use crepitus_model::Parameters;
use crepitus_model::parameters::PARAMETERS;
use std::fmt;

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
