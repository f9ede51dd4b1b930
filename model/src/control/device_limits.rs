//! Safety limits of a device, and the torque constant of its motor.
//!
//! Sources: gear torque 4.5 N·m continuous and 6.5 N·m short, input speed
//! 6000 rpm, which is 420 deg/s at the joint (GP 32 A data sheet); slew is an
//! engineering estimate; torque constant of the maxon RE35, 30 V winding. What the
//! motor gives, a back-driving hand feels as 1/0.70 of it: 4.5 N·m are the gear's 6.5.

use crate::parameters::settings;

settings! {
    /// Limits of a device.
    pub struct LimitSettings, group "limits" {} {
        torque_nm (26 always) "Tmax" "N·m", 0.0..=4.5, 4.5,
            "largest torque of the motor at the joint; a hand that back-drives the gear feels up to 6.5";
        slew_nm_per_s (27 always) "Ṫmax" "N·m/s", 1.0..=1e3, 100.0,
            "how fast torque grows after arming and after a change; the model's own jumps are exempt";
        speed_rad_s (28 disarmed) "Ωmax" "rad/s", 0.1..=7.33, 7.33,
            "speed of the joint beyond which the device disarms: 7.33 is the gear's 420 deg/s; at 24 V it disarms above \
             5.73, as the back-EMF of a faster motor is more than the bridge holds";
    }
}

settings! {
    /// Range of motion, from the angle's zero: positive in flexion.
    ///
    /// Defaults: a knee from straight to 120° feels the whole torque. The stops of the
    /// brace are 5° beyond either end. A bench without a leg may turn further.
    pub struct RangeSettings, group "range" {} {
        least_deg (29 disarmed) "θmin" "deg", -3600.0..=3600.0, -5.0,
            "end of the range in extension: from here on there is no torque";
        most_deg (30 disarmed) "θmax" "deg", -3600.0..=3600.0, 125.0,
            "end of the range in flexion: from here on there is no torque";
        fade_deg (31 disarmed) "θfade" "deg", 1.0..=30.0, 5.0,
            "before either end the torque fades over this angle; \
             as far beyond it the device disarms with a fault";
    }
}

settings! {
    /// A sensor of the joint's own angle, behind gear and coupling.
    pub struct JointSensorSettings, group "joint-sensor" {
        fitted (32 disarmed) ["no", "yes"], 0,
            "the joint has an angle sensor; without one a coupling that slips is not detected";
    } {
        tolerance_deg (33 disarmed) "Δθ" "deg", 2.0..=20.0, 4.0,
            "by how much sensor and encoder may differ: backlash, the sensor's error and its lag";
    }
}

settings! {
    /// Torque constant of the motor, and what gear and motor bear.
    pub struct MotorSettings, group "motor" {} {
        torque_constant_nm_per_a (25 disarmed) "Kt" "N·m/A", 1e-4..=10.0, 0.0389,
            "torque of the motor for one ampere, and its back-EMF for one rad/s";
        continuous_a (34 disarmed) "Ic" "A", 0.01..=0.95, 0.95,
            "current that gear and motor bear for ever: 4.5 N·m at a hand that back-drives the gear; \
             the largest current for a second";
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_their_table_and_are_held_to_it() {
        crate::parameters::tests::is_its_table_and_is_held_to_it::<3, LimitSettings>();
        crate::parameters::tests::is_its_table_and_is_held_to_it::<3, RangeSettings>();
        crate::parameters::tests::is_its_table_and_is_held_to_it::<1, JointSensorSettings>();
        crate::parameters::tests::is_its_table_and_is_held_to_it::<2, MotorSettings>();
    }
}
