//! Voltage and current of a coil over time, evenly sampled.

use std::fmt::Write;
use std::io;

/// Highest sampling rate that is kept, Hz; faster recordings are averaged down.
const KEPT_PER_S: f64 = 4000.0;

/// Lowest sampling rate, Hz, and shortest recording, s.
const SLOWEST_PER_S: f64 = 500.0;
const SHORTEST_S: f64 = 0.5;

/// Tolerated jitter of a sampling time, as a share of the sampling interval.
const UNEVEN: f64 = 0.25;

/// Column of the time for which a voltage is held, s.
const HOLD: &str = "hold_s";

/// Voltage and current of a coil, sample by sample.
///
/// Each sample may be the value at an instant or the mean since the last one, as
/// long as both are taken alike: an average of both over the same time
/// leaves the impedance between them as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    step_s: f64,
    volts: Vec<f64>,
    amperes: Vec<f64>,
    hold: Option<Hold>,
}

/// Zero-order hold of the voltage between ticks, whose images alias into the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// Hold time, s.
    pub tick_s: f64,
    /// Meaning of a current sample.
    pub current: Current,
}

/// Meaning of a current sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Current {
    /// Mean since the last sample.
    Mean,
    /// Mean of the values at the ticks since the last sample.
    Ticks,
}

impl Hold {
    /// Factor by which the sampled voltage drives the coil at ω: with x = ω·tick/2, sin(x)/x
    /// is that of the hold; a mean over the time of a sample, where one over
    /// ticks is expected, is another such factor.
    pub(crate) fn factor(&self, omega: f64) -> f64 {
        let x = 0.5 * omega * self.tick_s;
        let of_hold = if x > 0.0 { x.sin() / x } else { 1.0 };
        match self.current {
            Current::Mean => of_hold * of_hold,
            Current::Ticks => of_hold,
        }
    }
}

/// Reason why numbers are no recording of a coil.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SeriesError {
    /// Not readable as CSV.
    #[error("cannot be read as CSV: {0}")]
    Csv(#[from] csv::Error),
    /// A column is missing.
    #[error("has no column {name:?}: expected the columns t_s, volts, amperes")]
    Column {
        /// Name of the column.
        name: &'static str,
    },
    /// A field is not a finite number.
    #[error("line {line}: {column} = {text:?} is not a finite number")]
    Number {
        /// Line of the file, from 1.
        line: u64,
        /// The column.
        column: &'static str,
        /// The field.
        text: String,
    },
    /// Times do not have one distance.
    #[error(
        "line {line}: t_s = {time_s} is not evenly spaced: expected {expected_s:.7}; resample the recording"
    )]
    Uneven {
        /// Line of the file, from 1.
        line: u64,
        /// The time, s.
        time_s: f64,
        /// Expected time, s.
        expected_s: f64,
    },
    /// Voltage and current are of different length, or not finite.
    #[error("expected as many voltages as currents, all finite")]
    Unequal,
    /// The voltage is held for longer than a row, or for no time.
    #[error(
        "hold_s = {hold_s}: expected the time for which a voltage is held, above 0 and at most that between two \
         rows, {step_s:.7} s; or leave the column out"
    )]
    Hold {
        /// The value, s.
        hold_s: f64,
        /// Sampling interval, s.
        step_s: f64,
    },
    /// Too slow, or no time at all between samples.
    #[error("one sample every {step_s} s: expected at least {SLOWEST_PER_S} per second")]
    Slow {
        /// Sampling interval, s.
        step_s: f64,
    },
    /// Too short.
    #[error("{duration_s:.3} s are too short: expected at least {SHORTEST_S} s")]
    Short {
        /// Length of the series, s.
        duration_s: f64,
    },
}

