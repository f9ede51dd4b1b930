//! Errors of recordings, with position, cause and remedy.

use super::{AngleUnit, MAX_BYTES, MAX_JOIN_DEG, MAX_ROWS, MIN_SAMPLES, Source};
use crepitus_files::input::Kind;
use crepitus_files::table::{CellError, Problem};
use std::fmt;
use std::path::{Path, PathBuf};

/// A place in a file; shown as `knee.csv, line 17, column "knee_flexion_deg"`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file as it was named.
    pub path: PathBuf,
    /// The line as an editor counts, from 1.
    pub line: Option<u64>,
    /// The name of the column.
    pub column: Option<String>,
}

impl Place {
    pub(super) fn file(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            line: None,
            column: None,
        }
    }

    pub(super) fn line(path: &Path, line: u64) -> Self {
        Self {
            line: Some(line),
            ..Self::file(path)
        }
    }

    pub(super) fn cell(path: &Path, line: u64, column: &str) -> Self {
        Self {
            column: Some(column.to_owned()),
            ..Self::line(path, line)
        }
    }

    pub(super) fn column_of(source: &Source<'_>, column: &str) -> Self {
        Self {
            column: Some(column.to_owned()),
            ..Self::file(source.path)
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if let Some(column) = &self.column {
            write!(f, ", column \"{column}\"")?;
        }
        Ok(())
    }
}

