//! A recording that is open.

use crepitus_lesson::{By, Session};
use crepitus_live::{Bin, Envelope};
use crepitus_protocol::parameters::{Kind, PARAMETERS};
use crepitus_protocol::{TICKS_PER_S, Values};
use crepitus_recording::{Recording, named_values, seconds};
use serde_json::{Value, json};
use std::path::Path;

/// Samples of a bin that is kept: a millisecond.
const ROWS_PER_BIN: u32 = TICKS_PER_S / 1_000;

/// Most bins of a trace.
const MOST_POINTS: u16 = 10_000;

/// Longest time that is read again at once, s: what a screen of pixels needs in detail.
const LONGEST_DETAIL_S: f64 = 20.0;

/// Bins of a time.
pub(crate) struct Trace {
    pub(crate) begin_s: f64,
    pub(crate) bin_s: f64,
    pub(crate) bins: Vec<Bin>,
}

/// Samples of a part of it.
struct Detail {
    first: u64,
    rows: Vec<Bin>,
}

/// A recording, and the lowest and highest value of each of its milliseconds.
pub(crate) struct Opened {
    recording: Recording,
    /// Number of the first bin.
    first: u64,
    bins: Vec<Bin>,
    /// Part that was read in detail last.
    detail: Option<Detail>,
    breaks: u64,
}

impl Opened {
    /// Reads all of it once.
    pub(crate) fn new(recording: Recording) -> Result<Self, String> {
        let mut envelope = Envelope::new(ROWS_PER_BIN);
        let mut first = None;
        let mut bins: Vec<Bin> = Vec::new();
        let mut take = |(number, more): (u64, Vec<Bin>)| {
            if more.is_empty() {
                return;
            }
            let first = *first.get_or_insert(number);
            // A gap that the envelope has cut.
            let here = usize::try_from(number - first).unwrap_or(usize::MAX);
            if here > bins.len() && here < usize::MAX / 2 {
                bins.resize(here, Bin::GAP);
            }
            bins.extend(more);
        };
        for (row, count) in recording.rows().map_err(|e| e.to_string())?.zip(0_u64..) {
            envelope.take(&row.map_err(|e| e.to_string())?);
            if count.is_multiple_of(100_000) {
                take(envelope.complete());
            }
        }
        take(envelope.finish());
        let breaks = bins.iter().map(|bin| u64::from(bin.breaks)).sum();
        Ok(Self {
            recording,
            first: first.unwrap_or(0),
            bins,
            detail: None,
            breaks,
        })
    }

    fn begin_s(&self) -> f64 {
        seconds(self.first * u64::from(ROWS_PER_BIN))
    }

    fn end_s(&self) -> f64 {
        let count = u64::try_from(self.bins.len()).unwrap_or(0);
        seconds((self.first + count) * u64::from(ROWS_PER_BIN))
    }

    /// Facts about the recording.
    pub(crate) fn facts(&self) -> Value {
        let metadata = self.recording.metadata();
        let totals = &self.recording.books().totals;
        let parameters: Vec<_> = self.differing();
        json!({
            "title": metadata.title,
            "when": metadata.begun_unix_s,
            "begin_s": self.begin_s(),
            "end_s": self.end_s(),
            "seconds": seconds(totals.produced),
            "rows": totals.received,
            "missing": totals.dropped,
            "events": self.breaks,
            "device": serial(&metadata.comms.serial),
            "notes": notes(self.recording.path()),
            "warnings": self.recording.warnings(),
            "parameters": parameters,
            "changes": self.recording.parameters().changes()
                .map(|(row, text)| json!({ "row": row, "text": text }))
                .collect::<Vec<_>>(),
        })
    }

    /// The parameters at its begin that are not at their defaults.
    fn differing(&self) -> Vec<Value> {
        let defaults = named_values(&Values::default());
        let mut in_force = self.recording.parameters().in_force();
        in_force.at(0);
        (PARAMETERS.iter())
            .filter_map(|parameter| {
                let name = format!("{}.{}", parameter.group, parameter.key());
                let value = in_force.value(&name)?;
                if defaults.get(&name) == Some(value) {
                    return None;
                }
                let unit = match parameter.kind {
                    Kind::Number(spec) if spec.unit != "1" => Some(spec.unit),
                    _ => None,
                };
                Some(json!([name, value, unit]))
            })
            .collect()
    }

