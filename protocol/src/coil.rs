//! Faults of the coil of the vibration actuator: cause, detection, reaction time,
//! remedy.
//!
//! They switch the actuator off and leave the motor on, because a device without
//! vibration is as safe as one with it. So they are not in the table of
//! [`fault`](crate::fault), whose faults float the bridge. They latch, and the command
//! `clear-fault` clears them, too; arming does not.

/// A fault of the coil; its number is its code on the wire and never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
#[expect(missing_docs, reason = "the table says it")]
pub enum CoilFault {
    Driver = 1,
    CurrentMissing = 2,
    Short = 3,
    Open = 4,
    CurrentMismatch = 5,
    Hot = 6,
}

/// Description of a fault of the coil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoilFaultSpec {
    /// The fault.
    pub fault: CoilFault,
    /// Name.
    pub name: &'static str,
    /// Cause.
    pub cause: &'static str,
    /// Detection criterion.
    pub detection: &'static str,
    /// Ticks of the drive (50 µs) from the cause until the coil is not driven.
    pub within_ticks: u32,
    /// Remedy.
    pub clear: &'static str,
}

const REPAIR: &str = "repair, then clear-fault";

/// All faults of the coil, in the order of their codes.
pub const COIL_FAULTS: [CoilFaultSpec; 6] = [
    CoilFaultSpec {
        fault: CoilFault::Driver,
        name: "coil-driver",
        cause: "the driver of the coil reports a short circuit or too much heat, or the wire of its nFAULT is broken",
        detection: "the break input of the coil's timer, which turns its outputs off without the program, while driven",
        within_ticks: 2,
        clear: REPAIR,
    },
    CoilFaultSpec {
        fault: CoilFault::CurrentMissing,
        name: "coil-current-missing",
        cause: "the converter of the coil's current does not run",
        detection: "3 consecutive ticks without a measured current while driven",
        within_ticks: 5,
        clear: REPAIR,
    },
    CoilFaultSpec {
        fault: CoilFault::Short,
        name: "coil-short",
        cause: "turns of the coil, or its wires, are shorted, or its current sensor is stuck high",
        detection: "for 5 consecutive ticks the current is above 0.15 A and 1.3 times what voltage and back-EMF of the \
                    last milliseconds drive through vibration-actuator.resistance_ohm, or above 3.1 A",
        within_ticks: 8,
        clear: REPAIR,
    },
    CoilFaultSpec {
        fault: CoilFault::Open,
        name: "coil-open",
        cause: "coil, wire or supply of the coil is interrupted, or its current sensor is stuck at zero",
        detection: "over 10 ms there is next to no current, for 60 consecutive ticks in which the voltage would drive \
                    0.08 A and is above half of the largest back-EMF; a quieter command shows nothing",
        within_ticks: 900,
        clear: REPAIR,
    },
    CoilFaultSpec {
        fault: CoilFault::CurrentMismatch,
        name: "coil-current-mismatch",
        cause: "the current sensor of the coil is stuck, or wired the wrong way round",
        detection: "as coil-open, with a current, of which less than an eighth follows the voltage",
        within_ticks: 900,
        clear: REPAIR,
    },
    CoilFaultSpec {
        fault: CoilFault::Hot,
        name: "coil-hot",
        cause: "vibration-actuator.resistance_ohm is larger than that of the coil, or its model is wrong otherwise: \
                the command limits its heat by itself",
        detection: "the mean square of the measured current, over 10 s, is above 1.25 times that of \
                    vibration-actuator.continuous_current_a: after 3.7 s of twice that current",
        within_ticks: 80_000,
        clear: "let it cool, correct the parameters, then clear-fault",
    },
];

impl CoilFault {
    /// Code on the wire.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Description of a fault by its code.
    pub fn find(code: u8) -> Option<&'static CoilFaultSpec> {
        COIL_FAULTS.iter().find(|spec| spec.fault.code() == code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::FAULTS;

    #[test]
    fn every_code_and_every_name_stands_once_in_order() {
        for pair in COIL_FAULTS.windows(2) {
            assert!(pair[0].fault.code() < pair[1].fault.code());
        }
        for (i, spec) in COIL_FAULTS.iter().enumerate() {
            assert_eq!(CoilFault::find(spec.fault.code()), Some(spec));
            assert!(COIL_FAULTS[..i].iter().all(|other| other.name != spec.name));
            assert!(FAULTS.iter().all(|other| other.name != spec.name));
        }
        assert_eq!(CoilFault::find(0), None);
    }
}
