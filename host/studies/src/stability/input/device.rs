//! Ways in which a joint in a device gets a motion: through an encoder, with faulty or lost samples,
//! with commits, or from a hand that gets its torque late.

use crate::stability::text::{Plain, Time};
use crepitus_model::{Parameters, Real};
use std::fmt;

/// Readings of the encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Readings {
    pub(crate) rate_hz: f64,
    /// Lines of the encoder's disc.
    pub(crate) lines: f64,
    /// Largest jitter of a reading, in periods.
    pub(crate) jitter: f64,
    /// The share of lost readings.
    pub(crate) lost: f64,
    /// Counter at the start; it wraps as a 32-bit timer does.
    pub(crate) first_count: i32,
}

/// Faults of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// Every so many samples one is NaN, infinite, or implausible: each kind in
    /// turn.
    Impossible(u64),
    /// All samples are NaN from this time on, s.
    Blind(f64),
    /// All samples are missing between two times, s.
    Gap(f64, f64),
    /// All samples are missing while the shaft moves backwards.
    Retreating,
    /// Every so many samples the velocity at the end of one is 20 rad/s off:
    /// a plausible speed, but not within a tick.
    Jumps(u64),
}

/// A joint in a device, beside its motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rendered {
    /// Whether the joint gets counts of the device's encoder, or the true motion.
    pub(crate) counts: bool,
    pub(crate) lost: Lost,
    /// A commit every so many ticks; 0 for none.
    pub(crate) commit_every: u64,
    /// The committed parameters, in turn.
    pub(crate) commits: Vec<Parameters>,
}

/// Lost samples: bursts that may repeat, from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lost {
    /// Samples in a row; 0 for none.
    pub(crate) ticks: u64,
    /// Ticks from one burst to the next; 0 for one burst only.
    pub(crate) every: u64,
    /// Start of the first, s.
    pub(crate) from_s: f64,
}

impl Lost {
    pub(crate) const NONE: Self = Self {
        ticks: 0,
        every: 0,
        from_s: 0.0,
    };

    /// Returns whether sample `n`, counted from 1, is lost.
    pub(crate) fn takes(&self, n: u64, step_s: f64) -> bool {
        let first = (self.from_s / step_s).round().whole() + 1;
        let Some(since) = n.checked_sub(first) else {
            return false;
        };
        let place = if self.every == 0 {
            since
        } else {
            since % self.every
        };
        place < self.ticks
    }
}

/// A hand, beside its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shake {
    /// Ticks between a sample and its torque.
    pub(crate) delay_ticks: usize,
    /// Whether the joint gets counts of the device's encoder, or the true motion.
    pub(crate) counts: bool,
    pub(crate) lost: Lost,
}

impl fmt::Display for Readings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rate_hz, lines, .. } = self;
        write!(f, "encoder of {lines} lines read at {rate_hz} Hz")?;
        if self.jitter > 0.0 {
            write!(f, " ± {} % of a period", Plain(100.0 * self.jitter))?;
        }
        if self.lost > 0.0 {
            write!(f, ", {} % of the readings lost", Plain(100.0 * self.lost))?;
        }
        if self.first_count != 0 {
            write!(f, ", counter from {}", self.first_count)?;
        }
        Ok(())
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Impossible(every) => write!(
                f,
                "every {every}th sample NaN, infinite, 1 rad or 60 rad/s off, in turn"
            ),
            Self::Blind(from_s) => write!(f, "NaN from {} on", Time(from_s)),
            Self::Gap(from_s, to_s) => {
                write!(f, "no sample from {} to {}", Time(from_s), Time(to_s))
            }
            Self::Retreating => f.write_str("no sample while the shaft moves backwards"),
            Self::Jumps(every) => write!(f, "every {every}th sample ends 20 rad/s too fast"),
        }
    }
}

/// Length of a burst and of the way to the next, after a comma.
impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.ticks > 0 {
            write!(f, ", {} samples in a row lost", self.ticks)?;
        }
        if self.every > 0 {
            write!(f, " of every {}", self.every)?;
        }
        Ok(())
    }
}

impl fmt::Display for Rendered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("rendered as on the device")?;
        if self.counts {
            f.write_str(", seen through the encoder")?;
        }
        write!(f, "{}", self.lost)?;
        if self.lost.from_s > 0.0 {
            write!(f, " from {} on", Time(self.lost.from_s))?;
        }
        let ticks = match self.commit_every {
            0 => return Ok(()),
            1 => "every tick".to_owned(),
            n => format!("every {n} ticks"),
        };
        let commits: Vec<String> = self.commits.iter().map(named).collect();
        write!(f, ", a commit {ticks}, in turn{}", commits.join(","))
    }
}

/// Description of parameters, where they differ from the paper's.
pub(super) fn named(parameters: &Parameters) -> String {
    match super::unlike_the_paper(parameters).as_slice() {
        [] => " the paper's".to_owned(),
        names => format!(" {}", names.join(" ")),
    }
}

impl fmt::Display for Shake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seen = if self.counts {
            "through the encoder"
        } else {
            "as it is"
        };
        write!(f, "the torque {} ticks late, seen {seen}", self.delay_ticks)?;
        let Lost {
            ticks,
            every,
            from_s,
        } = self.lost;
        if ticks == 0 {
            return Ok(());
        }
        let from = Plain(from_s);
        write!(
            f,
            "; {ticks} of every {every} samples are lost, from t = {from} s on"
        )
    }
}