    /// About so many bins of a time.
    pub(crate) fn trace(&mut self, from_s: f64, to_s: f64, points: u16) -> Result<Trace, String> {
        let points = points.clamp(1, MOST_POINTS);
        let is_time = from_s.is_finite() && to_s.is_finite() && from_s < to_s;
        if !is_time {
            return Err("expected a time to show, from an earlier to a later one".to_owned());
        }
        let from_s = from_s.max(self.begin_s());
        let to_s = to_s.min(self.end_s()).max(from_s);
        let bin_s = (to_s - from_s) / f64::from(points);
        if bin_s >= seconds(u64::from(ROWS_PER_BIN)) || to_s - from_s > LONGEST_DETAIL_S {
            return Ok(joined(
                &self.bins,
                self.first,
                ROWS_PER_BIN,
                from_s,
                to_s,
                points,
            ));
        }
        let detail = self.detail(from_s, to_s)?;
        Ok(joined(&detail.rows, detail.first, 1, from_s, to_s, points))
    }

    /// The samples of a time, read again if they are not at hand.
    fn detail(&mut self, from_s: f64, to_s: f64) -> Result<&Detail, String> {
        let (from, to) = (tick(from_s), tick(to_s) + 1);
        let has = |detail: &Detail| {
            let end = detail.first + u64::try_from(detail.rows.len()).unwrap_or(0);
            detail.first <= from && to.min(tick(self.end_s())) <= end
        };
        if !self.detail.as_ref().is_some_and(has) {
            // More on both sides, for the next look.
            let more = to - from;
            let (from, to) = (from.saturating_sub(more), to + more);
            let mut envelope = Envelope::new(1);
            for row in self.recording.rows().map_err(|e| e.to_string())? {
                let row = row.map_err(|e| e.to_string())?;
                let at = tick(row.time_s);
                if at > to {
                    break;
                }
                if at >= from {
                    envelope.take(&row);
                }
            }
            let (first, rows) = envelope.finish();
            self.detail = Some(Detail { first, rows });
        }
        self.detail
            .as_ref()
            .ok_or_else(|| "nothing was read".to_owned())
    }
}

/// A serial number in hexadecimal, as text if it is one.
fn serial(hex: &str) -> String {
    let digits = hex.as_bytes().chunks(2);
    let bytes: Option<Vec<u8>> = digits
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok())
        .collect();
    let text = bytes.filter(|bytes| bytes.iter().all(u8::is_ascii_graphic));
    let text = text.and_then(|bytes| String::from_utf8(bytes).ok());
    text.unwrap_or_else(|| hex.to_owned())
}

/// Notes of the trial that a lesson has recorded in this file, on the file's time line.
fn notes(file: &Path) -> Vec<Value> {
    let session = file.parent().and_then(|folder| Session::read(folder).ok());
    let name = file.file_name().map(|name| name.to_string_lossy());
    let (Some(session), Some(name)) = (session, name) else {
        return Vec::new();
    };
    let recorded = session.recordings.iter().find(|one| one.file == *name);
    let Some(trial) = recorded.map(|one| one.trial) else {
        return Vec::new();
    };
    let notes = || {
        session
            .lesson
            .notes()
            .iter()
            .filter(|note| note.trial == trial)
    };
    // The lesson notes the begin of a trial, which is that of its recording.
    let Some(begin_s) = notes()
        .find(|note| note.by == By::Lesson)
        .map(|note| note.time_s)
    else {
        return Vec::new();
    };
    notes()
        .filter(|note| note.by == By::Teacher && note.time_s >= begin_s)
        .map(|note| json!({ "time_s": note.time_s - begin_s, "text": note.text }))
        .collect()
}

