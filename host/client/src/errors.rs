//! What may go wrong between a program and a device.

use crate::handshake::Mismatch;
use crate::refusals::{Refused, name_of};
use crate::request_kind::RequestKind;
use crate::transport::TransportError;
use crepitus_protocol::Revision;
use std::time::Duration;

/// What has gone wrong. Its text says what, where, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The line.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// The line was lost before; [`Client::reconnect`](crate::Client::reconnect)
    /// opens it again.
    #[error("the line to {port} was lost and is not open again")]
    NotConnected {
        /// The port.
        port: String,
    },
    /// The device says nothing.
    #[error(
        "no answer from {port} to `{what}`, asked {tries} times within {} ms: \
         is it a Crepitus device, and is it switched on?",
        .waited.as_millis()
    )]
    NoAnswer {
        /// What was asked.
        what: RequestKind,
        /// How often.
        tries: u32,
        /// How long it was waited for.
        waited: Duration,
        /// The port.
        port: String,
    },
    /// The device does not do it, and says why.
    #[error(transparent)]
    Refused(Box<Refused>),
    /// Both sides speak different languages.
    #[error(transparent)]
    Mismatch(Box<Mismatch>),
    /// Somebody else has changed the very parameters that were to be set.
    #[error(transparent)]
    Conflict(Box<Conflict>),
    /// The device will not start anew while there is torque.
    #[error("`{what}` is refused while there is torque: `crepitus stop` ends it")]
    NotDone {
        /// What was asked.
        what: RequestKind,
    },
    /// There is no parameter with this id.
    #[error("there is no parameter with the id {id}")]
    UnknownParameter {
        /// The id.
        id: u8,
    },
    /// The answer is one to another question: a defect of the device.
    #[error("the device gives an answer to `{what}` that is none: this is a defect of its program")]
    Unexpected {
        /// What was asked.
        what: RequestKind,
    },
}

impl From<Refused> for Error {
    fn from(refused: Refused) -> Self {
        Self::Refused(Box::new(refused))
    }
}

impl From<Mismatch> for Error {
    fn from(mismatch: Mismatch) -> Self {
        Self::Mismatch(Box::new(mismatch))
    }
}

/// A parameter that was to be set has been changed by somebody else meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "{} was to become {wanted}, and another host has just changed it from {before} to {now} \
     (revision {revision}): nothing was set; look whether that is what you want, and set it again",
    name_of(*.id)
)]
pub struct Conflict {
    /// The parameter.
    pub id: u8,
    /// Its value as it was read first.
    pub before: f64,
    /// Its value now.
    pub now: f64,
    /// What it was to become.
    pub wanted: f64,
    /// The revision of the parameters now.
    pub revision: Revision,
}
