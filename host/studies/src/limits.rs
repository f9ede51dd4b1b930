//! Limits parsed from a text such as `torque=5e-3,interval=5e-4`.

use serde::Serialize;
use std::fmt;

/// A quantity that can be limited: a list of keys, each with a meaning and a
/// unit.
pub trait Limited: Copy + PartialEq + 'static {
    /// All quantities.
    const ALL: &'static [Self];
    /// Noun for a list of such limits.
    const LIMITS: &'static str;
    /// An example of a list.
    const EXAMPLE: &'static str;

    /// Name in a list.
    fn key(self) -> &'static str;

    /// Description.
    fn meaning(self) -> &'static str;

    /// Unit; empty for a relative quantity.
    fn unit(self) -> &'static str;
}

/// A list of limits, each quantity at most once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Limits<C> {
    limits: Vec<Limit<C>>,
}

/// One limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limit<C> {
    /// The limited quantity.
    pub criterion: C,
    /// The largest allowed value, in the criterion's unit.
    pub at_most: f64,
}

impl<C> Limits<C> {
    /// The limits, in the order in which they were given.
    pub fn limits(&self) -> &[Limit<C>] {
        &self.limits
    }
}

/// Reason why a text is not a valid list of limits.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LimitsError<C> {
    /// No limit.
    Empty,
    /// Part that is not KEY=VALUE.
    Form {
        /// The invalid part.
        part: String,
    },
    /// Unknown criterion.
    Key {
        /// The key.
        key: String,
    },
    /// Duplicate criterion.
    Twice {
        /// The criterion.
        criterion: C,
    },
    /// Value that is not a number above zero.
    Value {
        /// The criterion.
        criterion: C,
        /// The value.
        value: String,
    },
}

impl<C: Limited> fmt::Display for LimitsError<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "the {} is empty", C::LIMITS)?,
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
        write!(f, ": a {} is a list such as {} of", C::LIMITS, C::EXAMPLE)?;
        for (i, c) in C::ALL.iter().enumerate() {
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

impl<C: Limited + fmt::Debug> std::error::Error for LimitsError<C> {}

impl<C: Limited> std::str::FromStr for Limits<C> {
    type Err = LimitsError<C>;

    /// Parses `torque=5e-3,interval=5e-4`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut limits: Vec<Limit<C>> = Vec::new();
        if text.trim().is_empty() {
            return Err(LimitsError::Empty);
        }
        for part in text.split(',').map(str::trim) {
            let (key, value) = part.split_once('=').ok_or_else(|| LimitsError::Form {
                part: part.to_owned(),
            })?;
            let (key, value) = (key.trim(), value.trim());
            let criterion = C::ALL
                .iter()
                .copied()
                .find(|c| c.key() == key)
                .ok_or_else(|| LimitsError::Key {
                    key: key.to_owned(),
                })?;
            if limits.iter().any(|l| l.criterion == criterion) {
                return Err(LimitsError::Twice { criterion });
            }
            let at_most = value
                .parse::<f64>()
                .ok()
                .filter(|x| x.is_finite() && *x > 0.0)
                .ok_or_else(|| LimitsError::Value {
                    criterion,
                    value: value.to_owned(),
                })?;
            limits.push(Limit { criterion, at_most });
        }
        Ok(Self { limits })
    }
}
