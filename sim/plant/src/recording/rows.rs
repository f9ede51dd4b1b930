//! The rows of a recording: finding the two columns, and checking each row as it comes.

use super::plausible::{Readings, RowLines, is_mark, is_no_angle, is_no_angle_name};
use super::unit::{self, Spread, clock_s};
use super::{
    AngleUnit, Angles, MAX_ROWS, MIN_SAMPLES, Place, Quantity, RecordingError, Samples, Source,
    TimeUnit,
};
use crepitus_files::table::{CellError, Names, Table, TableError, shortened};
use std::io::Read;

/// The largest plausible time, in s: a clock that counts from 1970 stays below it, one in
/// milliseconds does not.
const TIME_LIMIT_S: f64 = 1e10;

/// An interval longer than this many median intervals is a gap.
const GAP_FACTOR: f64 = 5.0;

/// A day, in s.
const DAY_S: f64 = 86_400.0;

pub(super) fn read(source: &Source<'_>, reader: impl Read) -> Result<Samples, RecordingError> {
    let in_file = |error: TableError| RecordingError::Table {
        place: Place {
            line: error.line,
            ..Place::file(source.path)
        },
        problem: Box::new(error.problem),
    };
    let columns = [source.time_column, source.angle_column];
    let by_name: Vec<&str> = columns
        .into_iter()
        .filter(|name| position(name).is_none())
        .collect();
    let mut table = Table::open(reader, Names::Holding(&by_name)).map_err(in_file)?;
    let time_index = find(source, &table, source.time_column, "time_column")?;
    let role = match source.quantity {
        Quantity::Angles(_) => "angle_column",
        Quantity::Number => "column",
    };
    let angle_index = find(source, &table, source.angle_column, role)?;
    let mut rows = Rows {
        source,
        samples: Samples::default(),
        lines: RowLines::default(),
        time_unit: TimeUnit::Seconds,
        first_time_s: 0.0,
        last_time_s: 0.0,
        last_line: table.names_line(),
        midnights: 0.0,
        doubled: None,
        missing: None,
        left_out: 0,
    };
    rows.check_names(&table, angle_index)?;
    let Samples {
        warnings, read_as, ..
    } = &mut rows.samples;
    rows.time_unit = TimeUnit::settle(source, &table, time_index, (warnings, read_as));
    while let Some(line) = table.advance().map_err(in_file)? {
        rows.push(line, &mut table, (time_index, angle_index))?;
    }
    rows.finish(&table, angle_index)
}

/// The rows so far.
struct Rows<'a> {
    source: &'a Source<'a>,
    /// The angles in the unit of the file, up to the end.
    samples: Samples,
    lines: RowLines,
    time_unit: TimeUnit,
    first_time_s: f64,
    last_time_s: f64,
    last_line: u64,
    /// Days that the clock has begun since the first row, in s.
    midnights: f64,
    /// Line of the first row that only repeats the one before it, and how many there are.
    doubled: Option<(u64, usize)>,
    /// Line of the first sample that is missing since the last one, and its error.
    missing: Option<(u64, CellError)>,
    left_out: usize,
}