/// The tick of a time.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "times of a recording are at least 0, and it saturates"
)]
fn tick(time_s: f64) -> u64 {
    (time_s * f64::from(TICKS_PER_S)).round() as u64
}

/// Joins the bins of a time to at most `points`. A bin has `rows` rows; `first` is the number of the
/// first one.
fn joined(bins: &[Bin], first: u64, rows: u32, from_s: f64, to_s: f64, points: u16) -> Trace {
    let rows = u64::from(rows);
    let from = (tick(from_s) / rows).max(first);
    let to = (tick(to_s).div_ceil(rows)).max(from + 1);
    let per = (to - from).div_ceil(u64::from(points)).max(1);
    // Of whole bins, so that a picture does not change when it is moved.
    let from = (from / per * per).max(first);
    let skip = usize::try_from(from - first).unwrap_or(usize::MAX);
    let count = usize::try_from(to - from).unwrap_or(usize::MAX);
    let chunk = usize::try_from(per).unwrap_or(usize::MAX);
    let part: Vec<_> = bins.iter().skip(skip).take(count).copied().collect();
    let bins = part.chunks(chunk).map(|chunk| {
        let mut bin = Bin::GAP;
        for part in chunk {
            bin.join(part);
        }
        bin
    });
    Trace {
        begin_s: seconds(from * rows),
        bin_s: seconds(per * rows),
        bins: bins.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_live::Marks;
    use crepitus_recording::Row;

    fn bins(ticks: std::ops::Range<u64>, rows: u32) -> (u64, Vec<Bin>) {
        let mut envelope = Envelope::new(rows);
        for tick in ticks {
            #[expect(clippy::cast_precision_loss, reason = "small")]
            envelope.take(&Row {
                time_s: seconds(tick),
                torque_nm: tick as f32,
                ..Row::default()
            });
        }
        envelope.finish()
    }

    #[test]
    fn a_serial_number_is_shown_as_it_is_written() {
        assert_eq!(serial("53494d2d434f4d4d532d3031"), "SIM-COMMS-01");
        assert_eq!(serial("0001ff"), "0001ff");
        assert_eq!(serial("abc"), "abc");
    }

    #[test]
    fn a_trace_has_the_extremes_of_its_time() {
        let (first, all) = bins(0..20_000, 20);
        let trace = joined(&all, first, 20, 0.0, 1.0, 10);
        assert_eq!(
            (trace.begin_s, trace.bin_s, trace.bins.len()),
            (0.0, 0.1, 10)
        );
        for (bin, n) in trace.bins.iter().zip(0_u16..) {
            let low = f32::from(n) * 2_000.0;
            assert_eq!(
                (bin.torque_nm.low, bin.torque_nm.high),
                (low, low + 1_999.0)
            );
        }
    }

    #[test]
    fn every_sample_is_shown_where_there_is_room() {
        let (first, all) = bins(1_000..3_000, 1);
        let trace = joined(&all, first, 1, 0.1, 0.105, 500);
        assert_eq!(
            (trace.begin_s, trace.bin_s, trace.bins.len()),
            (0.1, 5e-5, 100)
        );
        assert_eq!(trace.bins[3].torque_nm.low, 2_003.0);
        assert_eq!(trace.bins[3].torque_nm.high, 2_003.0);
    }

    #[test]
    fn a_gap_stays_one() {
        let (first, mut all) = bins(0..2_000, 20);
        for bin in &mut all[40..60] {
            *bin = Bin::GAP;
        }
        let trace = joined(&all, first, 20, 0.0, 0.1, 10);
        let gaps: Vec<_> = trace
            .bins
            .iter()
            .map(|b| b.marks.0 & Marks::GAP != 0)
            .collect();
        assert_eq!(
            gaps,
            [
                false, false, false, false, true, true, false, false, false, false
            ]
        );
    }

    #[test]
    fn a_time_beyond_the_end_has_no_bins() {
        let (first, all) = bins(0..2_000, 20);
        assert!(joined(&all, first, 20, 5.0, 6.0, 10).bins.is_empty());
    }
}
