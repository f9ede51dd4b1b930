//! Events that [`Client::pump`](crate::Client::pump) returns.

use crate::transport::TransportError;
use crepitus_protocol::host::Status;
use crepitus_protocol::task_times::DeviceTimes;
use crepitus_protocol::telemetry::Block;
use std::time::Duration;

/// Event of a device or its connection.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// Twenty samples of the subscription.
    Block(Arrival),
    /// The drive has restarted: ticks restart with the next block.
    DriveRestarted,
    /// State, fault, presence of the drive or holder of the lease have changed.
    State(Box<StateChange>),
    /// Times of the hardware tasks: once a second while subscribed, of a device that measures them.
    Times(Box<DeviceTimes>),
    /// No block has arrived for this long, though the connection is open.
    /// Reported once for each silence.
    Silent(Duration),
    /// The connection is lost; reported once. No more events until
    /// [`Client::reconnect`](crate::Client::reconnect).
    Lost(TransportError),
}

/// A block, and the samples missing before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrival {
    /// The block.
    pub block: Box<Block>,
    /// Samples missing between it and the previous one.
    pub missing: u64,
}

/// Change of the status.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateChange {
    /// Previous status.
    pub before: Status,
    /// Current status.
    pub now: Status,
}

impl StateChange {
    /// The change, if it is relevant: changes of time and revisions are not.
    pub(crate) fn between(before: &Status, now: &Status) -> Option<Self> {
        let key = |s: &Status| {
            (
                s.state,
                (s.drive_fault, s.comms_fault, s.coil_fault),
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
