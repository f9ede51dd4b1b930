//! Kinds of requests, and their timeouts.

use crepitus_protocol::host::Operation;
use crepitus_protocol::management::Action;
use std::fmt;
use std::time::Duration;

crepitus_protocol::named! {
    /// Kind of a request.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[expect(
        missing_docs,
        reason = "the protocol's messages of the same names say it"
    )]
    pub enum RequestKind {
        Hello => "hello",
        Stop => "stop",
        Reboot => "reboot",
        Open => "open",
        Status => "status",
        Counters => "counters",
        Parameters => "parameters",
        Commit => "commit",
        Save => "save",
        Zero => "zero",
        Arm => "arm",
        Disarm => "disarm",
        ClearFault => "clear-fault",
        Subscribe => "subscribe",
        Unsubscribe => "unsubscribe",
        ReadCrash => "read-crash",
        PlayChirp => "play-chirp",
        Times => "times",
    }
}

/// Timeouts of a request, in the transport's time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timing {
    /// Retry interval.
    pub(crate) retry: Duration,
    /// Timeout.
    pub(crate) limit: Duration,
}

impl RequestKind {
    /// Index in [`Self::ALL`].
    pub(crate) fn index(self) -> usize {
        self as usize
    }

    pub(crate) fn of(operation: &Operation) -> Self {
        match operation {
            // A renewal has no reply.
            Operation::Renew | Operation::Status => Self::Status,
            Operation::Open => Self::Open,
            Operation::Counters => Self::Counters,
            Operation::Parameters => Self::Parameters,
            Operation::Commit { .. } => Self::Commit,
            Operation::Save => Self::Save,
            Operation::Zero => Self::Zero,
            Operation::Arm => Self::Arm,
            Operation::Disarm => Self::Disarm,
            Operation::ClearFault => Self::ClearFault,
            Operation::Subscribe => Self::Subscribe,
            Operation::Unsubscribe => Self::Unsubscribe,
            Operation::ReadCrash { .. } => Self::ReadCrash,
            Operation::PlayChirp(_) => Self::PlayChirp,
            Operation::Times => Self::Times,
        }
    }

    pub(crate) fn of_management(action: Action) -> Self {
        match action {
            Action::Hello => Self::Hello,
            Action::Stop => Self::Stop,
            Action::Reboot => Self::Reboot,
        }
    }

    /// Returns whether the device executes it as a job: one at a time, for half a second
    /// at most.
    pub(crate) fn is_job(self) -> bool {
        match self {
            Self::Commit
            | Self::Save
            | Self::Zero
            | Self::Arm
            | Self::ClearFault
            | Self::ReadCrash
            | Self::PlayChirp => true,
            Self::Hello
            | Self::Stop
            | Self::Reboot
            | Self::Open
            | Self::Status
            | Self::Counters
            | Self::Parameters
            | Self::Disarm
            | Self::Subscribe
            | Self::Unsubscribe
            | Self::Times => false,
        }
    }

    pub(crate) fn timing(self) -> Timing {
        if self.is_job() {
            // The device replies with a timeout after 500 ms.
            Timing {
                retry: Duration::from_millis(200),
                limit: Duration::from_millis(1_500),
            }
        } else if self == Self::Stop {
            Timing {
                retry: Duration::from_millis(20),
                limit: Duration::from_secs(1),
            }
        } else {
            Timing {
                retry: Duration::from_millis(100),
                limit: Duration::from_secs(1),
            }
        }
    }
}

impl fmt::Display for RequestKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_at_its_place() {
        for (place, kind) in RequestKind::ALL.into_iter().enumerate() {
            assert_eq!(kind.index(), place);
        }
    }
}