impl Rows<'_> {
    fn check_names<R: Read>(
        &mut self,
        table: &Table<R>,
        angle_index: usize,
    ) -> Result<(), RecordingError> {
        let path = self.source.path;
        let is_angle = matches!(self.source.quantity, Quantity::Angles(_));
        if let Some(header) = table.header() {
            if let Some((line, title)) = header.title.as_ref().filter(|_| is_angle)
                && is_no_angle(title)
            {
                return Err(RecordingError::NotAngles {
                    place: Place::line(path, *line),
                    title: shortened(title),
                });
            }
            let found = table.names().len() as u64;
            if let Some((line, declared)) = header.columns
                && declared != found
            {
                let place = Place::line(path, line);
                self.samples.warnings.push(format!(
                    "{place}: the header declares {declared} columns, the line of names has {found}"
                ));
            }
        }
        let name = table.names().get(angle_index).map_or("", String::as_str);
        if is_angle && is_no_angle_name(name) {
            let place = Place::cell(path, table.names_line(), self.source.angle_column);
            self.samples.warnings.push(format!(
                "{place}: the name is not that of an angle; check the column"
            ));
        }
        Ok(())
    }

    /// Adds a row.
    fn push<R: Read>(
        &mut self,
        line: u64,
        table: &mut Table<R>,
        (time_index, angle_index): (usize, usize),
    ) -> Result<(), RecordingError> {
        let path = self.source.path;
        let count = self.samples.time_s.len();
        if count >= MAX_ROWS {
            return Err(RecordingError::TooManyRows {
                place: Place::line(path, line),
            });
        }
        let angle_place = || Place::cell(path, line, self.source.angle_column);
        let file_time_s = self.time(line, table, time_index)?;
        let number = match table.number(angle_index) {
            Ok(number) => number,
            Err(error @ (CellError::Empty | CellError::NotFinite { .. }))
                if self.source.max_gap_s > 0.0 && count > 0 =>
            {
                self.missing.get_or_insert((line, error));
                self.left_out += 1;
                return Ok(());
            }
            Err(error) => {
                return Err(RecordingError::Cell {
                    place: angle_place(),
                    error,
                });
            }
        };
        if count == 0 {
            self.first_time_s = file_time_s;
            self.samples.first_s = file_time_s;
        }
        let time_s = file_time_s - self.first_time_s;
        if let (Some(&before_s), Some(&before)) =
            (self.samples.time_s.last(), self.samples.angle_rad.last())
        {
            let place = || Place::cell(path, line, self.source.time_column);
            if time_s < before_s {
                return Err(RecordingError::TimeBackwards {
                    place: place(),
                    before_s: self.last_time_s,
                    after_s: file_time_s,
                });
            }
            if time_s == before_s {
                if number == before {
                    self.doubled.get_or_insert((line, 0)).1 += 1;
                    return Ok(());
                }
                return Err(RecordingError::TimeStill {
                    place: place(),
                    time_s: file_time_s,
                });
            }
            if let Some((line, _)) = self.missing.take()
                && time_s - before_s > self.source.max_gap_s
            {
                return Err(RecordingError::LongGap {
                    place: Place::cell(path, line, self.source.angle_column),
                    gap_s: time_s - before_s,
                    max_gap_s: self.source.max_gap_s,
                });
            }
        }
        self.lines.push(count, line);
        self.samples.time_s.push(time_s);
        self.samples.angle_rad.push(number);
        self.last_time_s = file_time_s;
        self.last_line = line;
        Ok(())
    }

    /// The time of a row in s, as the file counts it.
    fn time<R: Read>(
        &mut self,
        line: u64,
        table: &mut Table<R>,
        index: usize,
    ) -> Result<f64, RecordingError> {
        let place = || Place::cell(self.source.path, line, self.source.time_column);
        let time_s = if self.time_unit == TimeUnit::Clock {
            let cell = table.cell(index);
            let Some(of_day_s) = clock_s(cell) else {
                return Err(RecordingError::NotAClock {
                    place: place(),
                    text: shortened(cell),
                });
            };
            // Past midnight it begins again.
            if of_day_s + self.midnights < self.last_time_s - 0.5 * DAY_S {
                self.midnights += DAY_S;
            }
            of_day_s + self.midnights
        } else {
            let number = table.number(index).map_err(|error| RecordingError::Cell {
                place: place(),
                error,
            })?;
            self.time_unit.to_s(number)
        };
        if time_s.abs() > TIME_LIMIT_S {
            return Err(RecordingError::TimeOutOfRange {
                place: place(),
                value: time_s,
                limit: TIME_LIMIT_S,
            });
        }
        Ok(time_s)
    }

    /// The samples, once all rows are in.
    fn finish<R: Read>(
        mut self,
        table: &Table<R>,
        angle_index: usize,
    ) -> Result<Samples, RecordingError> {
        let path = self.source.path;
        let found = self.samples.time_s.len();
        if let Some((line, error)) = self.missing.take() {
            let place = Place::cell(path, line, self.source.angle_column);
            return Err(RecordingError::Cell { place, error });
        }
        if found == 0 {
            return Err(RecordingError::NoRows {
                place: Place::line(path, table.names_line()),
            });
        }
        if found < MIN_SAMPLES {
            let place = Place::line(path, self.last_line);
            return Err(RecordingError::TooFewSamples { place, found });
        }
        let doubled = self.doubled.map_or(0, |(_, count)| count);
        if let Some((line, count)) = self.doubled {
            let place = Place::line(path, line);
            let rows = if count == 1 { "row" } else { "rows" };
            self.samples.warnings.push(format!(
                "{place}: the row repeats the one before it, time and value; left out ({count} such {rows})"
            ));
        }
        let rows = (found + doubled + self.left_out) as u64;
        if let Some((line, declared)) = table.header().and_then(|header| header.rows)
            && declared != rows
        {
            let place = Place::line(path, line);
            self.samples.warnings.push(format!(
                "{place}: the header declares {declared} rows, the file has {rows}; it may have been cut"
            ));
        }
        let gap = self.gap();
        self.samples.warnings.extend(gap);
        let mut read_as = table.assumptions();
        read_as.append(&mut self.samples.read_as);
        self.samples.read_as = read_as;
        if self.left_out > 0 {
            let count = self.left_out;
            let note = format!("samples missing and bridged (max_gap_s): {count}");
            self.samples.read_as.push(note);
        }
        let header = table.header().and_then(|header| header.in_degrees.as_ref());
        self.samples.header_unit = header.map(|(.., is_deg)| {
            if *is_deg {
                AngleUnit::Deg
            } else {
                AngleUnit::Rad
            }
        });
        if let Quantity::Angles(angles) = &self.source.quantity {
            self.convert(angles, table, angle_index)?;
        }
        Ok(self.samples)
    }

    /// Angles in rad, once their unit is settled.
    fn convert<R: Read>(
        &mut self,
        angles: &Angles,
        table: &Table<R>,
        angle_index: usize,
    ) -> Result<(), RecordingError> {
        let Samples {
            time_s,
            angle_rad,
            warnings,
            read_as,
            ..
        } = &mut self.samples;
        let spread = Spread::of(angle_rad);
        let source = (self.source, angles);
        let unit = unit::settle(source, table, angle_index, &spread, (warnings, read_as))?;
        if let Some(index) = angle_rad
            .iter()
            .position(|angle| angle.abs() > unit.limit())
        {
            let line = self.lines.at(index);
            let value = angle_rad.get(index).copied().unwrap_or_default();
            return Err(RecordingError::AngleOutOfRange {
                place: Place::cell(self.source.path, line, self.source.angle_column),
                value,
                unit,
                is_mark: is_mark(value),
            });
        }
        let readings = Readings {
            source: self.source,
            angles,
            unit,
            time_s,
            number: angle_rad,
            lines: &self.lines,
        };
        warnings.extend(readings.warnings());
        for angle in angle_rad {
            *angle = unit.to_rad(*angle);
        }
        self.samples.unit = Some(unit);
        Ok(())
    }

    /// The longest of the gaps, in the times of the file.
    fn gap(&self) -> Option<String> {
        let median_interval_s = self.samples.median_interval_s()?;
        let gaps = self
            .samples
            .time_s
            .array_windows()
            .filter(|[before, after]| after - before > GAP_FACTOR * median_interval_s);
        let count = gaps.clone().count();
        let [from_s, to_s] = gaps.max_by(|[a, b], [c, d]| (b - a).total_cmp(&(d - c)))?;
        let gaps = if count == 1 {
            "gap"
        } else {
            "gaps, this is the longest"
        };
        Some(format!(
            "{}: no samples between {:.3} s and {:.3} s, where {} s is usual ({count} such {gaps}); the motion there \
             is a guess",
            Place::column_of(self.source, self.source.time_column),
            from_s + self.first_time_s,
            to_s + self.first_time_s,
            significant(median_interval_s)
        ))
    }
}

