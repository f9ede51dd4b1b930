//! Safety states and limit reasons.

use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Safety state.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub enum State {
    /// The bridge floats.
    #[default]
    Disarmed,
    /// Arming is in progress: both enable lines are being tested.
    Arming,
    /// The model's torque is applied.
    Armed,
    /// The bridge floats until the fault is cleared.
    Faulted,
}

impl State {
    /// All values, in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::Disarmed, Self::Arming, Self::Armed, Self::Faulted];

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Disarmed => "disarmed",
            Self::Arming => "arming",
            Self::Armed => "armed",
            Self::Faulted => "faulted",
        }
    }

    /// Its number in [`telemetry`](crate::telemetry).
    pub fn number(self) -> u8 {
        match self {
            Self::Disarmed => 0,
            Self::Arming => 1,
            Self::Armed => 2,
            Self::Faulted => 3,
        }
    }
}

/// Reason why the torque differs from the model's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LimitReason {
    /// It does not.
    #[default]
    None,
    /// Torque limit of the joint.
    Torque,
    /// Slew limit: after arming, or of the friction compensation.
    Slew,
    /// Current limit of the motor.
    Current,
    /// Supply voltage.
    Voltage,
    /// The hand has reversed during a slip: no torque until the slip ends.
    TurnedBack,
    /// No valid encoder samples: the last torque is held, then released.
    Holding,
    /// Not armed.
    NotArmed,
    /// End of the range of motion: the torque fades, or is off.
    Range,
}

impl LimitReason {
    /// All values, in the order of their numbers.
    pub const ALL: [Self; 9] = [
        Self::None,
        Self::Torque,
        Self::Slew,
        Self::Current,
        Self::Voltage,
        Self::TurnedBack,
        Self::Holding,
        Self::NotArmed,
        Self::Range,
    ];

    /// Name in recordings and for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Torque => "torque",
            Self::Slew => "slew",
            Self::Current => "current",
            Self::Voltage => "voltage",
            Self::TurnedBack => "turned-back",
            Self::Holding => "holding",
            Self::NotArmed => "not-armed",
            Self::Range => "range",
        }
    }

    /// Its number in [`telemetry`](crate::telemetry).
    pub fn number(self) -> u16 {
        match self {
            Self::None => 0,
            Self::Torque => 1,
            Self::Slew => 2,
            Self::Current => 3,
            Self::Voltage => 4,
            Self::TurnedBack => 5,
            Self::Holding => 6,
            Self::NotArmed => 7,
            Self::Range => 8,
        }
    }
}
