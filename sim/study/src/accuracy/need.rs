//! A need: limits that a solver's errors have to keep, and how they are
//! written: `torque=5e-3,interval=5e-4`.

use crate::accuracy::point::Point;
use serde::Serialize;
use std::fmt;

/// What can be limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// Root mean square torque error.
    Torque,
    /// Largest torque error.
    PeakTorque,
    /// Worst error of an event's time.
    Event,
    /// Worst error of the time between neighbouring events.
    Interval,
    /// Relative error of the cycle frequency.
    Frequency,
}

impl Criterion {
    /// All criteria.
    pub const ALL: [Self; 5] = [
        Self::Torque,
        Self::PeakTorque,
        Self::Event,
        Self::Interval,
        Self::Frequency,
    ];

    /// Name in a need.
    pub fn key(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::PeakTorque => "peak-torque",
            Self::Event => "event",
            Self::Interval => "interval",
            Self::Frequency => "frequency",
        }
    }

    /// What it is, in words.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Torque => "rms torque error",
            Self::PeakTorque => "largest torque error",
            Self::Event => "worst event-time error",
            Self::Interval => "worst interval error",
            Self::Frequency => "relative error of the cycle frequency",
        }
    }

    /// Its unit; empty for a relative error.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Torque | Self::PeakTorque => "N·m",
            Self::Event | Self::Interval => "s",
            Self::Frequency => "",
        }
    }

    /// The error of a point.
    pub fn error(self, point: &Point) -> f64 {
        match self {
            Self::Torque => point.rms_torque_error_nm,
            Self::PeakTorque => point.max_torque_error_nm,
            Self::Event => point.max_event_error_s,
            Self::Interval => point.max_interval_error_s,
            Self::Frequency => point.frequency_error_rel,
        }
    }

    /// The error as it is held against a limit. Torque is known or wrong; of
    /// events there may be none to be wrong about.
    pub(crate) fn judged(self, point: &Point) -> f64 {
        let error = self.error(point);
        match self {
            Self::Torque | Self::PeakTorque if error.is_nan() => f64::INFINITY,
            Self::Event | Self::Interval | Self::Frequency if error.is_nan() => 0.0,
            _ => error,
        }
    }
}

/// Limits that have to hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Need {
    limits: Vec<Limit>,
}

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// What is limited.
    pub criterion: Criterion,
    /// The largest error that is allowed, in the criterion's unit.
    pub at_most: f64,
}

/// Why a text is no need.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum NeedError {
    /// Nothing is asked for.
    Empty,
    /// Not KEY=VALUE.
    Form {
        /// The part that is not.
        part: String,
    },
    /// No such criterion.
    Key {
        /// What was asked for.
        key: String,
    },
    /// A criterion twice.
    Twice {
        /// Which one.
        criterion: Criterion,
    },
    /// Not a number above zero.
    Value {
        /// Of which criterion.
        criterion: Criterion,
        /// What was asked for.
        value: String,
    },
}

impl fmt::Display for NeedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "the need is empty")?,
            Self::Form { part } => write!(f, "\"{part}\" is not KEY=VALUE")?,
            Self::Key { key } => write!(f, "\"{key}\" is not known")?,
            Self::Twice { criterion } => write!(f, "{} is given twice", criterion.key())?,
            Self::Value { criterion, value } => {
                return write!(
                    f,
                    "{}={value} is not allowed: the limit must be a number above 0{}",
                    criterion.key(),
                    match criterion.unit() {
                        "" => String::new(),
                        unit => format!(", in {unit}"),
                    }
                );
            }
        }
        write!(f, ": a need is a list such as torque=5e-3,interval=5e-4 of")?;
        for (i, c) in Criterion::ALL.into_iter().enumerate() {
            let comma = if i == 0 { "" } else { "," };
            write!(f, "{comma} {} ({}", c.key(), c.meaning())?;
            match c.unit() {
                "" => write!(f, ")")?,
                unit => write!(f, ", {unit})")?,
            }
        }
        Ok(())
    }
}

impl std::error::Error for NeedError {}

impl std::str::FromStr for Need {
    type Err = NeedError;

    /// Reads `torque=5e-3,interval=5e-4`.
    fn from_str(text: &str) -> Result<Self, NeedError> {
        let mut limits: Vec<Limit> = Vec::new();
        if text.trim().is_empty() {
            return Err(NeedError::Empty);
        }
        for part in text.split(',').map(str::trim) {
            let (key, value) = part.split_once('=').ok_or_else(|| NeedError::Form {
                part: part.to_owned(),
            })?;
            let (key, value) = (key.trim(), value.trim());
            let criterion = Criterion::ALL
                .into_iter()
                .find(|c| c.key() == key)
                .ok_or_else(|| NeedError::Key {
                    key: key.to_owned(),
                })?;
            if limits.iter().any(|l| l.criterion == criterion) {
                return Err(NeedError::Twice { criterion });
            }
            let at_most = value
                .parse::<f64>()
                .ok()
                .filter(|x| x.is_finite() && *x > 0.0)
                .ok_or_else(|| NeedError::Value {
                    criterion,
                    value: value.to_owned(),
                })?;
            limits.push(Limit { criterion, at_most });
        }
        Ok(Self { limits })
    }
}

impl Need {
    /// The limits, in the order in which they were given.
    pub fn limits(&self) -> &[Limit] {
        &self.limits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_needs_are_refused_with_what_is_allowed() {
        for (text, part) in [
            ("", "empty"),
            ("torque", "KEY=VALUE"),
            ("torque=1e-3,", "KEY=VALUE"),
            ("speed=1", "peak-torque (largest torque error, N·m)"),
            ("torque=0", "above 0, in N·m"),
            ("torque=-1", "above 0"),
            ("event=NaN", "above 0, in s"),
            ("frequency=inf", "number above 0"),
            ("torque=1,torque=2", "twice"),
        ] {
            let error = text.parse::<Need>().unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
        let need: Need = " torque = 5e-3 , peak-torque=1".parse().unwrap();
        assert_eq!(need.limits().len(), 2);
        assert_eq!(need.limits()[0].at_most, 5e-3);
    }
}
