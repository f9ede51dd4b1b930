//! Axes of a sweep, as a user writes them: `PATH=VALUES`.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A key of the scene, and its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Name of the key with the tables before it, such as `effects.crepitus.static_torque_nm`.
    pub path: String,
    /// Values of the key.
    pub values: Values,
}

/// The values of an axis. In a file an interval is `FROM:TO:SCALE`, whose numbers read back to the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub enum Values {
    /// Numbers of an interval, both ends included.
    Interval {
        /// First end.
        from: f64,
        /// Second end; may be the smaller one.
        to: f64,
        /// Spacing.
        scale: Scale,
        /// Number of values in a grid.
        count: Option<u64>,
    },
    /// Listed values, as TOML or plain text.
    List(Vec<String>),
}

/// Values as a file has them.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Interval(String),
    List(Vec<String>),
}

impl From<Values> for Written {
    fn from(values: Values) -> Self {
        match values {
            Values::List(values) => Self::List(values),
            Values::Interval {
                from,
                to,
                scale,
                count,
            } => {
                let count = count.map(|count| count.to_string()).unwrap_or_default();
                Self::Interval(format!("{from:?}:{to:?}:{scale}{count}"))
            }
        }
    }
}

impl TryFrom<Written> for Values {
    type Error = AxisError;

    fn try_from(written: Written) -> Result<Self, AxisError> {
        match written {
            Written::List(values) => Ok(Self::List(values)),
            Written::Interval(text) => match text.split(':').collect::<Vec<_>>().as_slice() {
                [from, to, scale] => interval(from, to, scale),
                _ => refuse("expected FROM:TO:linN or FROM:TO:logN"),
            },
        }
    }
}

/// Spacing of the values of an interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Even in the number.
    Linear,
    /// Even in its logarithm.
    Logarithmic,
}

/// Formats the scale as a user writes it.
impl fmt::Display for Scale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Linear => "lin",
            Self::Logarithmic => "log",
        })
    }
}

impl Scale {
    /// Returns the number at a share of the interval, 0 to 1; exact at both ends.
    fn at(self, from: f64, to: f64, share: f64) -> f64 {
        // Rounding would take the last digits of an end.
        if share <= 0.0 {
            return from;
        }
        if share >= 1.0 {
            return to;
        }
        match self {
            Self::Linear => from + (to - from) * share,
            Self::Logarithmic => rounded(from * (to / from).powf(share)),
        }
        .clamp(from.min(to), from.max(to))
    }
}

/// Rounds to 12 digits: the last ones of a power differ between computers, which need the same
/// points.
fn rounded(x: f64) -> f64 {
    format!("{x:.11e}").parse().unwrap_or(x)
}

impl Values {
    /// Returns the number of values in a grid; none if it was not given.
    pub fn count(&self) -> Option<u64> {
        match self {
            Self::Interval { count, .. } => *count,
            Self::List(values) => Some(values.len() as u64),
        }
    }

    /// Returns the value at an index of a grid.
    pub(crate) fn of_grid(&self, place: u64) -> String {
        match self {
            Self::Interval { count, .. } => {
                let last = count.unwrap_or(2).saturating_sub(1).max(1);
                self.at(share(place, last))
            }
            Self::List(values) => listed(values, place),
        }
    }

    /// Returns the value at a share of the axis, 0 to 1; the values of a list have equal parts of
    /// it.
    pub(crate) fn at(&self, share: f64) -> String {
        match self {
            Self::Interval {
                from, to, scale, ..
            } => format!("{:?}", scale.at(*from, *to, share)),
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                clippy::cast_precision_loss,
                reason = "a share of a list's length"
            )]
            Self::List(values) => listed(values, (share * values.len() as f64) as u64),
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53")]
fn share(place: u64, last: u64) -> f64 {
    place as f64 / last as f64
}

/// Returns the value at an index, or the last one.
fn listed(values: &[String], place: u64) -> String {
    let place = usize::try_from(place).unwrap_or(usize::MAX);
    values
        .get(place)
        .or(values.last())
        .cloned()
        .unwrap_or_default()
}

/// Error of an invalid axis.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct AxisError(String);

fn refuse<T>(message: impl Into<String>) -> Result<T, AxisError> {
    Err(AxisError(message.into()))
}

/// `PATH=FROM:TO`, `PATH=FROM:TO:linN`, `PATH=FROM:TO:logN`, `PATH=VALUE,VALUE,…`.
impl FromStr for Axis {
    type Err = AxisError;

