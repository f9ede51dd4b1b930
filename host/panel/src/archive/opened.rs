//! A recording that is open.

use crate::lesson::{By, Knee, Session};
use crate::live::{Bin, Bins};
use crepitus_protocol::parameters::{Kind, PARAMETERS};
use crepitus_protocol::{TICKS_PER_S, Values};
use crepitus_recording::{Recording, named_values, seconds};
use crepitus_scene::preset::{Preset, shipped};
use crepitus_scene::values::{knee, with_preset};
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

/// Bins with their numbers, in order; none where the recording has no samples. So its length is that
/// of the file, whatever times stand in it.
type Numbered = Vec<(u64, Bin)>;

/// Samples of a part of it.
struct Detail {
    /// The ticks that were read.
    from: u64,
    to: u64,
    rows: Numbered,
}

/// A recording, and the lowest and highest value of each of its milliseconds.
pub(crate) struct Opened {
    recording: Recording,
    bins: Numbered,
    /// Part that was read in detail last.
    detail: Option<Detail>,
    breaks: u64,
}

impl Opened {
    /// Reads all of it once.
    pub(crate) fn new(recording: Recording) -> Result<Self, String> {
        let mut open = Bins::new(ROWS_PER_BIN);
        let mut bins = Numbered::new();
        for row in recording.rows().map_err(|e| e.to_string())? {
            bins.extend(open.take(&row.map_err(|e| e.to_string())?));
        }
        bins.extend(open.finish());
        let breaks = bins.iter().map(|(_, bin)| u64::from(bin.breaks)).sum();
        Ok(Self {
            recording,
            bins,
            detail: None,
            breaks,
        })
    }

    fn begin_s(&self) -> f64 {
        let first = self.bins.first().map_or(0, |(number, _)| *number);
        seconds(first * u64::from(ROWS_PER_BIN))
    }

    fn end_s(&self) -> f64 {
        let end = self.bins.last().map_or(0, |(number, _)| number + 1);
        seconds(end * u64::from(ROWS_PER_BIN))
    }

