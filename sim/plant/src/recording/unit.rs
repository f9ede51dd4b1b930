//! Units of angles and of times, and which one counts where a file and a person differ.

use super::{Angles, Place, RecordingError, Source};
use crate::Extremes;
use crepitus_files::table::Table;
use std::fmt;
use std::io::Read;

/// The unit of a column of angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    Deg,
    /// Radians.
    Rad,
}

impl AngleUnit {
    /// The largest plausible angle, in this unit: 2000°, far beyond any joint.
    pub const fn limit(self) -> f64 {
        match self {
            Self::Deg => 2000.0,
            Self::Rad => 35.0,
        }
    }

    pub(super) fn to_rad(self, angle: f64) -> f64 {
        match self {
            Self::Deg => angle.to_radians(),
            Self::Rad => angle,
        }
    }

    pub(super) fn to_deg(self, angle: f64) -> f64 {
        match self {
            Self::Deg => angle,
            Self::Rad => angle.to_degrees(),
        }
    }

    const fn of_degrees(is_deg: bool) -> Self {
        if is_deg { Self::Deg } else { Self::Rad }
    }

    /// The unit that a word over a column means.
    fn of_word(word: &str) -> Option<Self> {
        match word {
            "deg" | "degree" | "degrees" | "°" => Some(Self::Deg),
            "rad" | "radian" | "radians" => Some(Self::Rad),
            _ => None,
        }
    }

    /// The unit that the name of a column ends with.
    fn of_name(name: &str) -> Option<Self> {
        let name = name.to_lowercase();
        let ends = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
        if ends(&["_deg", "(deg)", "[deg]", "(°)", "[°]", "(degrees)"]) {
            Some(Self::Deg)
        } else if ends(&["_rad", "(rad)", "[rad]", "(radians)"]) {
            Some(Self::Rad)
        } else {
            None
        }
    }
}

impl fmt::Display for AngleUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Deg => "deg",
            Self::Rad => "rad",
        })
    }
}

/// The unit of a column of times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds.
    Seconds,
    /// Milliseconds.
    Milliseconds,
    /// Microseconds.
    Microseconds,
    /// Minutes.
    Minutes,
    /// Times of day, such as 09:15:03.25, with or without a date before them.
    Clock,
}

impl TimeUnit {
    /// Each with its name in a scene.
    pub const ALL: [(&'static str, Self); 5] = [
        ("s", Self::Seconds),
        ("ms", Self::Milliseconds),
        ("us", Self::Microseconds),
        ("min", Self::Minutes),
        ("clock", Self::Clock),
    ];

    /// The unit that a word over a column means.
    pub fn of_word(word: &str) -> Option<Self> {
        match word {
            "s" | "sec" | "secs" | "second" | "seconds" => Some(Self::Seconds),
            "ms" | "msec" | "msecs" | "millisecond" | "milliseconds" => Some(Self::Milliseconds),
            "us" | "µs" => Some(Self::Microseconds),
            "min" => Some(Self::Minutes),
            _ => None,
        }
    }

    /// The unit of a time column: the one said, else that of the file's row of units, else seconds.
    pub(super) fn settle<R: Read>(
        source: &Source<'_>,
        table: &Table<R>,
        column: usize,
        (warnings, read_as): (&mut Vec<String>, &mut Vec<String>),
    ) -> Self {
        let of_file = table.unit(column).and_then(|word| Self::of_word(&word));
        match (source.time_unit, of_file) {
            (Some(said), Some(of_file)) if said != of_file => {
                let place = Place::column_of(source, source.time_column);
                warnings.push(format!(
                    "{place}: the row of units says {of_file}; taken as {said}"
                ));
                said
            }
            (Some(said), _) => said,
            (None, Some(of_file)) => {
                if of_file != Self::Seconds {
                    read_as.push(format!("times are in {of_file}, as the row of units says"));
                }
                of_file
            }
            (None, None) => Self::Seconds,
        }
    }

    /// A number of this unit in s.
    pub(super) fn to_s(self, time: f64) -> f64 {
        match self {
            Self::Seconds | Self::Clock => time,
            Self::Milliseconds => time / 1e3,
            Self::Microseconds => time / 1e6,
            Self::Minutes => time * 60.0,
        }
    }
}

impl fmt::Display for TimeUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::ALL.iter().find(|(_, unit)| unit == self);
        f.write_str(name.map_or("", |(name, _)| name))
    }
}

