//! What comms is doing for a host, over several milliseconds.

use crepitus_protocol::Session;
use crepitus_protocol::host::Request;
use crepitus_protocol::link::Order;

/// A job that takes longer than this is given up, ms.
pub const JOB_MS: u64 = 500;

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// The line of comms is being proven; then the drive is armed.
    ProveLine,
    /// The drive was told to do this, by a command of this number.
    Command {
        /// Its number.
        number: u16,
        /// What.
        order: Order,
    },
    /// The drive is to confirm a commit.
    Commit {
        /// Its revision.
        revision: crepitus_protocol::Revision,
    },
    /// Parameters are being kept.
    Save,
}

/// Something that is being done for a host.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// The host.
    pub session: Session,
    /// The number of its request.
    pub number: u16,
    /// When it is given up, ms.
    pub end_ms: u64,
    /// What is being done.
    pub work: Work,
}

impl Job {
    /// For this request.
    pub fn new(request: &Request, now_ms: u64, work: Work) -> Self {
        Self {
            session: request.session,
            number: request.number,
            end_ms: now_ms.saturating_add(JOB_MS),
            work,
        }
    }

    /// The command that the drive is to be sent.
    pub fn command(&self) -> Option<(u16, Order)> {
        match self.work {
            Work::Command { number, order } => Some((number, order)),
            _ => None,
        }
    }
}
