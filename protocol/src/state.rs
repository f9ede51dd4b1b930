//! Safety states and limit reasons.

use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

crepitus_model::named! {
    /// Safety state.
    #[derive(
        Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
    )]
    pub enum State {
        /// The bridge floats.
        #[default]
        Disarmed => "disarmed",
        /// Arming is in progress: both enable lines are being tested.
        Arming => "arming",
        /// The model's torque is applied.
        Armed => "armed",
        /// The bridge floats until the fault is cleared.
        Faulted => "faulted",
    }
}

impl State {
    /// Number of the state in [`telemetry`](crate::telemetry).
    pub fn number(self) -> u8 {
        match self {
            Self::Disarmed => 0,
            Self::Arming => 1,
            Self::Armed => 2,
            Self::Faulted => 3,
        }
    }
}

crepitus_model::named! {
    /// Reason why the torque differs from the model's.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum LimitReason {
        /// No reason: the torque is the model's.
        #[default]
        None => "none",
        /// Torque limit of the joint.
        Torque => "torque",
        /// Slew limit: after arming, or of the friction compensation.
        Slew => "slew",
        /// Current limit of the motor.
        Current => "current",
        /// Supply voltage.
        Voltage => "voltage",
        /// The hand has reversed during a slip: no torque until the slip ends.
        TurnedBack => "turned-back",
        /// No valid encoder samples: the last torque is held, then released.
        Holding => "holding",
        /// Not armed.
        NotArmed => "not-armed",
        /// End of the range of motion: the torque fades, or is off.
        Range => "range",
        /// Energy tank: less than a clonus or a reflex asks for.
        Tank => "tank",
    }
}

impl LimitReason {
    /// Number of the reason in [`telemetry`](crate::telemetry).
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
            Self::Tank => 9,
        }
    }
}
