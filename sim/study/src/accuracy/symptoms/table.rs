//! `symptoms.csv`: one row a point. Numbers read back to the same bits; what is
//! not known is `nan`.

use super::SymptomPoint;
use crepitus_table::Table;

/// A row a point, a column a field of [`SymptomPoint`].
pub fn symptoms_table(points: &[SymptomPoint]) -> Table<'_, SymptomPoint> {
    Table::of(points)
        .column("symptom", |p| p.symptom)
        .column("form", |p| p.form.unwrap_or(""))
        .column("precision", |p| p.precision)
        .column("step_s", |p| p.step_s)
        .column("events", |p| p.events)
        .column("events_true", |p| p.events_true)
        .column("unmatched", |p| p.unmatched)
        .column("max_event_error_s", |p| p.max_event_error_s)
        .column("rms_event_error_s", |p| p.rms_event_error_s)
        .column("max_tick_torque_error_nm", |p| p.max_tick_torque_error_nm)
        .column("rms_tick_torque_error_nm", |p| p.rms_tick_torque_error_nm)
        .column("ns_per_step", |p| p.ns_per_step)
        .column("time_ratio", |p| p.time_ratio)
        .column("time_spread", |p| p.time_spread)
}