/// A time of day in s after midnight.
pub(super) fn clock_s(text: &str) -> Option<f64> {
    let time = text
        .rsplit(['T', ' '])
        .next()
        .unwrap_or_default()
        .trim_end_matches('Z');
    let parts: Vec<&str> = time.split(':').collect();
    let whole = |text: &str, below: f64| {
        let is_plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        let number = text.parse::<f64>().ok().filter(|_| is_plain);
        number.filter(|x| *x < below)
    };
    let seconds = |text: &str| {
        let is_plain = text
            .bytes()
            .all(|b| b.is_ascii_digit() || matches!(b, b'.' | b','));
        let number = text.replace(',', ".").parse::<f64>().ok();
        number.filter(|x| is_plain && *x < 61.0)
    };
    match parts.as_slice() {
        [h, m, s] => Some(whole(h, 24.0)? * 3600.0 + whole(m, 60.0)? * 60.0 + seconds(s)?),
        [m, s] => Some(whole(m, 1e6)? * 60.0 + seconds(s)?),
        _ => None,
    }
}

/// Angles in a file, up to the largest number and about its smallest.
pub(super) struct Spread {
    pub(super) largest: f64,
    pub(super) range: f64,
}

impl Spread {
    pub(super) fn of(numbers: &[f64]) -> Self {
        let extremes: Extremes<f64> = numbers.iter().copied().collect();
        Self {
            largest: extremes.high.abs().max(extremes.low.abs()),
            range: extremes.width(),
        }
    }

    /// Radians read as degrees are only small: ±π is what radians can mean; a range of 0.2 rad
    /// leaves out someone standing still.
    fn may_be_radians(&self) -> bool {
        self.largest <= 3.2 && self.range >= 0.2
    }

    /// Beyond a whole turn no joint goes.
    fn may_be_degrees(&self) -> bool {
        self.largest > std::f64::consts::TAU
    }
}

/// The unit of a column of angles, and why.
pub(super) fn settle<R: Read>(
    (source, angles): (&Source<'_>, &Angles),
    table: &Table<R>,
    column: usize,
    spread: &Spread,
    (warnings, read_as): (&mut Vec<String>, &mut Vec<String>),
) -> Result<AngleUnit, RecordingError> {
    let header = table.header().and_then(|header| header.in_degrees.clone());
    let row = table.unit(column);
    let row = row.and_then(|word| AngleUnit::of_word(&word));
    let place = Place::column_of(source, source.angle_column);
    // What the file says, where, and whether it is the header.
    let of_file = header.map_or_else(
        || row.map(|unit| (place.clone(), "the row of units".to_owned(), unit)),
        |(line, text, is_deg)| {
            let unit = AngleUnit::of_degrees(is_deg);
            Some((
                Place::line(source.path, line),
                format!("the header ({text})"),
                unit,
            ))
        },
    );
    let unit = match (angles.unit, of_file) {
        (None, Some((_, said, unit))) => {
            read_as.push(format!("angles are in {unit}, as {said} says"));
            unit
        }
        (None, None) => {
            let unit = AngleUnit::of_name(source.angle_column);
            let unit = unit.ok_or(RecordingError::NoUnit { place })?;
            read_as.push(format!(
                "angles are in {unit}, as the name of the column says"
            ));
            return Ok(unit);
        }
        (Some(said), Some((at, file, of_file))) if said != of_file => {
            let numbers_agree = match said {
                AngleUnit::Rad => spread.may_be_radians(),
                AngleUnit::Deg => spread.may_be_degrees(),
            };
            let taken = if angles.yields_to_header && !numbers_agree {
                of_file
            } else {
                said
            };
            warnings.push(format!(
                "{at}: {file} says {of_file}, but {said} was named; taken as {taken}; the largest number is {:.4}",
                spread.largest
            ));
            return Ok(taken);
        }
        (Some(said), _) => {
            if AngleUnit::of_name(source.angle_column).is_some_and(|named| named != said) {
                warnings.push(format!(
                    "{place}: the name does not look like the chosen unit, \"{said}\""
                ));
                return Ok(said);
            }
            said
        }
    };
    if unit == AngleUnit::Deg && spread.may_be_radians() {
        let place = Place::column_of(source, source.angle_column);
        warnings.push(format!(
            "{place}: no angle is beyond ±{:.3} deg; if the file is in radians, write unit = \"rad\"",
            spread.largest
        ));
    }
    Ok(unit)
}
