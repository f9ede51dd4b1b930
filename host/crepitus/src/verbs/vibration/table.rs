//! Vibration that the hand gets, as tables for the terminal.

use crepitus_studies::vibration::{AtSpeed, Step, VibrationStudy, tables};

/// Levels of a bare knee, of the motor alone, and with the actuator: a line a speed.
pub(super) fn answer(study: &VibrationStudy) -> String {
    let lines = study.speeds.iter().filter_map(|speed| {
        let level = |step| {
            let row = speed.rows.iter().find(|row| row.step == step)?;
            row.measured.map(|measured| measured.level_db)
        };
        let knee_db = level(Step::BareKnee)?;
        let (shell_db, leg_db) = (level(Step::MotorAlone)?, level(Step::MotorOnLeg)?);
        let actuator_db = level(Step::Actuator)?;
        let times = 10_f64.powf((actuator_db - knee_db) / 20.0);
        Some(format!(
            "At {} rad/s the palm gets {knee_db:+.1} dB of a bare diseased knee; of the motor alone {leg_db:+.1} dB on the leg and \
             {shell_db:+.1} dB on the shell; with the actuator {actuator_db:+.1} dB, {} times the knee's.\n",
            speed.speed_rad_s,
            if times < 10.0 { format!("{times:.1}") } else { format!("{times:.0}") }
        ))
    });
    lines.collect::<String>() + "0 dB is the threshold of perception, which is known to ±10 dB.\n"
}

/// All of it.
pub(super) fn text(study: &VibrationStudy) -> String {
    let speeds: String = study.speeds.iter().map(at_speed).collect();
    format!(
        "{}\n{speeds}loop from the actuator to the encoder and back, linear, without the gear's friction\n\n{}\n",
        answer(study),
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
