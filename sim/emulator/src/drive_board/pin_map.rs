//! Pins of the board's parts.

use crate::pins::Pin;

/// Upper and lower switch of each half of the bridge.
pub(super) const HALF_A: [Pin; 2] = [Pin::new('A', 8), Pin::new('B', 13)];
pub(super) const HALF_B: [Pin; 2] = [Pin::new('A', 9), Pin::new('B', 14)];

/// The drive's enable line: what drives it, and where it is read back.
pub(super) const LINE: Pin = Pin::new('B', 0);
pub(super) const LINE_BACK: Pin = Pin::new('B', 1);

/// Low: overcurrent.
pub(super) const BREAK: Pin = Pin::new('B', 12);

/// The enable line of comms, at its gate.
pub(super) const COMMS_LINE: Pin = Pin::new('B', 10);

/// The amplifiers of the two current paths.
pub(super) const SENSOR: Pin = Pin::new('C', 0);
pub(super) const MONITOR: Pin = Pin::new('C', 1);

/// Supply, temperature of the motor, and the joint's own sensor.
pub(super) const SUPPLY: Pin = Pin::new('C', 3);
pub(super) const MOTOR: Pin = Pin::new('A', 2);
pub(super) const JOINT: Pin = Pin::new('C', 2);

/// The driver of the coil: its inputs, its nFAULT, and the amplifier of its current.
pub(super) const COIL_IN1: Pin = Pin::new('C', 8);
pub(super) const COIL_IN2: Pin = Pin::new('C', 9);
pub(super) const COIL_FAULT: Pin = Pin::new('A', 6);
pub(super) const COIL: Pin = Pin::new('A', 3);
