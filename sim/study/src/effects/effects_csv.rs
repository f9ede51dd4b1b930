//! `effects.csv`: one row a variant, the scene first. Numbers read back to
//! the same bits; what is not known is `nan`. Times are CPU time.
//! `added_ns_per_step` is `nan` where it is not above `added_ns_resolution`, the
//! smallest difference that the timings can tell: it is never zero or less.

use super::results::{EffectsStudy, Row};
use std::fmt::Write;

/// The header.
pub const HEADER: &str = "change,effect,along,states,added_states,ns_per_step,time_spread,added_ns_per_step,\
added_ns_resolution,added_rms_nm,added_peak_nm,rms_nm,peak_nm,rms_10_50_hz_nm,rms_50_250_hz_nm,rms_250_450_hz_nm,\
events,added_events,failure";

/// The file.
pub fn effects_csv(study: &EffectsStudy) -> String {
    let mut text = format!("{HEADER}\n");
    for row in &study.rows {
        push(&mut text, row);
    }
    text
}

fn push(text: &mut String, row: &Row) {
    let (ran, added) = (row.ran(), row.added());
    let count = |n: Option<String>| n.unwrap_or_default();
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "{},{},{},{},{},{},{},",
        row.change.name(),
        row.effect,
        row.along.join(" "),
        row.states,
        count(added.map(|a| a.states.to_string())),
        Number(row.ns_per_step),
        Number(row.time_spread),
    );
    let numbers = [
        added.and_then(|a| a.time.ns_per_step),
        added.map(|a| a.time.ns_resolution),
        added.map(|a| a.rms_nm),
        added.map(|a| a.peak_nm),
        ran.map(|r| r.torque.rms_nm),
        ran.map(|r| r.torque.peak_nm),
        ran.map(|r| r.torque.bands_nm[0]),
        ran.map(|r| r.torque.bands_nm[1]),
        ran.map(|r| r.torque.bands_nm[2]),
    ];
    for number in numbers {
        let _ = write!(text, "{},", Number(number.unwrap_or(f64::NAN)));
    }
    let _ = writeln!(
        text,
        "{},{},{}",
        count(ran.map(|r| r.events.to_string())),
        count(added.map(|a| a.events.to_string())),
        quoted(row.failure().unwrap_or_default()),
    );
}

struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let x = self.0;
        if x.is_finite() {
            f.write_str(ryu::Buffer::new().format_finite(x))
        } else if x.is_nan() {
            f.write_str("nan")
        } else {
            f.write_str(if x > 0.0 { "inf" } else { "-inf" })
        }
    }
}

/// A text as a cell.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::super::influence::Torque;
    use super::super::results::{Added, Outcome, Ran};
    use super::super::variant::Change;
    use super::*;
    use crepitus_scene::run::AddedTime;

    #[test]
    fn rows_have_the_columns_and_read_back() {
        let mut row = Row {
            change: Change::Without,
            effect: "drivetrain",
            along: vec!["friction-compensation", "backlash"],
            states: 3,
            ns_per_step: 0.1 + 0.2,
            time_spread: 0.05,
            outcome: Outcome::Ran(Ran {
                torque: Torque {
                    rms_nm: 1.0 / 3.0,
                    peak_nm: 2.0,
                    bands_nm: [1e-3, f64::NAN, 0.0],
                },
                events: 7,
                added: Some(Added {
                    rms_nm: 0.1,
                    peak_nm: 0.2,
                    events: -3,
                    states: 1,
                    time: AddedTime {
                        ns_per_step: None,
                        ns_resolution: 0.5,
                    },
                }),
            }),
        };
        let mut text = String::new();
        push(&mut text, &row);
        let cells: Vec<_> = text.trim_end().split(',').collect();
        let header: Vec<_> = HEADER.split(',').collect();
        assert_eq!(cells.len(), header.len());
        let cell = |name| cells[header.iter().position(|h| *h == name).unwrap()];
        assert_eq!(cell("along"), "friction-compensation backlash");
        assert_eq!(cell("rms_nm").parse(), Ok(1.0 / 3.0));
        assert_eq!(cell("ns_per_step").parse(), Ok(0.1 + 0.2));
        assert_eq!(cell("rms_50_250_hz_nm"), "nan");
        assert_eq!(
            (cell("added_ns_per_step"), cell("added_ns_resolution")),
            ("nan", "0.5")
        );
        assert_eq!((cell("events"), cell("added_events")), ("7", "-3"));

        row.outcome = Outcome::Failed {
            failure: "\"euler\" diverged, soon".to_owned(),
        };
        let mut text = String::new();
        push(&mut text, &row);
        assert!(
            text.ends_with(",nan,,,\"\"\"euler\"\" diverged, soon\"\n"),
            "{text}"
        );
    }
}
