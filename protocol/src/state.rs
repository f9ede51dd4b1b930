//! States and reasons.

use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Whether there may be torque.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub enum State {
    /// The bridge floats.
    #[default]
    Disarmed,
    /// The way to [`Self::Armed`]: both enable lines are being proven.
    Arming,
    /// The model's torque is rendered.
    Armed,
    /// The bridge floats until the fault is cleared.
    Faulted,
}

impl State {
    /// All, in the order of their numbers.
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

/// Why the torque is not the one that the model asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LimitReason {
    /// It is.
    #[default]
    None,
    /// The joint's largest torque.
    Torque,
    /// Torque grows at most as fast as this: after arming, or of what
    /// compensates friction.
    Slew,
    /// The motor's largest current.
    Current,
    /// The supply has no more voltage.
    Voltage,
    /// The hand has turned back inside a slip: nothing is shown until it ends.
    TurnedBack,
    /// The shaft is out of sight: the last torque is held, then released.
    Holding,
    /// There is no torque: the device is not armed.
    NotArmed,
}

impl LimitReason {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Torque,
        Self::Slew,
        Self::Current,
        Self::Voltage,
        Self::TurnedBack,
        Self::Holding,
        Self::NotArmed,
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
        }
    }
}
