//! Common part of both readers: finding the two columns, and checking each row as it comes.

use super::{AngleUnit, MAX_ROWS, MIN_SAMPLES, Place, RecordingError, Samples, Source, Warning};

/// The largest plausible time, in s: a clock that counts from 1970 stays below it, one in
/// milliseconds does not.
const TIME_LIMIT_S: f64 = 1e10;

/// An interval longer than this many median intervals is a gap.
const GAP_FACTOR: f64 = 5.0;

/// Cells are quoted in messages up to this many characters.
const QUOTED_CHARS: usize = 24;

/// The rows so far, and where the two columns are.
pub(super) struct Table<'a> {
    source: &'a Source<'a>,
    names_line: u64,
    width: usize,
    time_index: usize,
    angle_index: usize,
    first_time_s: f64,
    last_time_s: f64,
    last_line: u64,
    samples: Samples,
}

impl<'a> Table<'a> {
    /// Finds the columns in the line of names.
    pub(super) fn new(
        source: &'a Source<'a>,
        line: u64,
        names: &[&str],
    ) -> Result<Self, RecordingError> {
        Ok(Self {
            source,
            names_line: line,
            width: names.len(),
            time_index: find(source, line, names, source.time_column, "time_column")?,
            angle_index: find(
                source,
                line,
                names,
                source.angle_column,
                if source.unit.is_some() {
                    "angle_column"
                } else {
                    "column"
                },
            )?,
            first_time_s: 0.0,
            last_time_s: 0.0,
            last_line: line,
            samples: Samples {
                time_s: Vec::new(),
                angle_rad: Vec::new(),
                warnings: Vec::new(),
            },
        })
    }

    /// The number of cells a row must have.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// The number of rows so far.
    pub(super) fn rows(&self) -> usize {
        self.samples.time_s.len()
    }

    pub(super) fn warn(&mut self, warning: Warning) {
        self.samples.warnings.push(warning);
    }

    /// Adds a row.
    pub(super) fn push<'c>(
        &mut self,
        line: u64,
        cells: &(impl Iterator<Item = &'c str> + Clone),
    ) -> Result<(), RecordingError> {
        let path = self.source.path;
        if self.rows() >= MAX_ROWS {
            return Err(RecordingError::TooManyRows {
                place: Place::line(path, line),
            });
        }
        let time_place = || Place::cell(path, line, self.source.time_column);
        let angle_place = || Place::cell(path, line, self.source.angle_column);
        let cell = |index| cells.clone().nth(index).unwrap_or_default();

        let file_time_s = number(cell(self.time_index), time_place)?;
        if file_time_s.abs() > TIME_LIMIT_S {
            return Err(RecordingError::TimeOutOfRange {
                place: time_place(),
                value: file_time_s,
                limit: TIME_LIMIT_S,
            });
        }
        if self.samples.time_s.is_empty() {
            self.first_time_s = file_time_s;
        }
        let time_s = file_time_s - self.first_time_s;
        if let Some(&before_s) = self.samples.time_s.last() {
            if time_s < before_s {
                return Err(RecordingError::TimeBackwards {
                    place: time_place(),
                    before_s: self.last_time_s,
                    after_s: file_time_s,
                });
            }
            if time_s == before_s {
                return Err(RecordingError::TimeStill {
                    place: time_place(),
                    time_s: file_time_s,
                });
            }
        }

        let angle = number(cell(self.angle_index), angle_place)?;
        if let Some(unit) = self.source.unit
            && angle.abs() > unit.limit()
        {
            return Err(RecordingError::AngleOutOfRange {
                place: angle_place(),
                value: angle,
                unit,
            });
        }
        let angle_rad = self.source.unit.map_or(angle, |unit| unit.to_rad(angle));
        self.samples.time_s.push(time_s);
        self.samples.angle_rad.push(angle_rad);
        self.last_time_s = file_time_s;
        self.last_line = line;
        Ok(())
    }

    /// The error of a row with `found` cells.
    pub(super) fn wrong_width(&self, line: u64, found: usize, is_last: bool) -> RecordingError {
        let place = Place::line(self.source.path, line);
        let expected = self.width;
        if is_last && found < expected {
            RecordingError::CutRow {
                place,
                found,
                expected,
            }
        } else {
            RecordingError::RowWidth {
                place,
                found,
                expected,
            }
        }
    }

