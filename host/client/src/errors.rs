//! Errors of a client.

use crate::handshake::Mismatch;
use crate::refusals::{Refused, name_of};
use crate::request_kind::RequestKind;
use crate::transport::TransportError;
use crepitus_protocol::Revision;
use std::time::Duration;

/// Error of a client. Its text gives cause, place and remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Error of the transport.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// The connection was lost before;
    /// [`Client::reconnect`](crate::Client::reconnect) reopens it.
    #[error("the connection to {port} was lost and is not open")]
    NotConnected {
        /// The port.
        port: String,
    },
    /// Timeout without a reply.
    #[error(
        "timeout: no reply from {port} to `{request}` after {tries} tries in {} ms; \
        check that it is a Crepitus device and that it has power",
        .waited.as_millis()
    )]
    NoAnswer {
        /// The request.
        request: RequestKind,
        /// Number of tries.
        tries: u32,
        /// Time waited.
        waited: Duration,
        /// The port.
        port: String,
    },
    /// The device rejected the request.
    #[error(transparent)]
    Refused(Box<Refused>),
    /// The schema hashes differ.
    #[error(transparent)]
    Mismatch(Box<Mismatch>),
    /// Another host has changed the same parameters.
    #[error(transparent)]
    Conflict(Box<Conflict>),
    /// The device does not reboot while armed.
    #[error("`{request}` is rejected while the device is armed: run `crepitus stop` first")]
    NotDone {
        /// The request.
        request: RequestKind,
    },
    /// There is no parameter with this id.
    #[error("there is no parameter with the id {id}")]
    UnknownParameter {
        /// The id.
        id: u8,
    },
    /// The reply does not fit the request: a bug in the firmware.
    #[error("invalid reply of the device to `{request}`: this is a bug in its firmware")]
    Unexpected {
        /// The request.
        request: RequestKind,
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

/// Another host has changed a parameter that was to be set.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "cannot set {} to {requested}: another host has just changed it from {before} to {now} \
    (revision {revision}); nothing was set; check its new value and set it again",
    name_of(*.id)
)]
pub struct Conflict {
    /// The parameter.
    pub id: u8,
    /// Value of the parameter as it was read first.
    pub before: f64,
    /// Value of the parameter now.
    pub now: f64,
    /// The requested value.
    pub requested: f64,
    /// The revision of the parameters now.
    pub revision: Revision,
}
