//! `points.csv`: one row a point. Numbers read back to the same bits; what is
//! not known is `nan`.

use crate::accuracy::point::Point;
use std::fmt::Write;

/// The header, in the order of the fields of [`Point`].
pub const HEADER: &str = "scene,convention,solver,precision,step_s,events,events_true,unmatched,\
max_event_error_s,rms_event_error_s,max_interval_error_s,frequency_error_rel,\
rms_held_torque_error_nm,max_held_torque_error_nm,held_floor_nm,rms_tick_torque_error_nm,\
max_tick_torque_error_nm,behind_s,behind_j,ns_per_step,us_per_simulated_s,time_spread,cycles_per_step,worst_cycles,\
instructions_per_step";

/// The file.
pub fn points_csv(points: &[Point]) -> String {
    let mut text = format!("{HEADER}\n");
    for p in points {
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "{},{},{},{},",
            p.scene, p.convention, p.solver, p.precision
        );
        push_number(&mut text, p.step_s);
        let _ = write!(text, ",{},{},{}", p.events, p.events_true, p.unmatched);
        for value in [
            p.max_event_error_s,
            p.rms_event_error_s,
            p.max_interval_error_s,
            p.frequency_error_rel,
            p.rms_held_torque_error_nm,
            p.max_held_torque_error_nm,
            p.held_floor_nm,
            p.rms_tick_torque_error_nm,
            p.max_tick_torque_error_nm,
            p.behind_s,
            p.behind_j,
            p.ns_per_step,
            p.us_per_simulated_s,
            p.time_spread,
            p.cycles_per_step,
            p.worst_cycles,
            p.instructions_per_step,
        ] {
            text.push(',');
            push_number(&mut text, value);
        }
        text.push('\n');
    }
    text
}

fn push_number(text: &mut String, x: f64) {
    if x.is_finite() {
        text.push_str(ryu::Buffer::new().format_finite(x));
    } else if x.is_nan() {
        text.push_str("nan");
    } else {
        text.push_str(if x > 0.0 { "inf" } else { "-inf" });
    }
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
        let text = points_csv(&[p.clone()]);
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
