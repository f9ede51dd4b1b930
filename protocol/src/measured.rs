//! What the drive measures beside the motion.

use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Readings that change slowly, as of the last status of the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Measured {
    /// Voltage of the motor's supply, 10 mV.
    pub supply_cv: u16,
    /// Temperature of the motor, °C.
    pub motor_c: i16,
    /// By how much the joint's sensor and the encoder have moved against each other
    /// since the angle's zero, 0.01°: backlash is not more. None without a sensor or
    /// a zero.
    pub joint_cdeg: Option<u16>,
}
