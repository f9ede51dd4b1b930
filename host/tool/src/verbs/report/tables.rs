//! The tables of a recording's report.

use crate::sections::{section, torque_section};
use crepitus_recording::{Controller, ParameterSet, RecordingSummary, Sidecar, seconds};
use crepitus_report::Section;
use serde_json::Value;

/// Gaps that are shown.
const SHOWN_GAPS: usize = 20;

pub(super) fn sections(s: &RecordingSummary, sidecar: &Sidecar) -> Vec<Section> {
    let mut sections = vec![recording(s)];
    sections.extend(
        s.model_torque
            .map(|t| torque_section("Torque of the model while armed", &t)),
    );
    sections.extend(
        s.torque
            .map(|t| torque_section("Torque commanded to the motor while armed", &t)),
    );
    if !s.limited_s.is_empty() {
        let rows = s
            .limited_s
            .iter()
            .map(|(reason, time_s)| ((*reason).to_owned(), format!("{time_s:.3} s")));
        sections.push(section("What limited the torque", rows));
    }
    let mut before: Option<&ParameterSet> = None;
    for set in &s.parameters {
        sections.push(parameters(set, before, sidecar));
        before = Some(set);
    }
    if !sidecar.drops.is_empty() {
        let rows = sidecar.drops.iter().take(SHOWN_GAPS).map(|gap| {
            (
                format!("from tick {}", gap.first_tick),
                format!("{} samples, {:.4} s", gap.samples, seconds(gap.samples)),
            )
        });
        sections.push(section("Missing samples", rows));
    }
    sections
}

fn recording(s: &RecordingSummary) -> Section {
    let device = |c: &Controller| format!("{} (serial {})", c.version, c.serial);
    let t = &s.telemetry;
    let mut rows = vec![
        ("length", format!("{:.3} s", s.duration_s)),
        ("armed", format!("{:.3} s", s.armed_s)),
        (
            "samples",
            format!(
                "{} produced = {} received + {} dropped",
                t.produced, t.received, t.dropped
            ),
        ),
        (
            "events while armed",
            format!("{} breaks, {} sticks", s.breaks, s.sticks),
        ),
        (
            "highest speed",
            format!("{:.1} °/s", s.fastest_rad_s.to_degrees()),
        ),
        ("comms", device(&s.comms)),
    ];
    rows.extend(s.drive.as_ref().map(|drive| ("drive", device(drive))));
    if s.lost_samples > 0 {
        rows.push(("rejected counts", s.lost_samples.to_string()));
    }
    if s.late_ticks > 0 {
        rows.push(("late ticks", s.late_ticks.to_string()));
    }
    section("Recording", rows)
}

/// All of the first set, and of each later one what has changed.
fn parameters(set: &ParameterSet, before: Option<&ParameterSet>, sidecar: &Sidecar) -> Section {
    let begin = sidecar
        .parameters
        .first()
        .map_or(0, |first| first.first_tick);
    let at_s = seconds(set.first_tick.saturating_sub(begin));
    let title = match before {
        None => format!("Parameters: revision {}", set.revision),
        Some(_) => format!("Revision {}, from {at_s:.3} s on", set.revision),
    };
    let rows = set
        .values
        .iter()
        .filter(|(name, value)| before.is_none_or(|before| before.values.get(*name) != Some(value)))
        .map(|(name, value)| (name.clone(), shown(value)));
    section(&title, rows)
}

fn shown(value: &Value) -> String {
    match value {
        Value::String(name) => name.clone(),
        other => other.to_string(),
    }
}
