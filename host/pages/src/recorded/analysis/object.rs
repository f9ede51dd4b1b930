//! The imaginary object, reconstructed from a device's samples.

use crepitus_model::Parameters;
use crepitus_model::joint::oscillator::Oscillator;
use crepitus_protocol::TICK_S;
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_recording::Row;
use crepitus_scene::trace::{EventKind, EventRecord};

/// Angle and velocity of the imaginary object; NaN where they are unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// Angle of the object, rad.
    pub theta_rad: f64,
    /// Velocity of the object, rad/s.
    pub theta_dot_rad_s: f64,
}

const UNKNOWN: Object = Object {
    theta_rad: f64::NAN,
    theta_dot_rad_s: f64::NAN,
};

/// Follows the object from row to row. In a stick its angle is torque over stiffness; in a
/// slip it swings about sense·Tk/kr from where the stick broke, with the
/// shaft's speed.
#[derive(Debug, Default)]
pub(super) struct ObjectTracker {
    /// None if they are unknown.
    parameters: Option<Parameters>,
    object: Option<Object>,
    previous: Option<(i8, f64)>,
    /// Sense of the phase and torque, N·m, of the row before the one that was followed last.
    before: Option<(i8, f64)>,
}

impl ObjectTracker {
    /// Sets the parameters from the next row on.
    pub(super) fn set(&mut self, parameters: Option<Parameters>) {
        self.parameters = parameters;
    }

    /// The object in this row.
    pub(super) fn follow(&mut self, row: &Row) -> Object {
        let sign = row.flags.phase_sign();
        let torque_nm = f64::from(row.model_torque_nm);
        let object = match (self.parameters, sign) {
            (None, _) => UNKNOWN,
            (Some(p), 0) => Object {
                theta_rad: torque_nm / p.stiffness_nm_per_rad,
                theta_dot_rad_s: f64::from(row.omega_rad_s),
            },
            (Some(p), sign) => self.slip(&p, f64::from(sign), row),
        };
        self.object = Some(object);
        self.before = self.previous;
        self.previous = Some((sign, torque_nm));
        object
    }

    fn slip(&self, p: &Parameters, sense: f64, row: &Row) -> Object {
        let middle_rad = sense * p.kinetic_torque_nm / p.stiffness_nm_per_rad;
        let began = self
            .previous
            .is_none_or(|(sign, _)| f64::from(sign) != sense);
        let before = match self.object {
            Some(object) if !began => object,
            // The object broke loose within this tick: at Ts/kr, with the shaft.
            _ => Object {
                theta_rad: sense * p.static_torque_nm / p.stiffness_nm_per_rad,
                theta_dot_rad_s: f64::from(row.omega_rad_s),
            },
        };
        let swing = Oscillator::<f64>::of(p).transition(TICK_S);
        let (x, v) = swing.apply(before.theta_rad - middle_rad, before.theta_dot_rad_s);
        Object {
            theta_rad: x + middle_rad,
            theta_dot_rad_s: v,
        }
    }

    /// The event of the row that was followed last, if it has one.
    pub(super) fn event(&self, row: &Row, object: &Object) -> Option<EventRecord> {
        let kind = if row.flags.has(SampleFlags::BREAK) {
            EventKind::Break
        } else if row.flags.has(SampleFlags::STICK) {
            EventKind::Stick
        } else {
            return None;
        };
        let (from, torque_before_nm) = self.before?;
        Some(EventRecord {
            time_s: row.time_s,
            kind,
            from,
            to: row.flags.phase_sign(),
            theta_rad: object.theta_rad,
            omega_rad_s: f64::from(row.omega_rad_s),
            torque_before_nm,
            torque_after_nm: f64::from(row.model_torque_nm),
        })
    }
}
