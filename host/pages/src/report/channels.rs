//! Columns of the trace that the report reads, and one row of them.
//!
//! Columns are looked up by name, once. A missing column is NaN in
//! every [`Sample`], and NaN is not drawn.

use crepitus_model::Phase;
use crepitus_model::render::effects::EffectSettings;
use crepitus_scene::run::FELT_COLUMN;
use crepitus_scene::trace::Column;

/// Inputs of the report before the first row.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The columns of every row that will come.
    pub columns: &'a [Column],
    /// Approximate number of rows that will come. Zero if it is not known; a wrong
    /// number costs resolution, nothing else.
    pub rows_expected: u64,
    /// Time from one row to the next, s. The spectrum needs it.
    pub row_step_s: f64,
    /// The torques between which the object sticks and slips, if the scene
    /// has them: drawn as lines.
    pub levels: Option<TorqueLevels>,
    /// The settings of the symptoms besides crepitus, of those that had the same all
    /// the time: their limits are drawn.
    pub effects: EffectSettings,
}

/// The torques between which the imaginary object sticks and slips, as
/// magnitudes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLevels {
    /// Torque at which stick starts, N·m: 2Tk − Ts in the elastic restart.
    pub restart_nm: f64,
    /// Torque while slipping, N·m: Tk.
    pub kinetic_nm: f64,
    /// Torque at which stick breaks, N·m: Ts.
    pub static_nm: f64,
}

impl TorqueLevels {
    /// The levels of the elastic restart: 2Tk − Ts, Tk, Ts.
    pub fn elastic(kinetic_nm: f64, static_nm: f64) -> Self {
        Self {
            restart_nm: 2.0 * kinetic_nm - static_nm,
            kinetic_nm,
            static_nm,
        }
    }
}

/// One row, reduced to what is drawn. Absent or broken values are NaN.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) time: f64,
    pub(crate) angle: f64,
    pub(crate) omega: f64,
    pub(crate) encoder_omega: f64,
    pub(crate) phase: Option<Phase>,
    /// The phase may lack a value, and lacks it: nothing of the object is rendered.
    pub(crate) is_off: bool,
    pub(crate) theta: f64,
    pub(crate) theta_dot: f64,
    pub(crate) torque: f64,
    pub(crate) motor_torque: f64,
    pub(crate) leg_angle: f64,
    pub(crate) leg_omega: f64,
    pub(crate) intended_angle: f64,
    pub(crate) hand_torque: f64,
    /// The hand torque without its slow part, once that is known.
    pub(crate) hand_fast: f64,
}

#[cfg(test)]
impl Sample {
    /// A row without any column.
    pub(crate) fn nothing() -> Self {
        Channels::find(&[]).sample(&[])
    }
}

/// Position of each value in a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Channels {
    time: Option<usize>,
    angle: Option<usize>,
    omega: Option<usize>,
    encoder_omega: Option<usize>,
    phase: Option<usize>,
    theta: Option<usize>,
    theta_dot: Option<usize>,
    torque: Option<usize>,
    motor_torque: Option<usize>,
    leg_angle: Option<usize>,
    leg_omega: Option<usize>,
    intended_angle: Option<usize>,
    hand_torque: Option<usize>,
}

impl Channels {
    pub(crate) fn find(columns: &[Column]) -> Self {
        let at = |name: &str| columns.iter().position(|column| column.name == name);
        Self {
            time: at("t_s"),
            angle: at("angle_rad"),
            omega: at("omega_rad_s"),
            encoder_omega: at("encoder_omega_rad_s"),
            phase: at("phase"),
            theta: at("theta_rad"),
            theta_dot: at("theta_dot_rad_s"),
            torque: at("torque_nm"),
            motor_torque: at("motor_torque_nm"),
            leg_angle: at("leg_angle_rad"),
            leg_omega: at("leg_omega_rad_s"),
            intended_angle: at("intended_angle_rad"),
            hand_torque: at(FELT_COLUMN),
        }
    }

    pub(crate) fn sample(&self, row: &[f64]) -> Sample {
        let value = |at: Option<usize>| {
            at.and_then(|i| row.get(i))
                .copied()
                .filter(|v| v.is_finite())
                .unwrap_or(f64::NAN)
        };
        Sample {
            time: value(self.time),
            angle: value(self.angle),
            omega: value(self.omega),
            encoder_omega: value(self.encoder_omega),
            phase: phase_of(value(self.phase)),
            is_off: false,
            theta: value(self.theta),
            theta_dot: value(self.theta_dot),
            torque: value(self.torque),
            motor_torque: value(self.motor_torque),
            leg_angle: value(self.leg_angle),
            leg_omega: value(self.leg_omega),
            intended_angle: value(self.intended_angle),
            hand_torque: value(self.hand_torque),
            hand_fast: f64::NAN,
        }
    }

    /// Returns whether crepitus is off in a row: its phase is NaN, and the column is one of those, from
    /// `may_lack_from` on, in which NaN means "no value".
    pub(crate) fn is_off(&self, row: &[f64], may_lack_from: usize) -> bool {
        let phase = self.phase.filter(|place| *place >= may_lack_from);
        let phase = phase.and_then(|place| row.get(place));
        phase.is_some_and(|phase| phase.is_nan())
    }

    pub(crate) fn has_torque(&self) -> bool {
        self.torque.is_some()
    }

    pub(crate) fn has_encoder(&self) -> bool {
        self.encoder_omega.is_some()
    }

    pub(crate) fn has_hand(&self) -> bool {
        self.hand_torque.is_some()
    }

    pub(crate) fn has_leg(&self) -> bool {
        self.leg_angle.is_some() || self.intended_angle.is_some()
    }

    pub(crate) fn has_object(&self) -> bool {
        self.theta.is_some() && self.theta_dot.is_some() && self.phase.is_some()
    }
}

fn phase_of(number: f64) -> Option<Phase> {
    if number.is_nan() {
        None
    } else if number > 0.5 {
        Some(Phase::from_sign(1))
    } else if number < -0.5 {
        Some(Phase::from_sign(-1))
    } else {
        Some(Phase::Stick)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_scene::trace::ColumnKind;

    #[test]
    fn absent_short_and_broken_values_are_nan() {
        let column = |name| Column {
            name,
            kind: ColumnKind::Number,
        };
        let columns = [
            column("t_s"),
            column("angle_rad"),
            column("omega_rad_s"),
            column("phase"),
        ];
        let channels = Channels::find(&columns);
        assert!(!channels.has_torque());
        let sample = channels.sample(&[1.0, f64::INFINITY, 2.0]);
        assert_eq!(sample.time, 1.0);
        assert!(sample.angle.is_nan());
        assert_eq!(sample.omega, 2.0);
        assert_eq!(sample.phase, None);
        assert!(sample.torque.is_nan());
        let sample = channels.sample(&[1.0, 0.0, 2.0, -1.0]);
        assert_eq!(sample.phase.map(Phase::sign), Some(-1));
    }
}
