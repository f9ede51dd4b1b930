//! Measurements of the drive beside the motion.

use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Voltages of the supply that are allowed, as shares of `motor.supply_v`.
pub const SUPPLY_SHARES: (f64, f64) = (0.75, 1.25);

/// Temperatures of the motor's housing that are allowed, °C: up to 15 K below what its
/// winding bears. A broken line reads −50 °C.
pub const MOTOR_C: (f32, f32) = (-20.0, 70.0);

/// Readings that change slowly, as of the last status of the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Measured {
    /// Voltage of the motor's supply, 10 mV.
    pub supply_cv: u16,
    /// Temperature of the motor, °C.
    pub motor_c: i16,
    /// Movement of the joint's sensor and the encoder against each other
    /// since the angle's zero, 0.01°: backlash is not more. None without a sensor or
    /// a zero.
    pub joint_cdeg: Option<u16>,
}
