//! Words of the study: what its verb prints, and the text of its page.

use crate::vibration::{AtSpeed, Step, VibrationStudy, report, tables};
use crate::{Outcome, Picture, StudyText};
use crepitus_pages::plot::Paper;
use crepitus_pages::words::footer;
use serde::Serialize;

impl Outcome for VibrationStudy {
    const REST: &'static str = "every step of the chain";
    const JSON_KEY: &'static str = "study";

    fn summary(&self) -> impl Serialize {
        self
    }

    fn page(&self) -> String {
        report::html(self, &text(self))
    }

    fn pictures(&self, paper: Paper) -> Vec<Picture> {
        report::pictures(self, paper)
    }

    fn tables(&self) -> Vec<(&'static str, String)> {
        Vec::new()
    }

    fn answer(&self) -> String {
        answer(self)
    }

    fn in_short(&self) -> String {
        self.in_full()
    }

    fn in_full(&self) -> String {
        let speeds: String = self.speeds.iter().map(at_speed).collect();
        format!(
            "{speeds}loop from the actuator to the encoder and back, linear, without the gear's friction\n\n{}",
            tables::margins(&self.margins).to_text()
        )
    }
}

fn text(study: &VibrationStudy) -> StudyText {
    StudyText {
        title: "What the hand gets".to_owned(),
        intro: answer(study) + "\n",
        notes: vec![
            "T/r: the force that a knee with the joint's torque T gives at the hand's lever r.".to_owned(),
            "All of it is simulated. The hand's numbers are estimates, and the threshold is known to ±10 dB.".to_owned(),
        ],
        tables: Vec::new(),
        footer: footer(),
    }
}

/// Levels of a bare knee, of the motor alone, and with the actuator: a line a speed.
fn answer(study: &VibrationStudy) -> String {
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
    lines.collect::<String>() + "0 dB is the threshold of perception, which is known to ±10 dB."
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
