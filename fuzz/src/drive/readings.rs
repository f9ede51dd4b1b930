//! Readings of the drive's sensors and lines in some ticks.

use crate::bytes::Bytes;
use crepitus_device::drive::slow_checks::SlowInput;
use crepitus_protocol::TICK_US;

/// The readings of some ticks.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a line or a fact by itself"
)]
pub(super) struct Readings {
    pub(super) turn: i8,
    pub(super) has_current: bool,
    /// Replaces the current of the winding.
    pub(super) current_a: Option<f32>,
    pub(super) line: Option<bool>,
    pub(super) comms_line_is_off: bool,
    pub(super) has_tripped: bool,
    pub(super) is_late: bool,
    pub(super) is_idle: bool,
    pub(super) is_slow_good: bool,
    pub(super) sensor_fault: Option<SensorFault>,
}

/// A sensor or line that is not in order, while the others are.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum SensorFault {
    SupplyV(f32),
    MotorC(f32),
    JointTurns(f32),
    NoSlowReading,
    /// Offset of the second sensor of the current, A.
    MonitorOffsetA(f32),
    IntervalUs(u32),
    CommsLineIsOn,
    CoilA(f32),
    CoilHasTripped,
}

/// Those that an input chooses from.
const SENSOR_FAULTS: [SensorFault; 16] = [
    SensorFault::SupplyV(10.0),
    SensorFault::SupplyV(40.0),
    SensorFault::SupplyV(f32::NAN),
    SensorFault::MotorC(90.0),
    SensorFault::MotorC(f32::NAN),
    SensorFault::JointTurns(0.5),
    SensorFault::JointTurns(f32::NAN),
    SensorFault::NoSlowReading,
    SensorFault::MonitorOffsetA(1.0),
    SensorFault::MonitorOffsetA(-0.3),
    SensorFault::IntervalUs(TICK_US - 10),
    SensorFault::IntervalUs(TICK_US + 10),
    SensorFault::CommsLineIsOn,
    SensorFault::CoilA(0.0),
    SensorFault::CoilA(2.0),
    SensorFault::CoilHasTripped,
];

impl Readings {
    /// Returns the readings of a device that is in order.
    pub(super) fn good() -> Self {
        Self {
            turn: 0,
            has_current: true,
            current_a: None,
            line: None,
            comms_line_is_off: false,
            has_tripped: false,
            is_late: false,
            is_idle: true,
            is_slow_good: true,
            sensor_fault: None,
        }
    }

    pub(super) fn any(bytes: &mut Bytes<'_>) -> Self {
        let how = bytes.byte();
        Self {
            turn: bytes.byte().cast_signed(),
            has_current: how & 1 == 0,
            current_a: (how & 2 != 0).then(|| bytes.f32()),
            line: (how & 4 != 0).then_some(how & 8 != 0),
            comms_line_is_off: how & 0x0c == 0x08,
            has_tripped: how & 0x30 == 0x30,
            is_late: how & 0x40 != 0,
            is_idle: how & 0x80 == 0,
            is_slow_good: how & 0x83 != 0x83,
            sensor_fault: (how & 0x30 == 0x10).then(|| bytes.choice(&SENSOR_FAULTS)),
        }
    }

    /// The slow reading of this tick.
    pub(super) fn slow(&self, tick: u64, current_a: f32) -> SlowInput {
        if !self.is_slow_good {
            return SlowInput::in_turn(tick, current_a, current_a, current_a);
        }
        let (mut supply_v, mut motor_c, mut joint_turns) = (24.0, 25.0, 0.0);
        match self.sensor_fault {
            Some(SensorFault::SupplyV(value)) => supply_v = value,
            Some(SensorFault::MotorC(value)) => motor_c = value,
            Some(SensorFault::JointTurns(value)) => joint_turns = value,
            Some(SensorFault::NoSlowReading) => return SlowInput::None,
            _ => {}
        }
        SlowInput::in_turn(tick, supply_v, motor_c, joint_turns)
    }
}
