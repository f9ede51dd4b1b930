//! The fault table: cause, detection, reaction, reaction time, remedy.
//!
//! Faults latch. The command `clear-fault` clears a fault once the bridge floats
//! and the cause is gone.

mod spec;

pub use spec::{Detector, FaultSpec};

/// A fault; its number is its code on the wire and never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
#[expect(missing_docs, reason = "the table says it")]
pub enum Fault {
    CommsSilent = 1,
    LeaseExpired = 2,
    CommsRestarted = 3,
    EncoderLost = 4,
    Overspeed = 5,
    SpeedMismatch = 6,
    EncoderPolarity = 7,
    CurrentOffset = 8,
    Overcurrent = 9,
    CurrentMissing = 10,
    CurrentMismatch = 11,
    EnableStuckOn = 12,
    EnableStuckOff = 13,
    RenderingLate = 14,
    NotANumber = 15,
    DriveWatchdog = 16,
    DriveBrownOut = 17,
    DrivePanic = 18,
    CurrentDisagreement = 19,
    TickIrregular = 20,
    CommsLineOff = 21,
    CurrentWhileFloating = 22,
    OutsideRange = 23,
    SupplyLow = 24,
    SupplyHigh = 25,
    MotorHot = 26,
    JointMismatch = 27,
    Overload = 28,
    DriveGateStuck = 29,
    CommsGateStuck = 30,
    DriveImageBroken = 31,
    DriveSilent = 32,
    DriveRestarted = 33,
    CommsEnableStuckOn = 34,
    CommsEnableStuckOff = 35,
    VersionMismatch = 36,
    CommsWatchdog = 37,
    CommsBrownOut = 38,
    CommsPanic = 39,
    DriveClock = 40,
    CommsOvercurrent = 41,
    TorqueBeyondBounds = 42,
    CurrentBesideTorque = 43,
    CommsOverspeed = 44,
    TorqueOutsideRange = 45,
    CommsImageBroken = 46,
    DriveOptionBytes = 47,
    CommsOptionBytes = 48,
}

const FLOAT: &str = "the bridge floats (coast)";
const LINE_OFF: &str = "comms switches its enable line off: the bridge floats";
const STAYS: &str = "the bridge stays floating; arming is refused";
const CLEAR: &str = "clear-fault";
const REPAIR: &str = "repair, then clear-fault";

