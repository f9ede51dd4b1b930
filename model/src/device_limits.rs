//! What a device never does, whatever it is asked for, and what its motor is
//! worth at the joint.
//!
//! Sources: gear torque 4.5 N·m continuous and 6.5 N·m short, input speed
//! 6000 rpm, which is 420 deg/s at the joint (GP 32 A data sheet); slew is an
//! engineering estimate; torque constant of the maxon RE35, 30 V winding.

use crate::parameters::{ParameterSpec, Tabled};

/// Limits of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitSettings {
    /// Largest torque at the joint, N·m.
    pub torque_nm: f64,
    /// How fast torque grows where the model does not make it jump, N·m/s.
    pub slew_nm_per_s: f64,
    /// Speed of the joint beyond which the device lets go, rad/s.
    pub speed_rad_s: f64,
}

impl Tabled<3> for LimitSettings {
    const TABLE: &'static [ParameterSpec; 3] = &[
        ParameterSpec {
            key: "torque_nm",
            symbol: "Tmax",
            unit: "N·m",
            min: 0.0,
            max: 6.5,
            default: 4.5,
            meaning: "largest torque at the joint: 4.5 for ever, 6.5 for a short time",
        },
        ParameterSpec {
            key: "slew_nm_per_s",
            symbol: "Ṫmax",
            unit: "N·m/s",
            min: 1.0,
            max: 1e3,
            default: 100.0,
            meaning: "how fast torque grows after arming and after a change; the model's own jumps are exempt",
        },
        ParameterSpec {
            key: "speed_rad_s",
            symbol: "Ωmax",
            unit: "rad/s",
            min: 0.1,
            max: 7.33,
            default: 7.33,
            meaning: "speed of the joint beyond which the device lets go: 7.33 is the gear's 420 deg/s",
        },
    ];

    fn values(&self) -> [f64; 3] {
        [self.torque_nm, self.slew_nm_per_s, self.speed_rad_s]
    }

    fn of([torque_nm, slew_nm_per_s, speed_rad_s]: [f64; 3]) -> Self {
        Self {
            torque_nm,
            slew_nm_per_s,
            speed_rad_s,
        }
    }
}

impl Default for LimitSettings {
    fn default() -> Self {
        Self::defaults()
    }
}

/// Torque of the motor for one ampere, and its back-EMF for one rad/s.
pub const TORQUE_CONSTANT: ParameterSpec = ParameterSpec {
    key: "torque_constant_nm_per_a",
    symbol: "Kt",
    unit: "N·m/A",
    min: 1e-4,
    max: 10.0,
    default: 0.0389,
    meaning: "torque of the motor for one ampere, and its back-EMF for one rad/s",
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_their_table_and_are_held_to_it() {
        crate::parameters::tests::is_its_table_and_is_held_to_it::<3, LimitSettings>();
    }
}