impl Series {
    /// Creates a recording of samples `step_s` apart, s.
    ///
    /// # Errors
    /// [`SeriesError`] if they are too few, too slow or not finite.
    pub fn new(step_s: f64, volts: &[f64], amperes: &[f64]) -> Result<Self, SeriesError> {
        if volts.len() != amperes.len() || volts.iter().chain(amperes).any(|x| !x.is_finite()) {
            return Err(SeriesError::Unequal);
        }
        if !(step_s > 0.0 && step_s * SLOWEST_PER_S <= 1.000_001) {
            return Err(SeriesError::Slow { step_s });
        }
        let duration_s = step_s * volts.len() as f64;
        if duration_s < SHORTEST_S {
            return Err(SeriesError::Short { duration_s });
        }
        // Whole samples, at least one.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small positive number"
        )]
        let together = (1.0 / (step_s * KEPT_PER_S) + 1e-6).clamp(1.0, 1e6) as usize;
        Ok(Self {
            step_s: step_s * together as f64,
            volts: means(volts, together),
            amperes: means(amperes, together),
            hold: None,
        })
    }

    /// Marks the voltage as held between ticks.
    #[must_use]
    pub fn held(self, hold: Hold) -> Self {
        Self {
            hold: Some(hold),
            ..self
        }
    }

    /// Returns the hold of the voltage, if there was one.
    pub(crate) fn hold(&self) -> Option<Hold> {
        self.hold
    }

    /// Writes what [`Series::from_csv`] reads, with the hold.
    pub fn to_csv(&self) -> String {
        // Without its hold the same recording has another inductance and delay.
        let (name, value) = self.hold.map_or_else(Default::default, |hold| {
            (format!(",{HOLD}"), format!(",{}", hold.tick_s))
        });
        let mut text = format!("t_s,volts,amperes{name}\n");
        for (i, (volts, amperes)) in self.volts.iter().zip(&self.amperes).enumerate() {
            let time_s = i as f64 * self.step_s;
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{time_s:.6},{volts:.7},{amperes:.6}{value}");
        }
        text
    }

    /// Reads the columns `t_s`, `volts` and `amperes` of a CSV file, and `hold_s` if it is there:
    /// the time of a tick whose voltage is held, with `amperes` the mean of the values at the
    /// ticks.
    ///
    /// # Errors
    /// [`SeriesError`] with the line.
    pub fn from_csv(file: impl io::Read) -> Result<Self, SeriesError> {
        const NAMES: [&str; 3] = ["t_s", "volts", "amperes"];
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(file);
        let headers = reader.headers()?.clone();
        let mut places = [0; 3];
        for (place, name) in places.iter_mut().zip(NAMES) {
            *place = (headers.iter().position(|header| header == name))
                .ok_or(SeriesError::Column { name })?;
        }
        let place_of_hold = headers.iter().position(|header| header == HOLD);
        let mut hold_s = None;
        let mut columns: [Vec<f64>; 3] = Default::default();
        let mut lines = Vec::new();
        for record in reader.records() {
            let record = record?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |place: usize, column| {
                let text = record.get(place).unwrap_or_default();
                match text.parse::<f64>() {
                    Ok(value) if value.is_finite() => Ok(value),
                    _ => Err(SeriesError::Number {
                        line,
                        column,
                        text: text.to_owned(),
                    }),
                }
            };
            for ((values, place), column) in columns.iter_mut().zip(places).zip(NAMES) {
                values.push(number(place, column)?);
            }
            // The hold is the same in every row.
            if let (None, Some(place)) = (hold_s, place_of_hold) {
                hold_s = Some(number(place, HOLD)?);
            }
            lines.push(line);
        }
        let [times_s, volts, amperes] = columns;
        let step_s = even(&times_s, &lines)?;
        let series = Self::new(step_s, &volts, &amperes)?;
        match hold_s {
            None => Ok(series),
            // The interval is a mean of rounded times.
            Some(tick_s) if tick_s > 0.0 && tick_s <= step_s * (1.0 + 1e-6) => {
                Ok(series.held(Hold {
                    tick_s,
                    current: Current::Ticks,
                }))
            }
            Some(hold_s) => Err(SeriesError::Hold { hold_s, step_s }),
        }
    }

    /// Sampling interval, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Voltages, V.
    pub fn volts(&self) -> &[f64] {
        &self.volts
    }

    /// Currents, A.
    pub fn amperes(&self) -> &[f64] {
        &self.amperes
    }

    /// Duration, s.
    pub fn duration_s(&self) -> f64 {
        self.step_s * self.volts.len() as f64
    }
}

/// Returns the sampling interval, s; rejects uneven times.
fn even(times_s: &[f64], lines: &[u64]) -> Result<f64, SeriesError> {
    let (Some(first), Some(last)) = (times_s.first(), times_s.last()) else {
        return Err(SeriesError::Short { duration_s: 0.0 });
    };
    let step_s = (last - first) / (times_s.len() - 1).max(1) as f64;
    for (i, (time_s, line)) in times_s.iter().zip(lines).enumerate() {
        let expected_s = first + step_s * i as f64;
        if (time_s - expected_s).abs() > UNEVEN * step_s {
            return Err(SeriesError::Uneven {
                line: *line,
                time_s: *time_s,
                expected_s,
            });
        }
    }
    Ok(step_s)
}

