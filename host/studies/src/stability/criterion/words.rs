//! Descriptions of criteria, generated from their numbers.

use super::{Counted, Criterion, Limits};
use crate::stability::parameter_changes::SLEW_NM_PER_S;
use crate::stability::text::{Plain, Time};
use std::fmt;

/// Limits with a unit, in words.
pub(super) struct Number<'a>(pub(super) &'a Limits, pub(super) &'static str);

impl fmt::Display for Number<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(limits, unit) = self;
        let space = if unit.is_empty() { "" } else { " " };
        let one = |x: f64| format!("{}{space}{unit}", Plain(x));
        if limits.f64 == limits.f32 {
            f.write_str(&one(limits.f64))
        } else {
            write!(f, "{} (f64), {} (f32)", one(limits.f64), one(limits.f32))
        }
    }
}

impl fmt::Display for Criterion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Survives => f.write_str("finite, |T| ≤ Ts"),
            Self::Events { within_s } => write!(
                f,
                "same events as the reference, each within {}",
                Number(within_s, "s")
            ),
            Self::EventTorques { within_nm } => write!(
                f,
                "torque after each event that of the reference within {}",
                Number(within_nm, "N·m")
            ),
            Self::Count { what, least, most } => {
                let what = match what {
                    Counted::Events => "events",
                    Counted::Breaks => "breaks",
                    Counted::Reverses => "reverses",
                };
                if least == most {
                    write!(f, "{most} {what}")
                } else {
                    write!(f, "{least} to {most} {what}")
                }
            }
            Self::EventsPerStep { most } => write!(f, "at most {most} events in a step"),
            Self::EventsPerSecond { most } => {
                write!(f, "at most {} events per second", Plain(*most))
            }
            Self::CycleRate { hz, within } => {
                write!(
                    f,
                    "{hz:.6} cycles per second within {} of it",
                    Number(within, "")
                )
            }
            Self::IntervalVariation { most } => write!(
                f,
                "standard deviation from break to break at most {} of its mean",
                Plain(*most)
            ),
            Self::SlipTime { slip_s, within } => write!(
                f,
                "every slip lasts {:.6} ms within {} of it",
                slip_s * 1e3,
                Number(within, "")
            ),
            Self::SilentAfter { time_s } => write!(f, "no event after {}", Time(*time_s)),
            Self::TorqueWithin {
                from_s,
                low_nm,
                high_nm,
                slack_nm,
            } => {
                write!(
                    f,
                    "torque in [{}, {}] ± {} N·m",
                    Plain(*low_nm),
                    Plain(*high_nm),
                    Plain(*slack_nm)
                )?;
                if *from_s > 0.0 {
                    write!(f, " from {} on", Time(*from_s))
                } else {
                    Ok(())
                }
            }
            Self::TorqueStays { from_s } => {
                write!(f, "torque the same to the bit from {} on", Time(*from_s))
            }
            Self::TorqueReturns { within_nm } => write!(
                f,
                "the last torque is the first within {}",
                Number(within_nm, "N·m")
            ),
            Self::LoopArea { most_j } => {
                write!(f, "work over whole cycles at most {}", Number(most_j, "J"))
            }
            Self::NoBreakAtRest => f.write_str("no break while the shaft is at rest"),
            Self::SlipsWithShaft { within_rad_s } => write!(
                f,
                "in a slip the shaft leads the object, or lags by at most {}",
                Number(within_rad_s, "rad/s")
            ),
            Self::MirrorOf(input) => write!(f, "−T of \"{input}\", bit for bit"),
            Self::SameAs(input) => write!(f, "T of \"{input}\", bit for bit"),
            Self::TorqueBits(hash) => write!(f, "torque bits with hash {hash:#018x}"),
            Self::SwingRatio { theory, within } => write!(
                f,
                "largest swing of the last half second {theory:.4} of that of the first, within {} of it",
                Plain(*within)
            ),
            Self::Subnormals { most } => {
                write!(f, "at most {most} steps end with a subnormal velocity")
            }
            Self::Refused => f.write_str("all refused with a reason, none panics"),
            other => of_a_device(other, f),
        }
    }
}

