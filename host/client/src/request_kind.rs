//! What can be asked of a device, and how long an answer may take.

use crepitus_protocol::host::Ask;
use crepitus_protocol::management::What;
use std::fmt;
use std::time::Duration;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(
    missing_docs,
    reason = "the protocol's messages of the same names say it"
)]
pub enum RequestKind {
    Hello,
    Stop,
    Reboot,
    Status,
    Counters,
    Parameters,
    Commit,
    Save,
    Zero,
    Arm,
    Disarm,
    ClearFault,
    Subscribe,
    Unsubscribe,
}

/// How long an answer may take, in the transport's time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patience {
    /// Without an answer for so long, it is asked again.
    pub(crate) again: Duration,
    /// Without an answer for so long, it is given up.
    pub(crate) limit: Duration,
}

impl RequestKind {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Hello,
        Self::Stop,
        Self::Reboot,
        Self::Status,
        Self::Counters,
        Self::Parameters,
        Self::Commit,
        Self::Save,
        Self::Zero,
        Self::Arm,
        Self::Disarm,
        Self::ClearFault,
        Self::Subscribe,
        Self::Unsubscribe,
    ];

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hello => "hello",
            Self::Stop => "stop",
            Self::Reboot => "reboot",
            Self::Status => "status",
            Self::Counters => "counters",
            Self::Parameters => "parameters",
            Self::Commit => "commit",
            Self::Save => "save",
            Self::Zero => "zero",
            Self::Arm => "arm",
            Self::Disarm => "disarm",
            Self::ClearFault => "clear-fault",
            Self::Subscribe => "subscribe",
            Self::Unsubscribe => "unsubscribe",
        }
    }

    /// Its place in [`Self::ALL`].
    pub(crate) fn index(self) -> usize {
        self as usize
    }

    pub(crate) fn of(ask: &Ask) -> Self {
        match ask {
            // A renewal has no reply and is never waited for.
            Ask::Renew | Ask::Status => Self::Status,
            Ask::Counters => Self::Counters,
            Ask::Parameters => Self::Parameters,
            Ask::Commit { .. } => Self::Commit,
            Ask::Save => Self::Save,
            Ask::Zero => Self::Zero,
            Ask::Arm => Self::Arm,
            Ask::Disarm => Self::Disarm,
            Ask::ClearFault => Self::ClearFault,
            Ask::Subscribe => Self::Subscribe,
            Ask::Unsubscribe => Self::Unsubscribe,
        }
    }

    pub(crate) fn of_question(what: What) -> Self {
        match what {
            What::Hello => Self::Hello,
            What::Stop => Self::Stop,
            What::Reboot => Self::Reboot,
        }
    }

    /// Whether the device works on it, for half a second at most, and only on
    /// one at a time.
    pub(crate) fn is_job(self) -> bool {
        matches!(
            self,
            Self::Commit | Self::Save | Self::Zero | Self::Arm | Self::ClearFault
        )
    }

    pub(crate) fn patience(self) -> Patience {
        if self.is_job() {
            // The device gives up after 500 ms and says so.
            Patience {
                again: Duration::from_millis(200),
                limit: Duration::from_millis(1_500),
            }
        } else if self == Self::Stop {
            Patience {
                again: Duration::from_millis(20),
                limit: Duration::from_secs(1),
            }
        } else {
            Patience {
                again: Duration::from_millis(100),
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