    fn from_str(text: &str) -> Result<Self, AxisError> {
        let Some((path, values)) = text.split_once('=') else {
            return refuse(
                "expected PATH=VALUES, for example effects.crepitus.static_torque_nm=1:4:lin7",
            );
        };
        let (path, values) = (path.trim(), values.trim());
        if path.is_empty() || values.is_empty() {
            return refuse("expected PATH=VALUES; one of the two is empty");
        }
        let parts: Vec<_> = values.split(':').map(str::trim).collect();
        let values = match parts.as_slice() {
            [_] => list(values)?,
            [from, to] => interval(from, to, "lin")?,
            [from, to, scale] => interval(from, to, scale)?,
            _ => return refuse("expected FROM:TO:linN or FROM:TO:logN; there are more colons"),
        };
        Ok(Self {
            path: path.to_owned(),
            values,
        })
    }
}

fn list(text: &str) -> Result<Values, AxisError> {
    let values: Vec<_> = text.split(',').map(|v| v.trim().to_owned()).collect();
    if values.iter().any(String::is_empty) {
        return refuse(format!("a value of the list {text:?} is empty"));
    }
    if let Some(twice) = (1..values.len()).find(|&i| values[..i].contains(&values[i])) {
        return refuse(format!("{} is in the list twice", values[twice]));
    }
    Ok(Values::List(values))
}

fn interval(from: &str, to: &str, scale: &str) -> Result<Values, AxisError> {
    let end = |text: &str| match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => refuse(format!("{text:?} is not a number")),
    };
    let (from, to) = (end(from)?, end(to)?);
    let digits = scale.find(|c: char| c.is_ascii_digit());
    let (name, count) = scale.split_at(digits.unwrap_or(scale.len()));
    let kind = match name {
        "lin" => Scale::Linear,
        "log" => Scale::Logarithmic,
        "" => {
            return refuse(format!(
                "{scale:?} does not say how its values are spaced: expected lin{scale} or log{scale}"
            ));
        }
        _ => {
            return refuse(format!(
                "{name:?} is no scale: expected lin or log, with the number of values for a grid, such as lin11"
            ));
        }
    };
    let count = match count {
        "" => None,
        count => match count.parse::<u64>() {
            Ok(count) if count >= 2 => Some(count),
            _ => {
                return refuse(format!(
                    "{count:?} values: an interval has at least its 2 ends"
                ));
            }
        },
    };
    if from == to {
        return refuse(format!("both ends are {from}: give one value instead"));
    }
    if kind == Scale::Logarithmic && (from <= 0.0 || to <= 0.0) {
        return refuse(format!(
            "log needs ends above 0, not {from} and {to}: lin takes any"
        ));
    }
    Ok(Values::Interval {
        from,
        to,
        scale: kind,
        count,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(text: &str) -> Vec<String> {
        let axis: Axis = text.parse().unwrap();
        let count = axis.values.count().unwrap();
        (0..count).map(|i| axis.values.of_grid(i)).collect()
    }

    #[test]
    fn a_grid_has_both_ends_exactly() {
        assert_eq!(grid("a=1:2:lin3"), ["1.0", "1.5", "2.0"]);
        assert_eq!(grid("a=0.1:0.7:lin4").first().unwrap(), "0.1");
        assert_eq!(grid("a=0.1:0.7:lin4").last().unwrap(), "0.7");
        assert_eq!(grid("a=1e-6:1e-4:log3"), ["1e-6", "1e-5", "0.0001"]);
        assert_eq!(grid("a=3:-3:lin2"), ["3.0", "-3.0"]);
        // More digits than a power keeps.
        let ends = ["0.1234567890127", "0.9876543210123"];
        for (from, to) in [(ends[0], ends[1]), (ends[1], ends[0])] {
            for scale in ["lin", "log"] {
                let values = grid(&format!("a={from}:{to}:{scale}4"));
                assert_eq!([&*values[0], &*values[3]], [from, to], "{scale}");
            }
        }
        assert_eq!(grid("solver.kind = exact, heun"), ["exact", "heun"]);
        assert_eq!(grid("a=7"), ["7"]);
    }

    #[test]
    fn what_a_file_has_is_the_same_axis() {
        for text in [
            "a=0.1:0.30000000000000004:lin7",
            "b=1e-300:1.7976931348623157e308:log",
            "c=x,y",
        ] {
            let axis: Axis = text.parse().unwrap();
            let json = serde_json::to_string(&axis).unwrap();
            assert_eq!(serde_json::from_str::<Axis>(&json).unwrap(), axis, "{json}");
        }
        let list = Values::List(vec!["[1, 2]".to_owned(), "1:2:lin3".to_owned()]);
        let json = serde_json::to_string(&list).unwrap();
        assert_eq!(serde_json::from_str::<Values>(&json).unwrap(), list);
        assert!(serde_json::from_str::<Values>("\"1:2\"").is_err());
    }

    #[test]
    fn each_of_a_list_has_an_equal_part() {
        let axis: Axis = "a=x,y,z".parse().unwrap();
        let at: Vec<_> = [0.0, 0.3, 0.34, 0.6, 0.67, 0.999, 1.0]
            .map(|share| axis.values.at(share))
            .into();
        assert_eq!(at, ["x", "x", "y", "y", "z", "z", "z"]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, word) in [
            ("a", "PATH=VALUES"),
            ("=1", "empty"),
            ("a=", "empty"),
            ("a=1,,2", "empty"),
            ("a=1,1", "twice"),
            ("a=1:x", "not a number"),
            ("a=1:inf", "not a number"),
            ("a=1:2:cube3", "no scale"),
            ("a=1:2:3", "lin3 or log3"),
            ("a=1:2:lin1", "at least its 2 ends"),
            ("a=1:2:lin99999999999999999999", "at least"),
            ("a=0:2:log3", "above 0"),
            ("a=2:2:lin3", "both ends"),
            ("a=1:2:lin3:4", "more colons"),
        ] {
            let error = text.parse::<Axis>().unwrap_err().to_string();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