    /// The samples, once all rows are in. `unit_is_sure` says that the file itself names the unit.
    pub(super) fn finish(mut self, unit_is_sure: bool) -> Result<Samples, RecordingError> {
        let path = self.source.path;
        match self.rows() {
            0 => {
                return Err(RecordingError::NoRows {
                    place: Place::line(path, self.names_line),
                });
            }
            found if found < MIN_SAMPLES => {
                let place = Place::line(path, self.last_line);
                return Err(RecordingError::TooFewSamples { place, found });
            }
            _ => {}
        }
        if let Some(gap) = self.gap() {
            self.warn(gap);
        }
        if !unit_is_sure && let Some(doubt) = self.doubtful_unit() {
            self.warn(doubt);
        }
        Ok(self.samples)
    }

    fn gap(&self) -> Option<Warning> {
        let median_interval_s = self.samples.median_interval_s()?;
        let gaps = self
            .samples
            .time_s
            .array_windows()
            .filter(|[before, after]| after - before > GAP_FACTOR * median_interval_s);
        let count = gaps.clone().count();
        let [from_s, to_s] = gaps.max_by(|[a, b], [c, d]| (b - a).total_cmp(&(d - c)))?;
        Some(Warning::Gap {
            place: Place::column_of(self.source, self.source.time_column),
            from_s: from_s + self.first_time_s,
            to_s: to_s + self.first_time_s,
            median_interval_s,
            count,
        })
    }

    /// Degrees read as radians are out of range; radians read as degrees are only small.
    fn doubtful_unit(&self) -> Option<Warning> {
        let Source {
            angle_column, unit, ..
        } = *self.source;
        let unit = unit?;
        let place = Place::column_of(self.source, angle_column);
        let name = angle_column.to_lowercase();
        let other: &[&str] = match unit {
            AngleUnit::Deg => &["_rad", "(rad)", "[rad]"],
            AngleUnit::Rad => &["_deg", "(deg)", "[deg]"],
        };
        if other.iter().any(|ending| name.ends_with(ending)) {
            return Some(Warning::UnitInName { place, unit });
        }
        let angles = self
            .samples
            .angle_rad
            .iter()
            .map(|angle| angle.to_degrees());
        let lowest = angles.clone().fold(f64::INFINITY, f64::min);
        let highest = angles.fold(f64::NEG_INFINITY, f64::max);
        let largest_deg = highest.abs().max(lowest.abs());
        // ±π is what radians can mean; a range of 0.2 rad leaves out someone standing still.
        let small = largest_deg <= 3.2 && highest - lowest >= 0.2;
        (unit == AngleUnit::Deg && small).then_some(Warning::SmallAngles { place, largest_deg })
    }
}

fn find(
    source: &Source<'_>,
    line: u64,
    names: &[&str],
    wanted: &str,
    role: &'static str,
) -> Result<usize, RecordingError> {
    let place = Place::cell(source.path, line, wanted);
    let mut matches = names
        .iter()
        .enumerate()
        .filter(|(_, name)| **name == wanted)
        .map(|(index, _)| index);
    match (matches.next(), matches.next()) {
        (Some(index), None) => Ok(index),
        (Some(first), Some(second)) => Err(RecordingError::RepeatedColumn {
            place,
            first: first + 1,
            second: second + 1,
        }),
        (None, _) => {
            let available = names.iter().map(|&name| name.to_owned()).collect();
            Err(RecordingError::MissingColumn {
                place,
                role,
                available,
            })
        }
    }
}

fn number(text: &str, place: impl Fn() -> Place) -> Result<f64, RecordingError> {
    if text.is_empty() {
        return Err(RecordingError::EmptyCell { place: place() });
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(RecordingError::NotFinite {
            place: place(),
            text: shorten(text),
        }),
        Err(_) => Err(RecordingError::NotANumber {
            place: place(),
            text: shorten(text),
        }),
    }
}

fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(QUOTED_CHARS).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short.escape_debug().to_string()
}
