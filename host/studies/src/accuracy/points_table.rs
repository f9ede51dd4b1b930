//! `points.csv`: one row a point. Numbers read back to the same bits; what is
//! not known is `nan`.

use crate::accuracy::point::Point;
use crepitus_pages::table::Table;

/// A row a point, a column a field of [`Point`].
pub fn points_table(points: &[Point]) -> Table<'_, Point> {
    Table::of(points)
        .column("scene", |p| p.scene.as_str())
        .column("convention", |p| p.convention)
        .column("input", |p| p.input)
        .column("solver", |p| p.solver)
        .column("precision", |p| p.precision)
        .column("step_s", |p| p.step_s)
        .column("events", |p| p.events)
        .column("events_true", |p| p.events_true)
        .column("unmatched", |p| p.unmatched)
        .column("max_event_error_s", |p| p.max_event_error_s)
        .column("rms_event_error_s", |p| p.rms_event_error_s)
        .column("max_interval_error_s", |p| p.max_interval_error_s)
        .column("frequency_error_rel", |p| p.frequency_error_rel)
        .column("rms_held_torque_error_nm", |p| p.rms_held_torque_error_nm)
        .column("max_held_torque_error_nm", |p| p.max_held_torque_error_nm)
        .column("held_floor_nm", |p| p.held_floor_nm)
        .column("rms_tick_torque_error_nm", |p| p.rms_tick_torque_error_nm)
        .column("max_tick_torque_error_nm", |p| p.max_tick_torque_error_nm)
        .column("behind_s", |p| p.behind_s)
        .column("behind_j", |p| p.behind_j)
        .column("ns_per_step", |p| p.ns_per_step)
        .column("ns_per_step_q1", |p| p.ns_per_step_q1)
        .column("ns_per_step_q3", |p| p.ns_per_step_q3)
        .column("us_per_simulated_s", |p| p.us_per_simulated_s)
        .column("time_spread", |p| p.time_spread)
        .column("cycles_per_step", |p| p.cycles_per_step)
        .column("worst_cycles", |p| p.worst_cycles)
        .column("instructions_per_step", |p| p.instructions_per_step)
        .column("host_instructions_per_step", |p| {
            p.host_instructions_per_step
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::point::tests::point;

    #[test]
    fn rows_have_the_columns_and_read_back() {
        let mut p = point("exact", 5e-5);
        p.rms_held_torque_error_nm = 0.1 + 0.2;
        p.frequency_error_rel = f64::NAN;
        let text = points_table(std::slice::from_ref(&p)).to_csv();
        let mut lines = text.lines();
        let header: Vec<_> = lines.next().unwrap().split(',').collect();
        let row: Vec<_> = lines.next().unwrap().split(',').collect();
        assert_eq!(header.len(), row.len());
        let cell = |name| row[header.iter().position(|h| *h == name).unwrap()];
        assert_eq!(cell("solver"), "exact");
        assert_eq!(cell("step_s").parse(), Ok(5e-5));
        assert_eq!(cell("rms_held_torque_error_nm").parse(), Ok(0.1 + 0.2));
        assert!(cell("frequency_error_rel").parse::<f64>().unwrap().is_nan());
        assert_eq!(cell("time_spread").parse(), Ok(p.time_spread));
    }
}
