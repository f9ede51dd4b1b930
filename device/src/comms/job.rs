//! A request that takes comms several milliseconds.

use crepitus_protocol::Session;
use crepitus_protocol::host::Request;
use crepitus_protocol::link::Order;

/// Timeout of a job, ms.
pub const JOB_MS: u64 = 500;

/// State of a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JobState {
    /// The enable line of comms is being tested; then the drive is armed.
    ProveLine,
    /// The drive has to confirm a command.
    Command {
        /// Sequence number of the command.
        number: u16,
        /// The order.
        order: Order,
    },
    /// The drive has to confirm a commit.
    Commit {
        /// Revision of the commit.
        revision: crepitus_protocol::Revision,
    },
    /// Parameters are being saved.
    Save,
    /// The drive has to send a part of its post-mortem record.
    CrashPart(u8),
}

/// A request that is being carried out.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// The host's session.
    pub session: Session,
    /// Sequence number of the request.
    pub number: u32,
    /// Deadline, ms.
    pub end_ms: u64,
    /// Current state.
    pub state: JobState,
}

impl Job {
    /// Starts a job for this request.
    pub fn new(request: &Request, now_ms: u64, state: JobState) -> Self {
        Self {
            session: request.session,
            number: request.number,
            end_ms: now_ms.saturating_add(JOB_MS),
            state,
        }
    }

    /// The pending command for the drive.
    pub fn command(&self) -> Option<(u16, Order)> {
        match self.state {
            JobState::Command { number, order } => Some((number, order)),
            _ => None,
        }
    }

    /// The part of its post-mortem record that the drive has to send.
    pub fn crash_part(&self) -> Option<u8> {
        match self.state {
            JobState::CrashPart(part) => Some(part),
            _ => None,
        }
    }
}
