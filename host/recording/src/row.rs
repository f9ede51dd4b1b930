//! A sample as a row.

use crepitus_knee::Examination;
use crepitus_model::render::effects::Phases;
use crepitus_protocol::TICK_S;
use crepitus_protocol::telemetry::SampleFlags;
use std::fmt::Write as _;

/// End of all ticks and other counts of a recording: centuries. A file with larger ones is none of
/// ours, however right its checksums are.
pub(crate) const END_TICK: u64 = 1 << 48;

/// Duration of this number of ticks, s.
#[expect(clippy::cast_precision_loss, reason = "centuries of ticks")]
pub fn seconds(ticks: u64) -> f64 {
    ticks as f64 * TICK_S
}

/// A sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Ticks since the drive has started.
    pub tick: u64,
    /// Time since the first recorded tick, s.
    pub time_s: f64,
    /// Counts of the encoder.
    pub count: i32,
    /// Angle of the joint, rad.
    pub angle_rad: f64,
    /// Velocity of the joint, rad/s.
    pub omega_rad_s: f32,
    /// Torque of the model, N·m.
    pub model_torque_nm: f32,
    /// Torque commanded to the motor, N·m.
    pub torque_nm: f32,
    /// Measured current, A.
    pub current_a: Option<f32>,
    /// Mean current of the vibration actuator's coil over five ticks, A.
    pub coil_a: Option<f32>,
    /// Revision of the parameters in force.
    pub revision: u32,
    /// Phase, limit and the rest.
    pub flags: SampleFlags,
    /// Phases of the effects.
    pub phases: Phases,
}

/// Step between a row and the one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// No gap: the next tick.
    Next,
    /// Gap: the number of missing samples.
    Missing(u64),
    /// A restart of the drive: how long it took is not known.
    Restart,
}

/// Names of the notes.
pub(crate) const NOTES: [(u16, &str); 4] = [
    (SampleFlags::SETTLING, "settling"),
    (SampleFlags::LOST, "lost"),
    (SampleFlags::LATE, "late"),
    (SampleFlags::CHIRP, "chirp"),
];

/// Name of the note of the share that the tank holds back.
pub(crate) const HELD_BACK: &str = "tank";

impl Row {
    /// The step from the row before it.
    pub fn step_from(&self, before: &Self) -> Step {
        let passed_s = self.time_s - before.time_s;
        match self.tick.checked_sub(before.tick) {
            // Time goes on at once where the drive restarted, its ticks do not go on with it.
            Some(ticks @ 1..) if (passed_s - seconds(ticks)).abs() < 0.5 * TICK_S => match ticks {
                1 => Step::Next,
                _ => Step::Missing(ticks - 1),
            },
            _ => Step::Restart,
        }
    }

    /// Has an examination take the row, with the torque of the model, while the motor is driven: without
    /// torque nobody examines a knee.
    pub fn examined_by(&self, examination: &mut Examination) {
        if self.flags.has(SampleFlags::ENERGISED) {
            examination.take(
                self.time_s,
                self.angle_rad,
                f64::from(self.omega_rad_s),
                f64::from(self.model_torque_nm),
            );
        }
    }

    /// Phase of the imaginary object: `stick`, `slip+`, `slip-`.
    pub fn phase(&self) -> &'static str {
        match self.flags.phase_sign() {
            0 => "stick",
            1.. => "slip+",
            _ => "slip-",
        }
    }

    /// Event of the tick: `break`, `stick`, `both`, or nothing.
    pub fn event(&self) -> &'static str {
        let has = |bit| self.flags.has(bit);
        match (has(SampleFlags::BREAK), has(SampleFlags::STICK)) {
            (false, false) => "",
            (true, false) => "break",
            (false, true) => "stick",
            (true, true) => "both",
        }
    }

    pub(crate) fn append_notes(&self, line: &mut String) {
        let mut separator = "";
        for (bit, name) in NOTES {
            if self.flags.has(bit) {
                line.push_str(separator);
                line.push_str(name);
                separator = "+";
            }
        }
        let held_back = self.flags.held_back();
        if held_back > 0 {
            let _ = write!(line, "{separator}{HELD_BACK}:{held_back}");
            separator = "+";
        }
        for (effect, phase) in self.phases.named() {
            let _ = write!(line, "{separator}{}:{phase}", effect.name);
            separator = "+";
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_knee::examination::Measure;

    #[test]
    fn a_leg_is_examined_while_the_motor_is_driven() {
        let mut examination = Examination::default();
        for tick in 0..40_000 {
            let is_driven = tick >= 20_000;
            let row = Row {
                tick,
                time_s: seconds(tick),
                angle_rad: seconds(tick),
                omega_rad_s: 1.0,
                flags: SampleFlags::default().with(SampleFlags::ENERGISED, is_driven),
                ..Row::default()
            };
            row.examined_by(&mut examination);
        }
        let range_deg = examination.measure(Measure::Range).unwrap();
        assert!((range_deg - 1_f64.to_degrees()).abs() < 0.01, "{range_deg}");
    }

    #[test]
    fn a_restart_is_no_missing_samples_whether_ticks_go_back_or_not() {
        let row = |tick, time_ticks| Row {
            tick,
            time_s: seconds(time_ticks),
            ..Row::default()
        };
        let before = row(5_000, 72_000_000);
        for (after, step) in [
            (row(5_001, 72_000_001), Step::Next),
            (row(5_002, 72_000_002), Step::Missing(1)),
            (row(9_000, 72_004_000), Step::Missing(3_999)),
            (row(20, 72_000_001), Step::Restart),
            (row(5_000, 72_000_001), Step::Restart),
            (row(8_000, 72_000_001), Step::Restart),
        ] {
            assert_eq!(after.step_from(&before), step, "tick {}", after.tick);
        }
    }
}
