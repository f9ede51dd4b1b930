//! The tables of a recording's report.

use crate::measures::shown as shown_measure;
use crate::sections::{counts, section, torque_section};
use crepitus_knee::examination::Measure;
use crepitus_pages::plot::number::{count, rounded};
use crepitus_pages::recorded::RecordingSummary;
use crepitus_pages::report::Section;
use crepitus_recording::{Controller, ParameterSet, SampleAccounting, seconds};
use serde_json::Value;

/// Gaps that are shown.
const SHOWN_GAPS: usize = 20;

/// `changed_at_s`: when each parameter set took effect.
pub(super) fn sections(
    s: &RecordingSummary,
    accounting: &SampleAccounting,
    changed_at_s: &[f64],
) -> Vec<Section> {
    let mut sections: Vec<_> = missing(accounting).into_iter().collect();
    sections.push(recording(s));
    sections.extend(
        s.model_torque
            .map(|t| torque_section("Torque of the model while armed", &t)),
    );
    sections.extend(
        s.torque
            .map(|t| torque_section("Torque commanded to the motor while armed", &t)),
    );
    sections.extend(examination(s));
    if !s.limited_s.is_empty() {
        let rows = s
            .limited_s
            .iter()
            .map(|(reason, time_s)| ((*reason).to_owned(), format!("{time_s:.3} s")));
        sections.push(section("What limited the torque", rows));
    }
    for (n, (set, at_s)) in s.parameters.0.iter().zip(changed_at_s).enumerate() {
        sections.push(parameters(set, (n > 0).then_some(*at_s)));
    }
    sections
}

/// Measures that a physiotherapist would note; none of a leg that was not moved.
fn examination(s: &RecordingSummary) -> Option<Section> {
    let rows: Vec<_> = (Measure::ALL.iter())
        .filter_map(|measure| {
            let spec = measure.spec();
            let value = shown_measure(spec, *s.examination.get(spec.key)?);
            Some((spec.label, format!("{value}: {}", spec.meaning)))
        })
        .collect();
    (!rows.is_empty()).then(|| section("Examination, while the motor was on", rows))
}

/// Sentences on what was felt, and on whether all of it is here.
pub(super) fn first_sentences(s: &RecordingSummary) -> String {
    let felt = match &s.model_torque {
        Some(torque) => format!(
            "In {:.1} s with the motor on, the knee's torque went from {} to {} N·m, with the leg at up to {:.0} °/s{}.",
            s.armed_s,
            rounded(torque.min_nm),
            rounded(torque.max_nm),
            s.fastest_rad_s.to_degrees(),
            match s.breaks {
                0 => String::new(),
                n => format!(", and it broke loose {n} times"),
            }
        ),
        None => "The motor was off all the time: nothing was rendered.".to_owned(),
    };
    let t = &s.telemetry;
    let lost = t.produced.saturating_sub(t.received) + s.missing_at_end;
    let all = count(t.produced + s.missing_at_end);
    match lost {
        0 => format!("{felt} All {all} samples are here."),
        _ => format!("{felt} {} of {all} samples are missing.", count(lost)),
    }
}

/// Missing samples come first.
fn missing(accounting: &SampleAccounting) -> Option<Section> {
    let rows = accounting.gaps.iter().take(SHOWN_GAPS).map(|gap| {
        let (samples, cause) = (gap.samples, gap.cause.text());
        (
            format!("from tick {}", gap.first_tick),
            format!("{samples} samples, {:.4} s: {cause}", seconds(samples)),
        )
    });
    let title = match accounting.gap_count {
        0 => return None,
        n if n > SHOWN_GAPS as u64 => {
            format!("Missing samples: the first {SHOWN_GAPS} of {n} gaps")
        }
        _ => "Missing samples".to_owned(),
    };
    Some(section(&title, rows))
}

fn recording(s: &RecordingSummary) -> Section {
    let device = |c: &Controller| format!("{} (serial {})", c.version, c.serial);
    let t = &s.telemetry;
    let mut rows = vec![
        (
            "span",
            format!("{:.3} s from the first to the last sample", s.span_s),
        ),
        ("recorded time", format!("{:.3} s", s.duration_s)),
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
            counts(&[(s.breaks, "break"), (s.sticks, "stick")]),
        ),
        (
            "highest speed",
            format!("{:.1} °/s", s.fastest_rad_s.to_degrees()),
        ),
        ("comms", device(&s.comms)),
    ];
    rows.extend(s.drive.as_ref().map(|drive| ("drive", device(drive))));
    if let Some(ending) = &s.ending {
        let text = match ending.faults.as_slice() {
            [] => ending.cause.text().to_owned(),
            faults => format!("{}: {}", ending.cause.text(), faults.join("; ")),
        };
        rows.push(("end", text));
    }
    if s.missing_at_end > 0 {
        let text = format!(
            "{} samples ({:.3} s)",
            s.missing_at_end,
            seconds(s.missing_at_end)
        );
        rows.push(("missing at the end", text));
    }
    if s.rejected_counts > 0 {
        rows.push(("rejected counts", s.rejected_counts.to_string()));
    }
    if s.late_ticks > 0 {
        rows.push(("late ticks", s.late_ticks.to_string()));
    }
    section("Recording", rows)
}

/// All of the first set, and of each later one what has changed.
fn parameters(set: &ParameterSet, at_s: Option<f64>) -> Section {
    let title = match at_s {
        None => format!("Parameters: revision {}", set.revision),
        Some(at_s) => format!("Revision {}, from {at_s:.3} s on", set.revision),
    };
    let Some(values) = &set.values else {
        return section(&title, [("values", "unknown".to_owned())]);
    };
    let rows = values
        .iter()
        .map(|(name, value)| (name.clone(), shown(value)));
    section(&title, rows)
}

fn shown(value: &Value) -> String {
    match value {
        Value::String(name) => name.clone(),
        other => other.to_string(),
    }
}
