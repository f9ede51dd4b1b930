//! Descriptions of inputs, generated from their numbers.

use super::{Change, Fault, Input, Lost, Rendered, Shaft, Shake};
use crate::stability::text::{Plain, Time};
use crepitus_model::Parameters;
use crepitus_model::parameters::Tabled;
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
            Self::Strokes(strokes) => write!(
                f,
                "minimum-jerk strokes from {} to {} rad at {} rad/s with a pause of {}",
                Plain(strokes.from_rad),
                Plain(strokes.to_rad),
                Plain(strokes.peak_speed_rad_s),
                Time(strokes.pause_s)
            ),
            Self::Rows {
                rows,
                sign,
                cutoff_hz,
            } => {
                write!(f, "recording smoothed at {cutoff_hz} Hz (t s: rad)")?;
                for (i, (time_s, angle_rad)) in rows.iter().enumerate() {
                    let comma = if i == 0 { "" } else { "," };
                    write!(f, "{comma} {}: {}", Plain(*time_s), Plain(sign * angle_rad))?;
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
            Self::ParameterChanges { shaft, changes, .. } => {
                write!(f, "{shaft}")?;
                for change in changes {
                    write!(f, ", {change}")?;
                }
            }
            Self::ShakingHand { shake, .. } => write!(f, "{shake}")?,
            Self::Rendered(rendered) => write!(f, "{rendered}")?,
            Self::Symptoms(run) => write!(f, "{run}")?,
            Self::Scene(run) => write!(f, "{run}")?,
            Self::Actuator(run) => write!(f, "{run}")?,
            Self::ActuatorLoop(linear) => write!(f, "{linear}")?,
            Self::SymptomRefusals(attempts) => {
                for (i, attempt) in attempts.iter().enumerate() {
                    let comma = if i == 0 { "" } else { ", " };
                    write!(f, "{comma}{}", attempt.what)?;
                }
            }
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
                "every {every}th sample NaN, infinite, 1 rad or 60 rad/s off, in turn"
            ),
            Self::Blind { from_s } => write!(f, "NaN from {} on", Time(from_s)),
            Self::Gap { from_s, to_s } => {
                write!(f, "no sample from {} to {}", Time(from_s), Time(to_s))
            }
            Self::Retreating => f.write_str("no sample while the shaft moves backwards"),
            Self::Jumps { every } => {
                write!(f, "every {every}th sample ends 20 rad/s too fast")
            }
        }
    }
}

impl fmt::Display for Rendered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            shaft,
            counts,
            lost,
            ..
        } = self;
        write!(f, "{shaft}, rendered as on the device")?;
        if *counts {
            f.write_str(", seen through the encoder")?;
        }
        if lost.ticks > 0 {
            write!(f, ", {} samples in a row lost", lost.ticks)?;
            if lost.every > 0 {
                write!(f, " of every {}", lost.every)?;
            }
            if lost.from_s > 0.0 {
                write!(f, " from {} on", Time(lost.from_s))?;
            }
        }
        if self.commit_every > 0 {
            let ticks = match self.commit_every {
                1 => "every tick".to_owned(),
                n => format!("every {n} ticks"),
            };
            write!(f, ", a commit {ticks}, in turn")?;
            for (i, parameters) in self.commits.iter().enumerate() {
                let comma = if i == 0 { "" } else { "," };
                write!(f, "{comma}{}", Named(parameters))?;
            }
        }
        Ok(())
    }
}

/// Description of parameters, where they differ from the paper's.
struct Named<'a>(&'a Parameters);

impl fmt::Display for Named<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (old, new) = (Parameters::default(), self.0);
        for ((spec, value), paper) in Parameters::TABLE.iter().zip(new.values()).zip(old.values()) {
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

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at {}{}", Time(self.at_s), Named(&self.parameters))
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
        )?;
        let Lost {
            ticks,
            every,
            from_s,
        } = self.lost;
        if ticks > 0 {
            write!(
                f,
                "; {ticks} of every {every} samples are lost, from t = {} s on",
                Plain(from_s)
            )?;
        }
        Ok(())
    }
}