/// A time with three digits after the point, or three that are not zero.
fn significant(value: f64) -> String {
    let mut digits = 3;
    while digits < 12 && value.abs() * 10_f64.powi(digits) < 99.5 {
        digits += 1;
    }
    format!("{value:.*}", usize::try_from(digits).unwrap_or(3))
}

/// The position that `#4` names, from 1.
fn position(name: &str) -> Option<usize> {
    let number = name.strip_prefix('#')?.parse().ok()?;
    (number > 0).then_some(number)
}

fn find<R: Read>(
    source: &Source<'_>,
    table: &Table<R>,
    wanted: &str,
    role: &'static str,
) -> Result<usize, RecordingError> {
    let names = table.names();
    let place = Place::cell(source.path, table.names_line(), wanted);
    let mut matches = names
        .iter()
        .enumerate()
        .filter(|(_, name)| *name == wanted)
        .map(|(index, _)| index);
    match (matches.next(), matches.next()) {
        (Some(index), None) => Ok(index),
        (Some(first), Some(second)) => Err(RecordingError::RepeatedColumn {
            place,
            first: first + 1,
            second: second + 1,
        }),
        (None, _) => match position(wanted) {
            Some(position) if position <= names.len() => Ok(position - 1),
            _ => Err(RecordingError::MissingColumn {
                place,
                role,
                available: names.to_vec(),
            }),
        },
    }
}
