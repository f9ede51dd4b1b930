//! The stage of the vibration actuator, as a table.

use super::words;
use crepitus_study::accuracy::actuator::ActuatorPoint;
use crepitus_table::show::{fixed, scientific};
use std::fmt::Write;

/// A line a step and precision; nothing without.
pub(super) fn table(points: &[ActuatorPoint]) -> String {
    if points.is_empty() {
        return String::new();
    }
    let mut text = "The command of the vibration actuator, 15 to 500 Hz, coarse at 1 rad/s:\n\n\
                    | step | precision | error | rounding | × crepitus |\n|---|---|---|---|---|\n"
        .to_owned();
    for point in points {
        let [step, precision, error, rounding, ratio] = cells(point);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {step} | {precision} | {error} | {rounding} | {ratio} |"
        );
    }
    text
}

/// The same as rows of a page: step and precision, and the rest.
pub(super) fn rows(points: &[ActuatorPoint]) -> Vec<(String, String)> {
    points
        .iter()
        .map(|point| {
            let [step, precision, error, rounding, ratio] = cells(point);
            (
                format!("{step}, {precision}"),
                format!("error {error} of the voltage, rounding {rounding}, {ratio} × crepitus"),
            )
        })
        .collect()
}

fn cells(point: &ActuatorPoint) -> [String; 5] {
    [
        words::step(point.step_s),
        point.precision.to_owned(),
        scientific(point.error),
        scientific(point.rounding),
        fixed::<1>(point.time_ratio),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_step_precision_and_errors() {
        let point = ActuatorPoint {
            precision: "f32",
            step_s: 5e-5,
            error: 0.0123,
            rounding: 2.5e-7,
            time_ratio: 1.25,
        };
        let text = table(std::slice::from_ref(&point));
        assert!(
            text.ends_with("| 50 µs | f32 | 1.2e-2 | 2.5e-7 | 1.2 |\n"),
            "{text}"
        );
        assert_eq!(rows(&[point])[0].0, "50 µs, f32");
        assert_eq!(table(&[]), "");
    }
}
