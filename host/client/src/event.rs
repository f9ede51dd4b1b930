//! What has happened, as [`Client::pump`](crate::Client::pump) hands it out.

use crate::transport::TransportError;
use crepitus_protocol::host::Status;
use crepitus_protocol::telemetry::Block;
use std::time::Duration;

/// What has happened.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// Twenty samples of the subscription.
    Block(Arrival),
    /// The drive has started anew: ticks begin anew with the next block.
    DriveRestarted,
    /// State, fault, presence of the drive or holder of the lease are others.
    State(Box<StateChange>),
    /// No block of the subscription has come for this long, though the line is
    /// open. Said once for each silence.
    Silent(Duration),
    /// The line is gone; said once. There is nothing more until
    /// [`Client::reconnect`](crate::Client::reconnect).
    Lost(TransportError),
}

/// A block, and what is missing before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrival {
    /// The block.
    pub block: Box<Block>,
    /// Samples that are missing between it and the one before.
    pub missing: u64,
}

/// How it was and how it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateChange {
    /// As it was known before.
    pub before: Status,
    /// As it is.
    pub now: Status,
}

impl StateChange {
    /// The change, if it is one that somebody may want to know of: time and
    /// revisions go on all the time.
    pub(crate) fn between(before: &Status, now: &Status) -> Option<Self> {
        let key = |s: &Status| {
            (
                s.state,
                s.drive_fault,
                s.comms_fault,
                s.drive_present,
                s.lease,
            )
        };
        (key(before) != key(now)).then_some(Self {
            before: *before,
            now: *now,
        })
    }
}
