//! The symptoms as tables. In `symptoms.csv` numbers read back to the same bits; what
//! is not known is `nan`.

use super::SymptomPoint;
use crepitus_pages::table::show::{fixed, microseconds, scientific};
use crepitus_pages::table::{Cell, Table};

/// A row a point: for `symptoms.csv` a column a field of [`SymptomPoint`], for people
/// those of one step.
pub fn symptoms_table(points: &[SymptomPoint]) -> Table<'_, SymptomPoint> {
    Table::of(points)
        .people("symptom", SymptomPoint::name)
        .column("symptom", |p| p.symptom)
        .column("form", |p| p.form.unwrap_or(""))
        .column("precision", |p| p.precision)
        .headed("precision")
        .column("step_s", |p| p.step_s)
        .column("events", |p| p.events)
        .column("events_true", |p| p.events_true)
        .headed("events")
        .column("unmatched", |p| p.unmatched)
        .column("max_event_error_s", worst_event)
        .headed("worst event error, s")
        .rounded(scientific)
        .column("rms_event_error_s", |p| p.rms_event_error_s)
        .column("max_tick_torque_error_nm", |p| p.max_tick_torque_error_nm)
        .headed("largest torque error, N·m")
        .rounded(scientific)
        .column("rms_tick_torque_error_nm", |p| p.rms_tick_torque_error_nm)
        .headed("RMS, N·m")
        .rounded(scientific)
        .column("ns_per_step", |p| p.ns_per_step)
        .headed("ns a step")
        .rounded(fixed::<1>)
        .column("time_ratio", |p| p.time_ratio)
        .headed("× crepitus")
        .rounded(fixed::<1>)
        .column("time_spread", |p| p.time_spread)
}

/// A symptom at one step: in f32, and in f64 if it was studied, too.
pub type Precisions<'p> = (&'p SymptomPoint, Option<&'p SymptomPoint>);

/// Table for people, a row a symptom, both precisions side by side.
pub fn precisions_table<'t>(rows: &'t [Precisions<'_>]) -> Table<'t, Precisions<'t>> {
    let mut table = Table::of(rows)
        .people("symptom", |(single, _)| single.name())
        .people("events", |(single, _)| single.events_true);
    for (precision, is_double) in [("f64", true), ("f32", false)] {
        let cell = move |row: &Precisions<'_>, of: fn(&SymptomPoint) -> Cell| {
            let point = if is_double { row.1 } else { Some(row.0) };
            point.map_or(Cell::Number(f64::NAN), of)
        };
        table = table
            .group(precision)
            .people("event, s", move |row| cell(row, worst_event))
            .rounded(scientific)
            .people("torque, N·m", move |row| {
                cell(row, |p| p.max_tick_torque_error_nm.into())
            })
            .rounded(scientific)
            .people("RMS, N·m", move |row| {
                cell(row, |p| p.rms_tick_torque_error_nm.into())
            })
            .rounded(scientific);
    }
    table
        .people("× crepitus", |(single, _)| single.time_ratio)
        .rounded(fixed::<1>)
}

/// Table for people of the largest torque error: a column a step, a row a symptom in a
/// precision, which follow each other in `points`.
pub fn steps_table<'p>(
    rows: &'p [&'p [SymptomPoint]],
    steps_s: &[f64],
) -> Table<'p, &'p [SymptomPoint]> {
    let first = |row: &&'p [SymptomPoint]| row.first();
    let mut table = Table::of(rows)
        .people("symptom", move |row| first(row).map(SymptomPoint::name))
        .people("precision", move |row| first(row).map(|p| p.precision));
    for &step_s in steps_s {
        table = table
            .people(microseconds(step_s), move |row| {
                let there = row.iter().find(|p| p.step_s == step_s);
                there.map_or(f64::NAN, |p| p.max_tick_torque_error_nm)
            })
            .rounded(scientific);
    }
    table
}

/// The worst error of an event, or how many have no partner.
fn worst_event(p: &SymptomPoint) -> Cell {
    let error = Cell::from(p.max_event_error_s);
    match (p.unmatched, p.events_true) {
        (0, 0) => error.shown_as("–"),
        (0, _) => error,
        (unmatched, _) => error.shown_as(format!("{unmatched} unmatched")),
    }
}