/// All faults, in the order of their codes.
pub const FAULTS: [FaultSpec; 48] = [
    FaultSpec {
        fault: Fault::CommsSilent,
        name: "comms-silent",
        cause: "the link is cut or too noisy, or comms hangs, is reset or has no power",
        detector: Detector::Drive,
        detection: "no fresh heartbeat for 94 ticks while armed; up to 7 pass before one that has arrived is read",
        reaction: FLOAT,
        within_ticks: Some(101),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::LeaseExpired,
        name: "lease-expired",
        cause: "the host was killed, unplugged, or is too busy to renew its lease",
        detector: Detector::Drive,
        detection: "no renewal of the lease for 5,001 ticks (250 ms) while armed",
        reaction: FLOAT,
        within_ticks: Some(5_001),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::CommsRestarted,
        name: "comms-restarted",
        cause: "comms was reset and is back within 5 ms; if it takes longer it is comms-silent",
        detector: Detector::Drive,
        detection: "the boot counter in the heartbeats changes while armed",
        reaction: FLOAT,
        within_ticks: Some(101),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::EncoderLost,
        name: "encoder-lost",
        cause: "a broken encoder line, or interference",
        detector: Detector::Drive,
        detection: "20 ticks (1 ms) without a plausible count; eight with one make up for one without",
        reaction: FLOAT,
        within_ticks: Some(21),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::Overspeed,
        name: "overspeed",
        cause: "the joint turns faster than its gear permits, or than the supply could hold the motor's current",
        detector: Detector::Drive,
        detection: "the estimated speed is above limits.speed_rad_s, or above 95 % of that whose back-EMF is the bridge's \
                    largest voltage with the supply as it is (5.73 rad/s at 24 V), for 20 ticks (1 ms) while armed; the estimate lags a speed that grows by up to 150 ticks",
        reaction: FLOAT,
        within_ticks: Some(170),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::SpeedMismatch,
        name: "speed-mismatch",
        cause: "the supply is off or the hand-held stop is pressed, a broken motor line, an encoder that has frozen or \
                slips, or two current sensors that are wrong in the same way",
        detector: Detector::Drive,
        detection: "speed from back-EMF and speed from the encoder contradict each other while armed: over 4 ticks twice \
                    in a row by 0.28 rad/s and a quarter of what the voltage drives, or for 400 ticks (20 ms), or in \
                    sum by 10 mrad, beyond 0.5 rad/s and a quarter; \
                    an encoder that freezes is detected only once the shaft moves faster than 0.5 rad/s (29 deg/s)",
        reaction: FLOAT,
        within_ticks: Some(200),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::EncoderPolarity,
        name: "encoder-polarity",
        cause: "encoder or motor lines are swapped",
        detector: Detector::Drive,
        detection: "the push at arming, 16 ms, moves the shaft the wrong way",
        reaction: "the push ends and the bridge floats; arming is refused",
        within_ticks: Some(330),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CurrentOffset,
        name: "current-offset",
        cause: "the current sensor has drifted or is broken",
        detector: Detector::Drive,
        detection: "more than 0.1 A is measured at arming, by one of the sensors, while the bridge floats",
        reaction: STAYS,
        within_ticks: None,
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::Overcurrent,
        name: "overcurrent",
        cause: "a short circuit, an unstable current loop, or a current sensor that is stuck",
        detector: Detector::Drive,
        detection: "more than 1.95 A in 2 consecutive ticks, or the hardware's break input",
        reaction: FLOAT,
        within_ticks: Some(3),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CurrentMissing,
        name: "current-missing",
        cause: "the converter does not run",
        detector: Detector::Drive,
        detection: "3 ticks without a measured current, from one of the sensors, while armed; eight with both make up for \
                    one without",
        reaction: FLOAT,
        within_ticks: Some(4),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CurrentMismatch,
        name: "current-mismatch",
        cause: "the current loop does not follow: its parameters do not fit the motor",
        detector: Detector::Drive,
        detection: "the current stays more than 0.2 A from the setpoint for 100 ticks (5 ms), though the voltage \
                    could drive it at this speed",
        reaction: FLOAT,
        within_ticks: Some(101),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::EnableStuckOn,
        name: "enable-stuck-on",
        cause: "the drive's enable line cannot be switched off",
        detector: Detector::Drive,
        detection: "the line is read back at every arming and disarming",
        reaction: "comms switches its own line off; arming is refused",
        within_ticks: Some(10),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::EnableStuckOff,
        name: "enable-stuck-off",
        cause: "the drive's enable line cannot be switched on, or falls while armed",
        detector: Detector::Drive,
        detection: "the line is read back off in 9 ticks; eight with it on make up for one",
        reaction: FLOAT,
        within_ticks: Some(10),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::RenderingLate,
        name: "rendering-late",
        cause: "the model's task does not finish within its tick, or its timer has stopped or has another rate",
        detector: Detector::Drive,
        detection: "20 ticks without a new result, or after one more than one a tick; one in time makes up for a fifth of \
                    one that is late",
        reaction: FLOAT,
        within_ticks: Some(21),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::NotANumber,
        name: "not-a-number",
        cause: "a bug in the program",
        detector: Detector::Drive,
        detection: "the rendered torque is NaN or infinite",
        reaction: FLOAT,
        within_ticks: Some(1),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::DriveWatchdog,
        name: "drive-watchdog",
        cause: "the drive hung",
        detector: Detector::Drive,
        detection: "its watchdog reset it; reported at the next boot",
        reaction: STAYS,
        within_ticks: None,
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::DriveBrownOut,
        name: "drive-brown-out",
        cause: "the drive's supply failed",
        detector: Detector::Drive,
        detection: "the reset's cause, at the next boot",
        reaction: STAYS,
        within_ticks: None,
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::DrivePanic,
        name: "drive-panic",
        cause: "a bug in the program",
        detector: Detector::Drive,
        detection: "its panic or fault handler, at the next boot",
        reaction: STAYS,
        within_ticks: None,
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::CurrentDisagreement,
        name: "current-disagreement",
        cause: "one of the two shunts, amplifiers or converters of the motor's current is broken or has drifted",
        detector: Detector::Drive,
        detection: "the two sensors of the current differ by more than 0.2 A in 2 ticks while armed; eight in which they do not make up \
                    for one",
        reaction: FLOAT,
        within_ticks: Some(3),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::TickIrregular,
        name: "tick-irregular",
        cause: "the timer of the drive's tasks is disturbed, or something holds up its most urgent task",
        detector: Detector::Drive,
        detection: "the time between two ticks, by another timer, is not 50 ± 5 µs 3 consecutive times while \
                    armed",
        reaction: FLOAT,
        within_ticks: Some(4),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::CommsLineOff,
        name: "comms-line-off",
        cause: "the wire by which the drive reads the enable line of comms is broken",
        detector: Detector::Drive,
        detection: "that line reads off for 120 ticks (6 ms) while comms permits torque, of which four with the line make up \
                    for one, or for 2,000 at arming; the bridge floats meanwhile",
        reaction: FLOAT,
        within_ticks: Some(2),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CurrentWhileFloating,
        name: "current-while-floating",
        cause: "a switch of the bridge is shorted: with a diode of another it brakes the joint, in one direction",
        detector: Detector::Drive,
        detection: "both sensors show more than 0.2 A for 20 ticks (1 ms) while the bridge floats and the joint is \
                    slower than its supply could drive it",
        reaction: "none can be taken by a program: press the hand-held stop, which opens the motor's own line",
        within_ticks: None,
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::OutsideRange,
        name: "outside-range",
        cause: "the leg is beyond its range of motion, or the angle's zero was set in a wrong place",
        detector: Detector::Drive,
        detection: "the angle is beyond an end of the range by more than range.fade_deg for 20 ticks (1 ms) while armed; \
                    from the end on there was no torque",
        reaction: FLOAT,
        within_ticks: Some(21),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::SupplyLow,
        name: "supply-low",
        cause: "the motor's supply sags or is off, or the line that measures it is broken",
        detector: Detector::Drive,
        detection: "20 consecutive readings below 75 % of motor.supply_v while armed, 60 ticks; or none",
        reaction: FLOAT,
        within_ticks: Some(61),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::SupplyHigh,
        name: "supply-high",
        cause: "the clamp does not take what a leg that is moved puts into the supply, or the supply is wrong",
        detector: Detector::Drive,
        detection: "4 consecutive readings above 125 % of motor.supply_v, 12 ticks, armed or not",
        reaction: FLOAT,
        within_ticks: Some(13),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::MotorHot,
        name: "motor-hot",
        cause: "the motor is too hot, or its sensor is broken or unplugged",
        detector: Detector::Drive,
        detection: "667 consecutive readings that are not between -20 and 70 °C while armed, 2,000 ticks",
        reaction: FLOAT,
        within_ticks: Some(2_001),
        clear: "let it cool, or repair its sensor, then clear-fault",
    },
    FaultSpec {
        fault: Fault::JointMismatch,
        name: "joint-mismatch",
        cause: "the coupling between gear and brace slips, the encoder slips, or the joint's sensor is broken",
        detector: Detector::Drive,
        detection: "with a joint-sensor: 20 consecutive readings that are more than joint-sensor.tolerance_deg from \
                    the encoder's angle while armed, 60 ticks",
        reaction: FLOAT,
        within_ticks: Some(61),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::Overload,
        name: "overload",
        cause: "more torque for longer than the gear bears",
        detector: Detector::Drive,
        detection: "the square of the current above that of motor.continuous_a sums up to what the largest current gives \
                    in a second: after 1.1 s of 4.5 N·m, later with less",
        reaction: FLOAT,
        within_ticks: Some(21_800),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::DriveGateStuck,
        name: "drive-gate-stuck",
        cause: "two outputs or more of the drive's gate do not follow its enable line",
        detector: Detector::Drive,
        detection: "a push of 0.6 V at arming, with the drive's line off and that of comms on, moves current: more than \
                    0.15 A in 2 consecutive ticks",
        reaction: "the push ends and the bridge floats; arming is refused",
        within_ticks: Some(10),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CommsGateStuck,
        name: "comms-gate-stuck",
        cause: "two outputs or more of the gate of comms do not follow its enable line",
        detector: Detector::Drive,
        detection: "the same with the line of comms off and the drive's on; or the line of comms reads on before it should",
        reaction: "the push ends and the bridge floats; arming is refused",
        within_ticks: Some(10),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::DriveImageBroken,
        name: "drive-image-broken",
        cause: "the drive's flash does not hold the program that was sealed",
        detector: Detector::Drive,
        detection: "the seal in the vector table against the checksum of the flash, at every start",
        reaction: STAYS,
        within_ticks: None,
        clear: "flash the drive again",
    },
    FaultSpec {
        fault: Fault::DriveSilent,
        name: "drive-silent",
        cause: "the link is cut or too noisy, or the drive hangs, is reset or has no power",
        detector: Detector::Comms,
        detection: "no block from the drive for 5 ms",
        reaction: LINE_OFF,
        within_ticks: Some(140),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::DriveRestarted,
        name: "drive-restarted",
        cause: "the drive was reset while armed and is back within 5 ms; if it takes longer it is drive-silent",
        detector: Detector::Comms,
        detection: "the drive's ticks restart",
        reaction: LINE_OFF,
        within_ticks: Some(140),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::CommsEnableStuckOn,
        name: "comms-enable-stuck-on",
        cause: "the enable line of comms cannot be switched off",
        detector: Detector::Comms,
        detection: "the line is read back at every arming and disarming",
        reaction: STAYS,
        within_ticks: None,
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CommsEnableStuckOff,
        name: "comms-enable-stuck-off",
        cause: "the enable line of comms cannot be switched on, or falls while armed",
        detector: Detector::Comms,
        detection: "the line is read back every millisecond",
        reaction: FLOAT,
        within_ticks: Some(80),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::VersionMismatch,
        name: "version-mismatch",
        cause: "drive and comms run incompatible programs",
        detector: Detector::Comms,
        detection: "the schema hash in the drive's hello",
        reaction: STAYS,
        within_ticks: None,
        clear: "flash both controllers with the same version",
    },
    FaultSpec {
        fault: Fault::CommsWatchdog,
        name: "comms-watchdog",
        cause: "comms hung",
        detector: Detector::Comms,
        detection: "its watchdog reset it; reported at the next boot",
        reaction: STAYS,
        within_ticks: None,
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::CommsBrownOut,
        name: "comms-brown-out",
        cause: "the supply of comms failed",
        detector: Detector::Comms,
        detection: "the reset's cause, at the next boot",
        reaction: STAYS,
        within_ticks: None,
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::CommsPanic,
        name: "comms-panic",
        cause: "a bug in the program",
        detector: Detector::Comms,
        detection: "its panic or fault handler, at the next boot",
        reaction: STAYS,
        within_ticks: None,
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::DriveClock,
        name: "drive-clock",
        cause: "a crystal of the wrong frequency, a timer that is disturbed, or blocks that are late by 20 ms",
        detector: Detector::Comms,
        detection: "the drive's ticks and the milliseconds of comms differ by more than 20 ms within 4 s",
        reaction: LINE_OFF,
        within_ticks: Some(1_100),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CommsOvercurrent,
        name: "comms-overcurrent",
        cause: "the drive does not react to too much current",
        detector: Detector::Comms,
        detection: "more than 1.95 A in 4 samples while the drive is armed; one with less makes up for one",
        reaction: LINE_OFF,
        within_ticks: Some(100),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::TorqueBeyondBounds,
        name: "torque-beyond-bounds",
        cause: "the drive computes wrongly",
        detector: Detector::Comms,
        detection: "in 4 samples the torque is above limits.torque_nm, or beside the model's by more than what is \
                    added to it and what the joint may hold back, or the model's above its static torque, as \
                    committed; one within the bounds makes up for one. Or 24 samples with torque of a drive that \
                    says it is not armed, while the line of comms is on",
        reaction: LINE_OFF,
        within_ticks: Some(100),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CurrentBesideTorque,
        name: "current-beside-torque",
        cause: "the drive's current loop does not follow, and it does not react",
        detector: Detector::Comms,
        detection: "in 120 samples the current is 0.375 A or more from that of the torque, or missing though there \
                    is torque; less than that counts in part down to 0.25 A, and one below makes up for one; not at \
                    a speed that needs all voltage",
        reaction: LINE_OFF,
        within_ticks: Some(220),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CommsOverspeed,
        name: "comms-overspeed",
        cause: "the drive does not react to too much speed",
        detector: Detector::Comms,
        detection: "in 3 blocks the counts are above 1.15 times the speed at which the drive lets go, with the \
                    supply as it is set; a slower one makes up for one, and blocks may be missing between",
        reaction: LINE_OFF,
        within_ticks: Some(160),
        clear: CLEAR,
    },
    FaultSpec {
        fault: Fault::TorqueOutsideRange,
        name: "torque-outside-range",
        cause: "the drive does not follow its range of motion",
        detector: Detector::Comms,
        detection: "4 samples with torque outside the range of motion or without a zero of the angle, of which one \
                    inside makes up for one; or 40 without a plausible count, of which eight with one make up for \
                    one",
        reaction: LINE_OFF,
        within_ticks: Some(100),
        clear: REPAIR,
    },
    FaultSpec {
        fault: Fault::CommsImageBroken,
        name: "comms-image-broken",
        cause: "the flash of comms does not hold the program that was sealed",
        detector: Detector::Comms,
        detection: "the seal in the vector table against the checksum of the flash, at every start",
        reaction: STAYS,
        within_ticks: None,
        clear: "flash comms again",
    },
    FaultSpec {
        fault: Fault::DriveOptionBytes,
        name: "drive-option-bytes",
        cause: "the option bytes of the drive are not those of this board",
        detector: Detector::Drive,
        detection: "at every start: brown-out level 3, and a watchdog that software starts",
        reaction: STAYS,
        within_ticks: None,
        clear: "program the option bytes, then switch off and on",
    },
    FaultSpec {
        fault: Fault::CommsOptionBytes,
        name: "comms-option-bytes",
        cause: "the option bytes of comms are not those of this board",
        detector: Detector::Comms,
        detection: "at every start: brown-out level 3, and a watchdog that software starts",
        reaction: STAYS,
        within_ticks: None,
        clear: "program the option bytes, then switch off and on",
    },
];

impl Fault {
    /// Code on the wire.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Returns whether the encoder's counts may be wrong after it, and the angle's zero with
    /// them.
    pub const fn doubts_angle(self) -> bool {
        matches!(
            self,
            Self::EncoderLost | Self::EncoderPolarity | Self::SpeedMismatch | Self::JointMismatch
        )
    }

    /// Description of a fault by its code.
    pub fn find(code: u8) -> Option<&'static FaultSpec> {
        FAULTS.iter().find(|spec| spec.fault.code() == code)
    }
}

#[cfg(test)]
mod tests;