    /// Facts about the recording.
    pub(crate) fn facts(&self) -> Value {
        let metadata = self.recording.metadata();
        let totals = &self.recording.accounting().totals;
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
            "knee": self.knee(),
            "changes": self.recording.parameters().changes()
                .map(|(row, text)| json!({ "row": row, "text": text }))
                .collect::<Vec<_>>(),
        })
    }

    /// The knee at its begin, if it is one that ships.
    fn knee(&self) -> Option<Knee> {
        let mut in_force = self.recording.parameters().in_force();
        in_force.at(0);
        let values = in_force.values()?;
        if knee(&values).is_ok_and(|knee| knee.effects().next().is_none()) {
            return Some(Knee::healthy());
        }
        let is_it = |preset: &&Preset| with_preset(&values, preset, false) == values;
        shipped().iter().find(is_it).map(Knee::from)
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
            return Ok(joined(&self.bins, ROWS_PER_BIN, from_s, to_s, points));
        }
        let detail = self.detail(from_s, to_s)?;
        Ok(joined(&detail.rows, 1, from_s, to_s, points))
    }

    /// The samples of a time, read again if they are not at hand.
    fn detail(&mut self, from_s: f64, to_s: f64) -> Result<&Detail, String> {
        let (from, to) = (tick(from_s), tick(to_s) + 1);
        let has = |detail: &Detail| detail.from <= from && to <= detail.to;
        if !self.detail.as_ref().is_some_and(has) {
            // More on both sides, for the next look.
            let more = to - from;
            let (from, to) = (from.saturating_sub(more), to + more);
            let mut open = Bins::new(1);
            let mut rows = Numbered::new();
            for row in self.recording.rows().map_err(|e| e.to_string())? {
                let row = row.map_err(|e| e.to_string())?;
                let at = tick(row.time_s);
                if at > to {
                    break;
                }
                if at >= from {
                    rows.extend(open.take(&row));
                }
            }
            rows.extend(open.finish());
            self.detail = Some(Detail { from, to, rows });
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
    // The lesson notes the begin of a trial, which is that of its recording: of one that was started again, the last.
    let mut begin_s = None;
    let mut notes = Vec::new();
    for note in session.lesson.notes() {
        if note.trial != trial {
            continue;
        }
        if note.by == By::Lesson {
            begin_s = Some(note.time_s);
            notes.clear();
        } else if let Some(begin_s) = begin_s
            && note.time_s >= begin_s
        {
            notes.push(json!({ "time_s": note.time_s - begin_s, "text": note.text }));
        }
    }
    notes
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

/// Joins the bins of a time, each of `rows` rows, to at most `points`.
fn joined(bins: &[(u64, Bin)], rows: u32, from_s: f64, to_s: f64, points: u16) -> Trace {
    let rows = u64::from(rows);
    let first = bins.first().map_or(0, |(number, _)| *number);
    let end = bins.last().map_or(0, |(number, _)| number + 1);
    let from = (tick(from_s) / rows).max(first);
    let to = (tick(to_s).div_ceil(rows)).max(from + 1);
    let per = (to - from).div_ceil(u64::from(points)).max(1);
    // Of whole bins, so that a picture does not change when it is moved.
    let from = (from / per * per).max(first);
    let to = to.min(end).max(from);
    let place = |number: u64| usize::try_from((number - from) / per).unwrap_or(usize::MAX);
    let mut all = vec![Bin::gap(); place(to + per - 1)];
    let skip = bins.partition_point(|(number, _)| *number < from);
    for (number, bin) in bins
        .iter()
        .skip(skip)
        .take_while(|(number, _)| *number < to)
    {
        if let Some(joined) = all.get_mut(place(*number)) {
            joined.join(bin);
        }
    }
    Trace {
        begin_s: seconds(from * rows),
        bin_s: seconds(per * rows),
        bins: all,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::Marks;
    use crepitus_recording::Row;

    fn bins(ticks: impl Iterator<Item = u64>, rows: u32) -> Numbered {
        let mut open = Bins::new(rows);
        let mut bins = Numbered::new();
        for tick in ticks {
            #[expect(clippy::cast_precision_loss, reason = "small")]
            bins.extend(open.take(&Row {
                time_s: seconds(tick),
                torque_nm: tick as f32,
                ..Row::default()
            }));
        }
        bins.extend(open.finish());
        bins
    }

    #[test]
    fn a_serial_number_is_shown_as_it_is_written() {
        assert_eq!(serial("53494d2d434f4d4d532d3031"), "SIM-COMMS-01");
        assert_eq!(serial("0001ff"), "0001ff");
        assert_eq!(serial("abc"), "abc");
    }

    #[test]
    fn a_trace_has_the_extremes_of_its_time() {
        let all = bins(0..20_000, 20);
        let trace = joined(&all, 20, 0.0, 1.0, 10);
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
        let all = bins(1_000..3_000, 1);
        let trace = joined(&all, 1, 0.1, 0.105, 500);
        assert_eq!(
            (trace.begin_s, trace.bin_s, trace.bins.len()),
            (0.1, 5e-5, 100)
        );
        assert_eq!(trace.bins[3].torque_nm.low, 2_003.0);
        assert_eq!(trace.bins[3].torque_nm.high, 2_003.0);
    }

    #[test]
    fn a_gap_stays_one() {
        let all = bins((0..800).chain(1_200..2_000), 20);
        let trace = joined(&all, 20, 0.0, 0.1, 10);
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

    /// Rows before and after a gap are shown, however long it is, and nothing is kept for it.
    #[test]
    fn a_gap_of_centuries_takes_no_memory() {
        for gap in [25 * 20_000, 86_400 * 20_000, 1 << 47] {
            let end = gap + 2_000;
            let all = bins((0..1_000).chain(gap..end), 20);
            assert_eq!(all.len(), 50 + 100 + usize::from(gap % 20 != 0));
            let trace = joined(&all, 20, 0.0, seconds(end), 1_000);
            assert!(trace.bins.len() <= 1_000, "{}", trace.bins.len());
            let shown = |bin: &&Bin| bin.marks.0 & Marks::GAP == 0;
            assert_eq!(trace.bins.iter().find(shown).unwrap().torque_nm.low, 0.0);
            #[expect(clippy::cast_precision_loss, reason = "as the fixture")]
            let last = (end - 1) as f32;
            let shown = trace.bins.iter().rev().find(shown).unwrap();
            assert_eq!(shown.torque_nm.high, last);
        }
    }

    #[test]
    fn a_time_beyond_the_end_has_no_bins() {
        let all = bins(0..2_000, 20);
        assert!(joined(&all, 20, 5.0, 6.0, 10).bins.is_empty());
    }
}
