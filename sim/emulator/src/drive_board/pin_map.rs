//! Pins of the board's parts, as the board description has them.

use crate::pins::Pin;
use crepitus_device::board::pins::drive;

/// Upper and lower switch of each half of the bridge.
pub(super) const HALF_A: [Pin; 2] = [Pin::of(&drive::UPPER_A), Pin::of(&drive::LOWER_A)];
pub(super) const HALF_B: [Pin; 2] = [Pin::of(&drive::UPPER_B), Pin::of(&drive::LOWER_B)];

/// The drive's enable line: what drives it, and where it is read back.
pub(super) const LINE: Pin = Pin::of(&drive::LINE);
pub(super) const LINE_BACK: Pin = Pin::of(&drive::LINE_BACK);

/// Low: overcurrent.
pub(super) const BREAK: Pin = Pin::of(&drive::BREAK);

/// The enable line of comms, at its gate.
pub(super) const COMMS_LINE: Pin = Pin::of(&drive::COMMS_LINE);

/// The amplifiers of the two current paths.
pub(super) const SENSOR: Pin = Pin::of(&drive::SENSOR);
pub(super) const MONITOR: Pin = Pin::of(&drive::MONITOR);

/// Supply, temperature of the motor, and the joint's own sensor.
pub(super) const SUPPLY: Pin = Pin::of(&drive::SUPPLY);
pub(super) const MOTOR: Pin = Pin::of(&drive::MOTOR);
pub(super) const JOINT: Pin = Pin::of(&drive::JOINT);

/// The driver of the coil: its inputs, its nFAULT, and the amplifier of its current.
pub(super) const COIL_IN1: Pin = Pin::of(&drive::COIL_IN1);
pub(super) const COIL_IN2: Pin = Pin::of(&drive::COIL_IN2);
pub(super) const COIL_FAULT: Pin = Pin::of(&drive::COIL_FAULT);
pub(super) const COIL: Pin = Pin::of(&drive::COIL);