/// Averages `together` neighbours each.
fn means(values: &[f64], together: usize) -> Vec<f64> {
    values
        .chunks_exact(together)
        .map(|chunk| chunk.iter().sum::<f64>() / together as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn csv_of(rows: usize, time_s: impl Fn(usize) -> f64) -> String {
        let mut text = "amperes,t_s , volts\n".to_owned();
        for i in 0..rows {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{i},{},{}", time_s(i), 2 * i);
        }
        text
    }

    #[test]
    fn columns_are_found_by_name_and_fast_samples_averaged() {
        // Halves of 250 µs.
        let text = csv_of(8000, |i| 3.0 + 125e-6 * i as f64);
        let series = Series::from_csv(text.as_bytes()).unwrap();
        assert!((series.step_s() - 250e-6).abs() < 1e-12);
        assert_eq!(series.volts().len(), 4000);
        assert_eq!((series.amperes()[0], series.amperes()[1]), (0.5, 2.5));
        assert_eq!(series.volts()[1], 5.0);
        assert!((series.duration_s() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_held_voltage_is_less_than_its_samples_at_high_frequencies() {
        let hold = |current| Hold {
            tick_s: 5e-5,
            current,
        };
        let omega = std::f64::consts::TAU * 500.0;
        let x = 0.5 * omega * 5e-5;
        let of_hold = x.sin() / x;
        assert!((hold(Current::Ticks).factor(omega) - of_hold).abs() < 1e-15);
        assert!((hold(Current::Mean).factor(omega) - of_hold * of_hold).abs() < 1e-15);
        assert_eq!(hold(Current::Mean).factor(0.0), 1.0);
    }

    #[test]
    fn a_written_recording_is_read_with_its_hold() {
        let volts: Vec<f64> = (0..4000).map(|i| 0.125 * f64::from(i)).collect();
        let series = Series::new(250e-6, &volts, &vec![0.125; 4000]).unwrap();
        let of_bench = Series::from_csv(series.to_csv().as_bytes()).unwrap();
        assert_eq!(of_bench.hold(), None);
        let held = series.held(Hold {
            tick_s: 5e-5,
            current: Current::Ticks,
        });
        let text = held.to_csv();
        let read = Series::from_csv(text.as_bytes()).unwrap();
        assert_eq!(read.hold(), held.hold());
        assert_eq!(read.volts(), held.volts());
        assert_eq!(read.amperes(), held.amperes());
        assert!((read.step_s() - held.step_s()).abs() < 1e-9);
        // Longer than a row; no time at all.
        for hold_s in ["0.5", "0"] {
            let wrong = text.replace(",0.00005\n", &format!(",{hold_s}\n"));
            let error = Series::from_csv(wrong.as_bytes()).unwrap_err();
            assert!(error.to_string().contains("hold_s"), "{error}");
        }
    }

    #[test]
    fn bad_files_are_refused_with_their_line() {
        let message = |text: &str| Series::from_csv(text.as_bytes()).unwrap_err().to_string();
        assert!(message("t_s,volts\n").contains("amperes"));
        assert!(message("").contains("t_s"));
        assert!(message("t_s,volts,amperes\n").contains("too short"));
        let even = csv_of(4000, |i| 250e-6 * i as f64);
        assert!(Series::from_csv(even.as_bytes()).is_ok());
        assert!(
            message(&even.replace("\n7,", "\nseven,")).starts_with("line 9: amperes = \"seven\"")
        );
        assert!(message(&even.replace("\n7,", "\nNaN,")).starts_with("line 9"));
        let late = csv_of(4000, |i| {
            250e-6 * i as f64 + if i == 7 { 1e-4 } else { 0.0 }
        });
        assert!(
            message(&late).starts_with("line 9: t_s"),
            "{}",
            message(&late)
        );
        assert!(message(&csv_of(100, |i| 250e-6 * i as f64)).contains("too short"));
        assert!(message(&csv_of(100, |i| 0.01 * i as f64)).contains("at least 500 per second"));
        assert!(message(&csv_of(100, |_| 0.0)).contains("at least 500 per second"));
        assert!(Series::new(1e-3, &[0.0; 900], &[0.0; 901]).is_err());
        assert!(Series::new(1e-3, &[0.0; 900], &[f64::NAN; 900]).is_err());
    }
}
