//! The fault table: cause, detection, reaction, reaction time, remedy.
//!
//! Faults latch. The command `clear-fault` clears a fault once the bridge floats
//! and the cause is gone.

mod spec;

pub use spec::{Detector, FaultSpec};

const FLOAT: &str = "the bridge floats (coast)";
const LINE_OFF: &str = "comms switches its enable line off: the bridge floats";
const PUSH_ENDS: &str = "the push ends and the bridge floats; arming is refused";
const STAYS: &str = "the bridge stays floating; arming is refused";
const CLEAR: &str = "clear-fault";
const REPAIR: &str = "repair, then clear-fault";

macro_rules! faults {
    ($(
        $fault:ident = $code:literal, $name:literal, $detector:ident, $reaction:expr, $within_ticks:expr, $clear:expr;
        $cause:literal;
        $detection:literal;
    )*) => {
        /// A fault; its number is its code on the wire and never changes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum Fault {
            $(#[doc = $cause] $fault = $code,)*
        }

        /// All faults, in the order of their codes.
        pub const FAULTS: [FaultSpec; 50] = [$(FaultSpec {
            fault: Fault::$fault,
            name: $name,
            cause: $cause,
            detector: Detector::$detector,
            detection: $detection,
            reaction: $reaction,
            within_ticks: $within_ticks,
            clear: $clear,
        }),*];
    };
}

