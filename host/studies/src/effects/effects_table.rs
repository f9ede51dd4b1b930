//! `effects.csv`: one row a variant, the scene first. Numbers read back to
//! the same bits; what is not known is `nan`. Times are CPU time.
//! `added_ns_per_step` is `nan` where it is not above `added_ns_resolution`, the
//! smallest difference that the timings can tell: it is never zero or less.

use super::row::{Added, Ran, Row};
use crepitus_pages::table::show::{UNKNOWN, fixed, milli, signed};
use crepitus_pages::table::{Cell, Table};
use crepitus_scene::run::AddedTime;
use serde::{Serialize, Serializer};

/// A row a variant.
pub fn effects_table(rows: &[Row]) -> Table<'_, Row> {
    let ran = |of: fn(&Ran) -> f64| move |row: &Row| row.ran().map_or(f64::NAN, of);
    let added = |of: fn(&Added) -> f64| move |row: &Row| row.added().map_or(f64::NAN, of);
    Table::of(rows)
        .people("variant", Row::name)
        .remark(|row| row.failure().map(str::to_owned))
        .column("change", |row| row.change.name())
        .column("effect", |row| row.effect)
        .column("along", |row| row.along.as_slice())
        .group("states")
        .column("states", |row| row.states)
        .headed("all")
        .column("added_states", |row| row.added().map(|a| a.states))
        .headed("added")
        .rounded(signed)
        .group("ns a step")
        .column("ns_per_step", |row| row.ns_per_step)
        .headed("all")
        .rounded(fixed::<0>)
        .column("time_spread", |row| row.time_spread)
        .column("added_ns_per_step", |row| {
            let time = row.added().map(|a| a.time);
            Cell::from(time.and_then(|t| t.ns_per_step).unwrap_or(f64::NAN))
                .shown_as(time.map_or(UNKNOWN.to_owned(), |time| cost(&time)))
        })
        .headed("added")
        .column("added_ns_resolution", added(|a| a.time.ns_resolution))
        .group("instructions a step")
        .column("instructions_per_step", |row| row.instructions_per_step)
        .headed("all")
        .rounded(fixed::<0>)
        .column("added_instructions_per_step", added(|a| a.instructions))
        .headed("added")
        .rounded(fixed::<0>)
        .group("the effect adds, mN·m")
        .column("added_rms_nm", added(|a| a.rms_nm))
        .headed("RMS")
        .rounded(milli)
        .column("added_peak_nm", added(|a| a.peak_nm))
        .headed("peak")
        .rounded(milli)
        .group("the hand then feels, mN·m RMS, and in bands")
        .column("rms_nm", ran(|r| r.torque.rms_nm))
        .headed("in all")
        .rounded(milli)
        .column("peak_nm", ran(|r| r.torque.peak_nm))
        .column("rms_10_50_hz_nm", ran(|r| r.torque.bands_nm[0]))
        .headed("10–50 Hz")
        .rounded(milli)
        .column("rms_50_250_hz_nm", ran(|r| r.torque.bands_nm[1]))
        .headed("50–250 Hz")
        .rounded(milli)
        .column("rms_250_450_hz_nm", ran(|r| r.torque.bands_nm[2]))
        .headed("250–450 Hz")
        .rounded(milli)
        .group("events")
        .column("events", |row| row.ran().map(|r| r.events))
        .headed("all")
        .column("added_events", |row| row.added().map(|a| a.events))
        .headed("added")
        .rounded(signed)
        .column("failure", Row::failure)
}

/// Time that an effect adds to a step, ns; of a cost that is lost in the timings
/// its bound.
pub fn cost(added: &AddedTime) -> String {
    match added.ns_per_step {
        Some(ns) => format!("+{ns:.0}"),
        None if added.is_below_resolution() => format!("<{:.0}", added.ns_resolution.ceil()),
        None => UNKNOWN.to_owned(),
    }
}

/// The rows with the names and numbers of `effects.csv`.
pub(super) fn serialize<S: Serializer>(rows: &[Row], serializer: S) -> Result<S::Ok, S::Error> {
    effects_table(rows).serialize(serializer)
}

#[cfg(test)]
mod tests {
    use super::super::influence::Torque;
    use super::super::row::{Added, Outcome, Ran};
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
            instructions_per_step: 321.5,
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
                    instructions: f64::NAN,
                }),
            }),
        };
        let text = effects_table(std::slice::from_ref(&row)).to_csv();
        let mut lines = text.lines();
        let header: Vec<_> = lines.next().unwrap().split(',').collect();
        let cells: Vec<_> = lines.next().unwrap().split(',').collect();
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
        let counts = ["instructions_per_step", "added_instructions_per_step"].map(cell);
        assert_eq!(counts, ["321.5", "nan"]);

        row.outcome = Outcome::Failed {
            failure: "\"euler\" diverged, soon".to_owned(),
        };
        let text = effects_table(&[row]).to_csv();
        assert!(
            text.ends_with(",nan,,,\"\"\"euler\"\" diverged, soon\"\n"),
            "{text}"
        );
    }

    #[test]
    fn a_cost_is_never_negative() {
        let text = |ns_per_step, ns_resolution| {
            cost(&AddedTime {
                ns_per_step,
                ns_resolution,
            })
        };
        assert_eq!(text(Some(12.4), 1.0), "+12");
        assert_eq!(text(None, 2.3), "<3");
        assert_eq!(text(None, f64::NAN), "–");
    }
}
