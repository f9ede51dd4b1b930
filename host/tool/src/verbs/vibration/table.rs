//! Vibration that the hand gets, as tables for the terminal.

use crepitus_study::vibration::{AtSpeed, VibrationStudy, tables};

/// All of it.
pub(super) fn text(study: &VibrationStudy) -> String {
    let speeds: String = study.speeds.iter().map(at_speed).collect();
    format!(
        "{speeds}loop from the actuator to the encoder and back, linear, without the gear's friction\n\n{}\n",
        tables::margins(&study.margins).to_text()
    )
}

fn at_speed(speed: &AtSpeed) -> String {
    format!(
        "at {} rad/s, 15 to 500 Hz\n\n{}\n{}",
        speed.speed_rad_s,
        tables::steps(&speed.rows).to_text(),
        speed
            .draws
            .map_or_else(String::new, |draws| format!("{draws}\n\n"))
    )
}
