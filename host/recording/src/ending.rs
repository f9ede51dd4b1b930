//! The end of a recording: its cause, and what is missing there.

use serde::{Deserialize, Serialize};

/// Cause of the end of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum EndCause {
    /// The recording's time had elapsed.
    Time,
    /// The user asked for it.
    Requested,
    /// A fault of the device.
    Fault,
    /// Another program disarmed the device that the recording program had armed.
    Disarmed,
    /// The connection to the device was lost.
    ConnectionLost,
    /// An error of the recording program.
    Error,
}

impl EndCause {
    /// Returns the cause in a few words.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Time => "its time had elapsed",
            Self::Requested => "it was ended by the user",
            Self::Fault => "a fault of the device ended it",
            Self::Disarmed => "the device was disarmed by another program",
            Self::ConnectionLost => "the connection to the device was lost",
            Self::Error => "the recording program failed",
        }
    }
}

/// End of a recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ending {
    /// Cause of the end.
    pub cause: EndCause,
    /// Faults of the device at the end, each with its name, its cause and its remedy.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
    /// Tick up to which the device had produced samples by then; none if that is unknown, as after a
    /// lost connection.
    #[serde(default)]
    pub produced_to_tick: Option<u64>,
}

impl Ending {
    /// Returns an end without a fault, at which nothing is missing.
    pub const fn of(cause: EndCause) -> Self {
        Self {
            cause,
            faults: Vec::new(),
            produced_to_tick: None,
        }
    }

    /// Returns the end as a warning; none if the recording went as intended.
    pub(crate) fn warning(&self) -> Option<String> {
        let cause = self.cause.text();
        let faults = self.faults.join("; ");
        match (self.cause, self.faults.is_empty()) {
            (EndCause::Time | EndCause::Requested, true) => None,
            (EndCause::Fault, false) => {
                Some(format!("The recording ended early, {cause}: {faults}"))
            }
            (EndCause::Time | EndCause::Requested, false) => Some(format!(
                "When the recording ended, the device had a fault: {faults}"
            )),
            (_, true) => Some(format!("The recording ended early: {cause}.")),
            (_, false) => Some(format!(
                "The recording ended early: {cause}, and the device had a fault: {faults}"
            )),
        }
    }
}