/// Reason why a recording cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(
    missing_docs,
    reason = "the message above each variant says what its fields mean"
)]
pub enum RecordingError {
    #[error("{place}: cannot be read: {source}; check the path and the permissions")]
    Unreadable {
        place: Place,
        source: std::io::Error,
    },
    #[error("{place}: is {kind}, not a file; name a CSV, .mot or .sto file")]
    NotAFile { place: Place, kind: Kind },
    #[error("{place}: has {bytes} bytes, at most {MAX_BYTES} are read; cut or thin the recording")]
    TooLarge { place: Place, bytes: u64 },
    #[error("{place}: {problem}")]
    Table {
        place: Place,
        #[source]
        problem: Box<Problem>,
    },
    #[error("{place}: has more than {MAX_ROWS} rows; cut or thin the recording")]
    TooManyRows { place: Place },
    #[error("{place}: has column names but no rows; export the recording again")]
    NoRows { place: Place },
    #[error("{place}: the rows end after {found}, at least {MIN_SAMPLES} are needed")]
    TooFewSamples { place: Place, found: usize },
    #[error("{place}: time_column and angle_column are the same; name two columns")]
    TimeIsAngle { place: Place },
    /// `role` is the key that named the column.
    #[error(
        "{place}: there is no such column ({role}){}; the file has {}",
        suggestion(place, available),
        list(available)
    )]
    MissingColumn {
        place: Place,
        role: &'static str,
        available: Vec<String>,
    },
    /// The positions count from 1.
    #[error(
        "{place}: the name is used twice, for columns {first} and {second}; rename one, \
             or name it by its position, \"#{first}\" or \"#{second}\""
    )]
    RepeatedColumn {
        place: Place,
        first: usize,
        second: usize,
    },
    #[error("{place}: {error}{}", if matches!(error, CellError::NotANumber { .. }) { "" }
            else { "; fill the gap, cut the recording before it, or write max_gap_s for short gaps" })]
    Cell { place: Place, error: CellError },
    #[error("{place}: \"{text}\" is not a time of day such as 09:15:03.25; check time_unit")]
    NotAClock { place: Place, text: String },
    #[error(
        "{place}: no numbers for {gap_s:.3} s, at most max_gap_s = {max_gap_s} s is bridged; fill \
             the gap, cut the recording there, or write a larger max_gap_s"
    )]
    LongGap {
        place: Place,
        gap_s: f64,
        max_gap_s: f64,
    },
    #[error(
        "{place}: the file does not say the unit of the angles; write unit = \"deg\" or unit = \"rad\""
    )]
    NoUnit { place: Place },
    #[error(
        "{place}: the title of the table is \"{title}\": these are no angles; name the file of \
             coordinates (if they are angles, change that line)"
    )]
    NotAngles { place: Place, title: String },
    /// The times are those in the file.
    #[error(
        "{place}: time goes back from {before_s} s to {after_s} s; sort the rows, or keep \
             one recording per file"
    )]
    TimeBackwards {
        place: Place,
        before_s: f64,
        after_s: f64,
    },
    #[error(
        "{place}: time stands still at {time_s} s; remove one of the two rows, or write the \
             times with more digits"
    )]
    TimeStill { place: Place, time_s: f64 },
    #[error(
        "{place}: {value} is no time in seconds, at most ±{limit} is believed; check the \
             column and time_unit"
    )]
    TimeOutOfRange {
        place: Place,
        value: f64,
        limit: f64,
    },
    #[error("{place}: {value} {unit} is no joint angle, at most ±{} {unit} is believed; {}",
            unit.limit(),
            if *is_mark { "it looks like a mark of a missing sample: fill the gap, or leave the cell empty and write \
                max_gap_s" }
            else if *unit == AngleUnit::Rad { "check the column, and write unit = \"deg\" if it is in degrees" }
            else { "check the column" })]
    AngleOutOfRange {
        place: Place,
        value: f64,
        unit: AngleUnit,
        is_mark: bool,
    },
    #[error(
        "a cutoff of {cutoff_hz} Hz is not possible: it must be above 0 and below \
             {nyquist_hz:.4} Hz, half the rate of the samples (6 Hz is usual; if the limit is far \
             too low, check that the time is in seconds)"
    )]
    Cutoff { cutoff_hz: f64, nyquist_hz: f64 },
    #[error(
        "a recording of {duration_s} s is too short for a cutoff of {cutoff_hz} Hz; \
             {enough_s} s are enough"
    )]
    TooShort {
        duration_s: f64,
        cutoff_hz: f64,
        enough_s: f64,
    },
    #[error(
        "the recording begins at {first_deg:.2} deg and ends at {last_deg:.2} deg: a cycle that is \
             repeated ends where it began, within {MAX_JOIN_DEG} deg; cut the file to whole cycles, or leave \
             out repeat"
    )]
    NoCycle { first_deg: f64, last_deg: f64 },
    #[error(
        "the cycle has {found} samples, to be repeated it needs {needed} (those closer than a 64th \
             of the cutoff's period, here {cutoff_hz} Hz, count as one)"
    )]
    ShortCycle {
        found: usize,
        needed: usize,
        cutoff_hz: f64,
    },
    /// Invalid samples; only those that were not made by `read` can be so.
    #[error("sample {index} (from 0): {problem}")]
    BadSamples { index: usize, problem: &'static str },
    #[error("the smoothing spline failed: {reason}; please report it with the recording")]
    Spline { reason: String },
}

fn suggestion(place: &Place, available: &[String]) -> String {
    if available.iter().all(|name| name.parse::<f64>().is_ok()) {
        return "; the first line must name the columns".to_owned();
    }
    let wanted = place.column.as_deref().unwrap_or_default().to_lowercase();
    available
        .iter()
        .map(|name| (strsim::jaro_winkler(&wanted, &name.to_lowercase()), name))
        .filter(|(likeness, _)| *likeness > 0.8)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map_or_else(String::new, |(_, name)| {
            format!("; did you mean \"{name}\"?")
        })
}

fn list(names: &[String]) -> String {
    const SHOWN: usize = 10;
    let shown: Vec<String> = names
        .iter()
        .take(SHOWN)
        .map(|name| format!("\"{}\"", name.escape_debug()))
        .collect();
    let more = names.len().saturating_sub(SHOWN);
    let tail = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    format!("{}{tail}", shown.join(", "))
}
