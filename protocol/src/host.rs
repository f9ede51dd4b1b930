//! Messages between the host and comms.
//!
//! A host opens a session with [`Operation::Open`], and gets the [`Nonce`] that
//! all its further requests repeat.
//!
//! Every [`Request`] of a host but a renewal has one [`Reply`] of comms, with
//! the same session and sequence number. A repeated number gets the stored reply
//! and is not executed again, so a host may always retry after a timeout.

use crate::chirp::PlayedChirp;
use crate::counters::{COMMS_COUNT, DRIVE_COUNT};
use crate::crash::{Controller, Part};
use crate::link::DriveRefusal;
use crate::measured::Measured;
use crate::parameters::Values;
use crate::revision::{Nonce, Revision, Session};
use crate::settings::ValueError;
use crate::state::State;
use crate::task_times::DeviceTimes;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Request of a host.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Request {
    /// The host's session.
    pub session: Session,
    /// The nonce of the open session; ignored by [`Operation::Open`].
    pub nonce: Nonce,
    /// Sequence number; greater in each request. It does not wrap: there are more than
    /// a session can send.
    pub number: u32,
    /// The requested operation.
    pub operation: Operation,
}

/// Operations of comms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum Operation {
    /// Renews the lease, if its number is greater than that of any renewal before. Has no
    /// reply.
    Renew,
    /// Reads the status. → [`Answer::Status`]
    Status,
    /// Reads the counters. → [`Answer::Counters`]
    Counters,
    /// Reads the parameters. → [`Answer::Parameters`]
    Parameters,
    /// Replaces all parameters, atomically. → [`Answer::Committed`]
    Commit {
        /// Revision that the values are based on; rejected if another one was
        /// committed since.
        base: Revision,
        /// All values.
        values: Values,
    },
    /// Saves the parameters to flash, for the next boot. → [`Answer::Done`]
    Save,
    /// Sets the angle's zero here. → [`Answer::Done`]
    Zero,
    /// Acquires the lease and turns torque on. → [`Answer::Done`]
    Arm,
    /// Turns torque off and releases the lease; rejected while another session
    /// holds it, unlike stop of the management lane. → [`Answer::Done`]
    Disarm,
    /// Clears the faults. → [`Answer::Done`]
    ClearFault,
    /// Starts this session's telemetry. → [`Answer::Subscribed`]
    Subscribe,
    /// Stops this session's telemetry. → [`Answer::Done`]
    Unsubscribe,
    /// Opens the session, or gives it another nonce. → [`Answer::Opened`]
    Open,
    /// Reads a part of a controller's post-mortem record, of the drive while it is not
    /// armed. → [`Answer::CrashPart`]
    ReadCrash {
        /// Controller whose record is read.
        controller: Controller,
        /// Index of the part, from 0 on.
        part: u8,
    },
    /// Plays a chirp on the coil of the vibration actuator instead of its command, while
    /// this session has armed the device: to identify it. It ends by itself, and
    /// with the torque. → [`Answer::Done`] when it begins
    PlayChirp(PlayedChirp),
    /// Reads the times of the hardware tasks. → [`Answer::Times`]
    Times,
}

/// Reply of comms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Reply {
    /// The request's session.
    pub session: Session,
    /// The request's sequence number.
    pub number: u32,
    /// The result.
    pub answer: Result<Answer, Refusal>,
}

/// Results of successful requests.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum Answer {
    /// Done.
    Done,
    /// The status.
    Status(Status),
    /// The counters since boot.
    Counters(Counters),
    /// The parameters committed last.
    Parameters {
        /// Their revision.
        revision: Revision,
        /// The values.
        values: Values,
    },
    /// The drive has applied the parameters.
    Committed {
        /// Their revision.
        revision: Revision,
    },
    /// Telemetry is on.
    Subscribed {
        /// The first tick of the subscription.
        first_tick: u64,
        /// The blocks' `dropped` before it.
        dropped: u32,
        /// The start of the drive that counts them, as in the blocks' flags.
        start: u8,
    },
    /// The session is open.
    Opened {
        /// Nonce to repeat in each request.
        nonce: Nonce,
    },
    /// A part of a post-mortem record.
    CrashPart(Part),
    /// The times of the hardware tasks.
    Times(DeviceTimes),
}

/// Status of the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Status {
    /// State of the device.
    pub state: State,
    /// Code of the drive's fault, 0 for none.
    pub drive_fault: u8,
    /// Code of the fault of comms, 0 for none.
    pub comms_fault: u8,
    /// Whether telemetry of the drive arrives at comms.
    pub drive_present: bool,
    /// Tick of the drive, as of its last block.
    pub tick: u64,
    /// Milliseconds since comms booted.
    pub uptime_ms: u64,
    /// Revision committed last.
    pub revision: Revision,
    /// Revision active at the drive.
    pub in_force: Revision,
    /// Revision saved for the next boot; none: the defaults.
    pub saved: Option<Revision>,
    /// Session that holds the lease.
    pub lease: Option<Session>,
    /// Whether the angle's zero was set.
    pub zeroed: bool,
    /// Whether the push at arming has proven that encoder and motor turn the
    /// same way; with a leg that is held it proves nothing.
    pub polarity_proven: bool,
    /// Measurements of the drive beside the motion.
    pub measured: Measured,
    /// Code of the fault of the vibration actuator's coil, 0 for none: the motor goes on.
    pub coil_fault: u8,
}

/// Counters since boot, in the order of
/// [`DRIVE_COUNTERS`](crate::counters::DRIVE_COUNTERS) and
/// [`COMMS_COUNTERS`](crate::counters::COMMS_COUNTERS).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Counters {
    /// Counters of the drive, as of its last status.
    pub drive: [u32; DRIVE_COUNT],
    /// Counters of comms.
    pub comms: [u32; COMMS_COUNT],
}

/// Errors of requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub enum Refusal {
    /// Invalid values.
    Values(ValueError),
    /// `base` is stale: the parameters have changed; read them again.
    Stale {
        /// The revision committed last.
        revision: Revision,
    },
    /// Another host holds the lease.
    Leased {
        /// The other host's session.
        by: Session,
    },
    /// The drive is silent.
    DriveSilent,
    /// Timeout of the drive's confirmation; a commit is applied once the drive
    /// responds again.
    Unconfirmed,
    /// A fault is latched.
    Faulted {
        /// The fault's code.
        code: u8,
    },
    /// Not while armed: disarm first.
    Armed,
    /// Another request is pending.
    Busy,
    /// Rejected by the drive.
    Drive(DriveRefusal),
    /// Saving the parameters failed.
    Storage,
    /// Aborted by a stop, a disarm or a fault.
    Aborted,
    /// The session is not open, or the nonce is an old one: open it. Nothing was
    /// executed, and telemetry of the session has ended.
    NotOpen,
}