/// Criteria of a joint in a device.
fn of_a_device(criterion: &Criterion, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match criterion {
        Criterion::TorqueStep { most_nm } => write!(
            f,
            "torque moves by at most {} N·m from one step to the next",
            Plain(*most_nm)
        ),
        Criterion::EnergyRise { most } => write!(
            f,
            "no adjustment raises the stored energy by more than {} of it",
            Number(most, "")
        ),
        Criterion::Slew { beyond } => write!(
            f,
            "between events no torque faster than {} N·m/s by more than {} of it",
            Plain(SLEW_NM_PER_S),
            Number(beyond, "")
        ),
        Criterion::FirstBreakAfter {
            from_s,
            at_s,
            within_s,
        } => write!(
            f,
            "the first event after {} is a break at {} within {}",
            Time(*from_s),
            Time(*at_s),
            Number(within_s, "s")
        ),
        Criterion::SlipEnergy { most } => write!(
            f,
            "no slip ends with more energy in the spring than at its break, by more than {} of it",
            Number(most, "")
        ),
        Criterion::GuardTicks { least, most } if least == most => {
            write!(
                f,
                "the turn-back guard switches the torque off for {most} ticks"
            )
        }
        Criterion::GuardTicks { least, most } => write!(
            f,
            "the turn-back guard switches the torque off for {least} to {most} ticks"
        ),
        Criterion::Returned { most } => write!(
            f,
            "the hand gets back at most {most:.4} Ts²/2kr + (½ + d) kr h ∫Ω² dt"
        ),
        other => of_symptoms(other, f),
    }
}

/// Criteria of symptoms besides crepitus.
fn of_symptoms(criterion: &Criterion, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match criterion {
        Criterion::TorqueQuiet { from_s, most_nm } => write!(
            f,
            "torque moves by at most {} N·m from {} on",
            Plain(*most_nm),
            Time(*from_s)
        ),
        Criterion::SymptomEvents { within_s } => write!(
            f,
            "same events as the symptom's reference, each within {}",
            Number(within_s, "s")
        ),
        Criterion::SymptomTorques { within_nm } => write!(
            f,
            "torque at the ends of steps that of the symptom's reference within {}",
            Number(within_nm, "N·m")
        ),
        Criterion::Words([]) => f.write_str("no event"),
        Criterion::Words(words) => {
            let names: Vec<_> = words.iter().map(|word| word.name()).collect();
            write!(f, "events in their order: {}", names.join(", "))
        }
        Criterion::FirstWord {
            word,
            at_s,
            within_s,
        } => write!(
            f,
            "the first {} at {} within {}",
            word.name(),
            Time(*at_s),
            Number(within_s, "s")
        ),
        Criterion::WordCount { word, least, most } if least == most => {
            write!(f, "{} happens {most} times", word.name())
        }
        Criterion::WordCount { word, least, most } => {
            write!(f, "{} happens {least} to {most} times", word.name())
        }
        Criterion::SpringsReturn { most } => write!(
            f,
            "the hand gets back at most {most:.4} T²/2σ + (½ + d) σ h ∫Ω² dt"
        ),
        Criterion::NetReturned { most_j } => write!(
            f,
            "the hand gets back at most {} J in any 2 s",
            Plain(*most_j)
        ),
        Criterion::Actuator {
            what,
            from_s,
            least,
            most,
        } => {
            let (what, unit) = what.words();
            if let Some(from_s) = from_s {
                write!(f, "from {} on ", Time(*from_s))?;
            }
            if *least > 0.0 {
                write!(f, "{what} is {} to {} {unit}", Plain(*least), Plain(*most))
            } else {
                write!(f, "{what} is at most {} {unit}", Plain(*most))
            }
        }
        _ => f.write_str("nothing"),
    }
}
