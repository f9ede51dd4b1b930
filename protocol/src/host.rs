//! Messages between the host and comms.
//!
//! A host asks, comms answers: every [`Request`] but a renewal has one
//! [`Reply`] with the same session and number. A request that is repeated with
//! its number is answered again and not carried out again, so a host that
//! heard nothing may always repeat it.

use crate::counters::{COMMS_COUNT, DRIVE_COUNT};
use crate::link::DriveRefusal;
use crate::parameters::Values;
use crate::revision::{Revision, Session};
use crate::settings::ValueError;
use crate::state::State;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// What a host asks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Request {
    /// The host.
    pub session: Session,
    /// Grows by one with each request; wraps.
    pub number: u16,
    /// What is asked.
    pub ask: Ask,
}

/// What can be asked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum Ask {
    /// The lease goes on. Has no reply, and its number means nothing.
    Renew,
    /// How is it? → [`Answer::Status`]
    Status,
    /// What was counted? → [`Answer::Counters`]
    Counters,
    /// Which parameters? → [`Answer::Parameters`]
    Parameters,
    /// These parameters instead, all or none. → [`Answer::Committed`]
    Commit {
        /// The revision that they were made from: another one in force is a
        /// refusal.
        base: Revision,
        /// All values.
        values: Values,
    },
    /// Keep the parameters in force for the next start. → [`Answer::Done`]
    Save,
    /// The angle is zero here. → [`Answer::Done`]
    Zero,
    /// Take the lease and render. → [`Answer::Done`]
    Arm,
    /// No more torque; gives the lease back. → [`Answer::Done`]
    Disarm,
    /// Forget the faults. → [`Answer::Done`]
    ClearFault,
    /// Send every sample. → [`Answer::Subscribed`]
    Subscribe,
    /// Send no more samples. → [`Answer::Done`]
    Unsubscribe,
}

/// What comms answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Reply {
    /// The request's session.
    pub session: Session,
    /// The request's number.
    pub number: u16,
    /// The answer.
    pub answer: Result<Answer, Refusal>,
}

/// Answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub enum Answer {
    /// Done.
    Done,
    /// How it is.
    Status(Status),
    /// What was counted since the start.
    Counters(Counters),
    /// The parameters in force.
    Parameters {
        /// Their revision.
        revision: Revision,
        /// The values.
        values: Values,
    },
    /// The parameters are in force at the drive.
    Committed {
        /// Their revision.
        revision: Revision,
    },
    /// Blocks follow.
    Subscribed {
        /// The first tick of the subscription.
        first_tick: u64,
    },
}

/// How it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Status {
    /// The state of the whole.
    pub state: State,
    /// Code of the fault of the drive, 0 for none.
    pub drive_fault: u8,
    /// Code of the fault of comms, 0 for none.
    pub comms_fault: u8,
    /// Whether blocks come from the drive.
    pub drive_present: bool,
    /// Tick of the drive, as of its last block.
    pub tick: u64,
    /// Milliseconds since comms has started.
    pub uptime_ms: u64,
    /// The parameters that were committed last.
    pub revision: Revision,
    /// The parameters in force at the drive.
    pub in_force: Revision,
    /// The parameters that are kept for the next start; none if they are the
    /// defaults.
    pub saved: Option<Revision>,
    /// Who has the lease.
    pub lease: Option<Session>,
    /// Whether the angle's zero was said.
    pub zeroed: bool,
    /// Whether the push at arming has shown that encoder and motor turn the
    /// same way; a leg that is held fast shows nothing.
    pub polarity_proven: bool,
}

/// What was counted since the start, at the places of
/// [`DRIVE_COUNTERS`](crate::counters::DRIVE_COUNTERS) and
/// [`COMMS_COUNTERS`](crate::counters::COMMS_COUNTERS).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Counters {
    /// By the drive, as of its last status.
    pub drive: [u32; DRIVE_COUNT],
    /// By comms.
    pub comms: [u32; COMMS_COUNT],
}

/// Why comms does not do what it is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
#[non_exhaustive]
pub enum Refusal {
    /// The values are not allowed.
    Values(ValueError),
    /// The parameters have changed since: read them again.
    Stale {
        /// The revision that was committed last.
        revision: Revision,
    },
    /// Another host has the lease.
    Leased {
        /// The other host.
        by: Session,
    },
    /// Nothing comes from the drive.
    DriveSilent,
    /// The drive does not confirm in time; what was committed comes into force
    /// once it is heard again.
    Unconfirmed,
    /// A fault stands in the way: its code.
    Faulted {
        /// The code.
        code: u8,
    },
    /// It is armed: disarm first.
    Armed,
    /// Another request is still being carried out.
    Busy,
    /// The drive refuses.
    Drive(DriveRefusal),
    /// The parameters could not be kept.
    Storage,
    /// It was given up: a stop, a disarm or a fault came first.
    Aborted,
}
