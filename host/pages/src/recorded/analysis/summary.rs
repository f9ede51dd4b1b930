//! The summary of a recording.

use crepitus_knee::Examination;
use crepitus_knee::examination::Measure;
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{LimitReason, TICK_S};
use crepitus_recording::Controller;
use crepitus_recording::Ending;
use crepitus_recording::History;
use crepitus_recording::Row;
use crepitus_recording::Totals;
use crepitus_recording::{Recording, seconds};
use crepitus_scene::run::{TorqueSummary, TorqueTally};
use serde::Serialize;
use std::collections::BTreeMap;

/// Totals of a recording: its `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct RecordingSummary {
    /// Identifier of this recording alone.
    pub id: String,
    /// Subject of the recording, in words.
    pub title: String,
    /// Version of the program that has made this summary.
    pub crepitus_version: &'static str,
    /// Start of the recording, seconds since 1970.
    pub begun_unix_s: u64,
    /// The comms controller.
    pub comms: Controller,
    /// The drive controller.
    pub drive: Option<Controller>,
    /// True if the recording was finished, not cut off, and nothing is missing at its end.
    pub complete: bool,
    /// End of the recording; null if its program did not note it.
    pub ending: Option<Ending>,
    /// Samples that the device had produced by then and that did not arrive.
    pub missing_at_end: u64,
    /// Recorded time, s: that of its samples.
    pub duration_s: f64,
    /// Time from the first to the last sample, s, gaps included; a restart of the drive takes
    /// none in it.
    pub span_s: f64,
    /// Recorded time while armed, s.
    pub armed_s: f64,
    /// Samples produced, received and dropped.
    pub telemetry: Totals,
    /// Number of gaps.
    pub gaps: u64,
    /// Starts of the drive during the recording.
    pub drive_restarts: u32,
    /// Breaks while armed.
    pub breaks: u64,
    /// Sticks while armed.
    pub sticks: u64,
    /// Highest speed of the joint, rad/s.
    pub fastest_rad_s: f64,
    /// Torque of the model while armed.
    pub model_torque: Option<TorqueSummary>,
    /// Torque commanded to the motor while armed.
    pub torque: Option<TorqueSummary>,
    /// Measures of the examination by their [keys](crepitus_knee::examination::MeasureSpec::key): of all the
    /// time in which the motor was driven. Those that there are.
    pub examination: BTreeMap<&'static str, f64>,
    /// Armed time in which each reason limited the torque, s.
    pub limited_s: BTreeMap<&'static str, f64>,
    /// Samples that were received and whose count of the encoder the drive had rejected.
    pub rejected_counts: u64,
    /// Ticks whose rendering was late.
    pub late_ticks: u64,
    /// Every parameter set in use, in order: all parameters, then those that
    /// have changed.
    pub parameters: History,
    /// Warnings to read before relying on the numbers.
    pub warnings: Vec<String>,
}

/// Running totals of rows.
#[derive(Debug, Default)]
pub(super) struct Tally {
    rows: u64,
    /// Times of the first and the last row, s.
    ends_s: Option<(f64, f64)>,
    armed_rows: u64,
    /// Torques of the armed rows: of the model, and commanded.
    model: TorqueTally,
    commanded: TorqueTally,
    breaks: u64,
    sticks: u64,
    fastest_rad_s: f64,
    examination: Examination,
    limited: BTreeMap<&'static str, u64>,
    lost: u64,
    late: u64,
}

impl Tally {
    pub(super) fn row(&mut self, row: &Row) {
        let flags = row.flags;
        self.rows += 1;
        let first_s = self.ends_s.map_or(row.time_s, |(first_s, _)| first_s);
        self.ends_s = Some((first_s, row.time_s));
        self.fastest_rad_s = self.fastest_rad_s.max(f64::from(row.omega_rad_s.abs()));
        self.lost += u64::from(flags.has(SampleFlags::LOST));
        self.late += u64::from(flags.has(SampleFlags::LATE));
        row.examined_by(&mut self.examination);
        if flags.limit() == LimitReason::NotArmed {
            return;
        }
        self.breaks += u64::from(flags.has(SampleFlags::BREAK));
        self.sticks += u64::from(flags.has(SampleFlags::STICK));
        self.armed_rows += 1;
        self.model.add(f64::from(row.model_torque_nm));
        self.commanded.add(f64::from(row.torque_nm));
        if flags.limit() != LimitReason::None {
            *self.limited.entry(flags.limit().name()).or_default() += 1;
        }
    }

    pub(super) fn finish(
        self,
        recording: &Recording,
        differences: Vec<String>,
    ) -> RecordingSummary {
        let (metadata, accounting) = (recording.metadata(), recording.accounting());
        let mut warnings = recording.warnings();
        warnings.extend(
            differences
                .into_iter()
                .map(|difference| format!("Counted in its rows: {difference}.")),
        );
        warnings.extend(restarts(accounting.drive_restarts));
        if self.armed_rows == 0 && self.rows > 0 {
            warnings.push("The device was never armed, so there was no torque.".to_owned());
        }
        let torque = |tally: TorqueTally| {
            (self.armed_rows > 0).then(|| tally.summary(seconds(self.armed_rows) / TICK_S))
        };
        RecordingSummary {
            id: metadata.id.clone(),
            title: metadata.title.clone(),
            crepitus_version: env!("CARGO_PKG_VERSION"),
            begun_unix_s: metadata.begun_unix_s,
            comms: metadata.comms.clone(),
            drive: metadata.drive.clone(),
            complete: recording.is_complete(),
            ending: recording.ending().cloned(),
            missing_at_end: accounting.missing_at_end,
            duration_s: seconds(self.rows),
            span_s: self
                .ends_s
                .map_or(0.0, |(first_s, last_s)| last_s - first_s + TICK_S),
            armed_s: seconds(self.armed_rows),
            telemetry: accounting.totals,
            gaps: accounting.gap_count,
            drive_restarts: accounting.drive_restarts,
            breaks: self.breaks,
            sticks: self.sticks,
            fastest_rad_s: self.fastest_rad_s,
            model_torque: torque(self.model),
            torque: torque(self.commanded),
            examination: Measure::ALL
                .into_iter()
                .filter_map(|measure| {
                    let value = self.examination.measure(measure)?;
                    Some((measure.spec().key, value))
                })
                .collect(),
            limited_s: self
                .limited
                .into_iter()
                .map(|(reason, ticks)| (reason, seconds(ticks)))
                .collect(),
            rejected_counts: self.lost,
            late_ticks: self.late,
            parameters: recording.parameters().clone(),
            warnings,
        }
    }
}

fn restarts(count: u32) -> Option<String> {
    let (times, each) = match count {
        0 => return None,
        1 => ("once".to_owned(), "that"),
        _ => (format!("{count} times"), "each"),
    };
    Some(format!(
        "The drive restarted {times} during the recording; how long {each} took is not known."
    ))
}