// Code, name, detector, reaction, ticks until the bridge floats, remedy; cause; detection.
faults! {
    CommsSilent = 1, "comms-silent", Drive, FLOAT, Some(101), CLEAR;
        "the link is cut or too noisy, or comms hangs, is reset or has no power";
        "no fresh heartbeat for 94 ticks while armed; up to 7 pass before one that has arrived is read";
    LeaseExpired = 2, "lease-expired", Drive, FLOAT, Some(5_001), CLEAR;
        "the host was killed, unplugged, or is too busy to renew its lease";
        "no renewal of the lease for 5,001 ticks (250 ms) while armed";
    CommsRestarted = 3, "comms-restarted", Drive, FLOAT, Some(101), CLEAR;
        "comms was reset and is back within 5 ms; if it takes longer it is comms-silent";
        "the boot counter in the heartbeats changes while armed";
    EncoderLost = 4, "encoder-lost", Drive, FLOAT, Some(21), REPAIR;
        "a broken encoder line, or interference";
        "20 ticks (1 ms) without a plausible count; eight with one make up for one without";
    Overspeed = 5, "overspeed", Drive, FLOAT, Some(170), CLEAR;
        "the joint turns faster than its gear permits, or than the supply could hold the motor's current";
        "the estimated speed is above limits.speed_rad_s, or above 95 % of that whose back-EMF is the bridge's \
         largest voltage with the supply as it is (5.73 rad/s at 24 V), for 20 ticks (1 ms) while armed; the estimate lags a speed that grows by up to 150 ticks";
    SpeedMismatch = 6, "speed-mismatch", Drive, FLOAT, Some(200), REPAIR;
        "the supply is off or the hand-held stop is pressed, a broken motor line, an encoder that has frozen or \
         slips, or two current sensors that are wrong in the same way";
        "speed from back-EMF and speed from the encoder contradict each other while armed: over 4 ticks twice \
         in a row by 0.28 rad/s and a quarter of what the voltage drives, or for 400 ticks (20 ms), or in \
         sum by 10 mrad, beyond 0.5 rad/s and a quarter; \
         an encoder that freezes is detected only once the shaft moves faster than 0.5 rad/s (29 deg/s)";
    EncoderPolarity = 7, "encoder-polarity", Drive, PUSH_ENDS, Some(330), REPAIR;
        "encoder or motor lines are swapped";
        "the push at arming, 16 ms, moves the shaft the wrong way";
    CurrentOffset = 8, "current-offset", Drive, STAYS, None, REPAIR;
        "the current sensor has drifted or is broken";
        "more than 0.1 A is measured at arming, by one of the sensors, while the bridge floats";
    Overcurrent = 9, "overcurrent", Drive, FLOAT, Some(3), REPAIR;
        "a short circuit, an unstable current loop, or a current sensor that is stuck";
        "more than 1.95 A in 2 consecutive ticks, or the hardware's break input";
    CurrentMissing = 10, "current-missing", Drive, FLOAT, Some(4), REPAIR;
        "the converter does not run";
        "3 ticks without a measured current, from one of the sensors, while armed; eight with both make up for \
         one without";
    CurrentMismatch = 11, "current-mismatch", Drive, FLOAT, Some(101), REPAIR;
        "the current loop does not follow: its parameters do not fit the motor";
        "the current stays more than 0.2 A from the setpoint for 100 ticks (5 ms), though the voltage \
         could drive it at this speed";
    EnableStuckOn = 12, "enable-stuck-on", Drive, "comms switches its own line off; arming is refused", Some(10), REPAIR;
        "the drive's enable line cannot be switched off";
        "the line is read back at every arming and disarming";
    EnableStuckOff = 13, "enable-stuck-off", Drive, FLOAT, Some(10), REPAIR;
        "the drive's enable line cannot be switched on, or falls while armed";
        "the line is read back off in 9 ticks; eight with it on make up for one";
    RenderingLate = 14, "rendering-late", Drive, FLOAT, Some(21), CLEAR;
        "the model's task does not finish within its tick, or its timer has stopped or has another rate";
        "20 ticks without a new result, or after one more than one a tick; one in time makes up for a fifth of \
         one that is late";
    NotANumber = 15, "not-a-number", Drive, FLOAT, Some(1), CLEAR;
        "a bug in the program";
        "the rendered torque is NaN or infinite";
    DriveWatchdog = 16, "drive-watchdog", Drive, STAYS, None, CLEAR;
        "the drive hung";
        "its watchdog reset it; reported at the next boot";
    DriveBrownOut = 17, "drive-brown-out", Drive, STAYS, None, CLEAR;
        "the drive's supply failed";
        "the reset's cause, at the next boot";
    DrivePanic = 18, "drive-panic", Drive, STAYS, None, CLEAR;
        "a bug in the program";
        "its panic or fault handler, at the next boot";
    CurrentDisagreement = 19, "current-disagreement", Drive, FLOAT, Some(3), REPAIR;
        "one of the two shunts, amplifiers or converters of the motor's current is broken or has drifted";
        "the two sensors of the current differ by more than 0.2 A in 2 ticks while armed; eight in which they do not make up \
         for one";
    TickIrregular = 20, "tick-irregular", Drive, FLOAT, Some(4), CLEAR;
        "the timer of the drive's tasks is disturbed, or something holds up its most urgent task";
        "the time between two ticks, by another timer, is not 50 ± 5 µs 3 consecutive times while \
         armed";
    CommsLineOff = 21, "comms-line-off", Drive, FLOAT, Some(2), REPAIR;
        "the wire by which the drive reads the enable line of comms is broken";
        "that line reads off for 120 ticks (6 ms) while comms permits torque, of which four with the line make up \
         for one, or for 2,000 at arming; the bridge floats meanwhile";
    CurrentWhileFloating = 22, "current-while-floating", Drive, "none can be taken by a program: press the hand-held stop, which opens the motor's own line", None, REPAIR;
        "a switch of the bridge is shorted: with a diode of another it brakes the joint, in one direction";
        "both sensors show more than 0.2 A for 20 ticks (1 ms) while the bridge floats and the joint is \
         slower than its supply could drive it";
    OutsideRange = 23, "outside-range", Drive, FLOAT, Some(21), CLEAR;
        "the leg is beyond its range of motion, or the angle's zero was set in a wrong place";
        "the angle is beyond an end of the range by more than range.fade_deg for 20 ticks (1 ms) while armed; \
         from the end on there was no torque";
    SupplyLow = 24, "supply-low", Drive, FLOAT, Some(61), CLEAR;
        "the motor's supply sags or is off, or the line that measures it is broken";
        "20 consecutive readings below 75 % of motor.supply_v while armed, 60 ticks; or none";
    SupplyHigh = 25, "supply-high", Drive, FLOAT, Some(13), REPAIR;
        "the clamp does not take what a leg that is moved puts into the supply, or the supply is wrong";
        "4 consecutive readings above 125 % of motor.supply_v, 12 ticks, armed or not";
    MotorHot = 26, "motor-hot", Drive, FLOAT, Some(2_001), "let it cool, or repair its sensor, then clear-fault";
        "the motor is too hot, or its sensor is broken or unplugged";
        "667 consecutive readings that are not between -20 and 70 °C while armed, 2,000 ticks";
    JointMismatch = 27, "joint-mismatch", Drive, FLOAT, Some(61), REPAIR;
        "the coupling between gear and brace slips, the encoder slips, or the joint's sensor is broken";
        "with a joint-sensor: 20 consecutive readings that are more than joint-sensor.tolerance_deg from \
         the encoder's angle while armed, 60 ticks";
    Overload = 28, "overload", Drive, FLOAT, Some(21_800), CLEAR;
        "more torque for longer than the gear bears";
        "the square of the current above that of motor.continuous_a sums up to what the largest current gives \
         in a second: after 1.1 s of 4.5 N·m, later with less";
    DriveGateStuck = 29, "drive-gate-stuck", Drive, PUSH_ENDS, Some(10), REPAIR;
        "two outputs or more of the drive's gate do not follow its enable line";
        "a push of 0.6 V at arming, with the drive's line off and that of comms on, moves current: more than \
         0.15 A in 2 consecutive ticks";
    CommsGateStuck = 30, "comms-gate-stuck", Drive, PUSH_ENDS, Some(10), REPAIR;
        "two outputs or more of the gate of comms do not follow its enable line";
        "the same with the line of comms off and the drive's on; or the line of comms reads on before it should";
    DriveImageBroken = 31, "drive-image-broken", Drive, STAYS, None, "flash the drive again";
        "the drive's flash does not hold the program that was sealed";
        "the seal in the vector table against the checksum of the flash, at every start";
    DriveSilent = 32, "drive-silent", Comms, LINE_OFF, Some(140), CLEAR;
        "the link is cut or too noisy, or the drive hangs, is reset or has no power";
        "no block from the drive for 5 ms";
    DriveRestarted = 33, "drive-restarted", Comms, LINE_OFF, Some(140), CLEAR;
        "the drive was reset while armed and is back within 5 ms; if it takes longer it is drive-silent";
        "the drive's ticks restart";
    CommsEnableStuckOn = 34, "comms-enable-stuck-on", Comms, STAYS, None, REPAIR;
        "the enable line of comms cannot be switched off";
        "the line is read back at every arming and disarming";
    CommsEnableStuckOff = 35, "comms-enable-stuck-off", Comms, FLOAT, Some(80), REPAIR;
        "the enable line of comms cannot be switched on, or falls while armed";
        "the line is read back every millisecond";
    VersionMismatch = 36, "version-mismatch", Comms, STAYS, None, "flash both controllers with the same version";
        "drive and comms run incompatible programs";
        "the schema hash in the drive's hello";
    CommsWatchdog = 37, "comms-watchdog", Comms, STAYS, None, CLEAR;
        "comms hung";
        "its watchdog reset it; reported at the next boot";
    CommsBrownOut = 38, "comms-brown-out", Comms, STAYS, None, CLEAR;
        "the supply of comms failed";
        "the reset's cause, at the next boot";
    CommsPanic = 39, "comms-panic", Comms, STAYS, None, CLEAR;
        "a bug in the program";
        "its panic or fault handler, at the next boot";
    DriveClock = 40, "drive-clock", Comms, LINE_OFF, Some(1_300), REPAIR;
        "a crystal of the wrong frequency, a timer that is disturbed, or blocks that are late by 20 ms";
        "the drive's ticks and the milliseconds of comms differ by more than 20 ms within 4 s";
    CommsOvercurrent = 41, "comms-overcurrent", Comms, LINE_OFF, Some(100), REPAIR;
        "the drive does not react to too much current";
        "more than 1.95 A in 4 samples while the drive is armed; one with less makes up for one";
    TorqueBeyondBounds = 42, "torque-beyond-bounds", Comms, LINE_OFF, Some(100), REPAIR;
        "the drive computes wrongly";
        "in 4 samples the torque is above limits.torque_nm, or beside the model's by more than what is \
         added to it and what the joint may hold back, or the model's above its static torque, as \
         committed; one within the bounds makes up for one. Or 24 samples with torque of a drive that \
         says it is not armed, while the line of comms is on";
    CurrentBesideTorque = 43, "current-beside-torque", Comms, LINE_OFF, Some(220), REPAIR;
        "the drive's current loop does not follow, and it does not react";
        "in 120 samples the current is 0.375 A or more from that of the torque, or missing though there \
         is torque; less than that counts in part down to 0.25 A, and one below makes up for one; not at \
         a speed that needs all voltage";
    CommsOverspeed = 44, "comms-overspeed", Comms, LINE_OFF, Some(160), CLEAR;
        "the drive does not react to too much speed";
        "in 3 blocks the counts are above 1.15 times the speed at which the drive lets go, with the \
         supply as it is set; a slower one makes up for one, and blocks may be missing between";
    TorqueOutsideRange = 45, "torque-outside-range", Comms, LINE_OFF, Some(100), REPAIR;
        "the drive does not follow its range of motion";
        "4 samples with torque outside the range of motion or without a zero of the angle, of which one \
         inside makes up for one; or 40 without a plausible count, of which eight with one make up for \
         one";
    CommsImageBroken = 46, "comms-image-broken", Comms, STAYS, None, "flash comms again";
        "the flash of comms does not hold the program that was sealed";
        "the seal in the vector table against the checksum of the flash, at every start";
    DriveOptionBytes = 47, "drive-option-bytes", Drive, STAYS, None, "program the option bytes, then switch off and on";
        "the option bytes of the drive are not those of this board";
        "at every start: brown-out level 3, and a watchdog that software starts";
    CommsOptionBytes = 48, "comms-option-bytes", Comms, STAYS, None, "program the option bytes, then switch off and on";
        "the option bytes of comms are not those of this board";
        "at every start: brown-out level 3, and a watchdog that software starts";
    DriveCrystal = 49, "drive-crystal", Drive, STAYS, None, "fit the board's crystal, or name it in the board description";
        "the drive has another crystal than its program is made for, or none that works";
        "at every start: the crystal, counted by the internal oscillator, is not within 5 % of the board description's";
    CommsCrystal = 50, "comms-crystal", Comms, STAYS, None, "fit the board's crystal, or name it in the board description";
        "comms has another crystal than its program is made for, or none that works";
        "at every start: the crystal, counted by the internal oscillator, is not within 5 % of the board description's";
}

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
