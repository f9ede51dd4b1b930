//! Messages between the two controllers.
//!
//! **Freshness.** Every heartbeat and every command echoes the drive's own
//! tick, as comms last received it. A message that was delayed, repeated or
//! replayed is older than [`STALE_TICKS`] by the drive's clock and is ignored.
//! The lease expires at a tick of the drive, too, so a late heartbeat cannot
//! extend it.
//!
//! **Commands** have sequence numbers. The drive executes a number that is newer
//! than the last one, once, and reports the outcome in every [`DriveStatus`];
//! comms retries a command until the outcome is confirmed.

use crate::chirp::PlayedChirp;
use crate::counters::DRIVE_COUNT;
use crate::crash;
use crate::measured::Measured;
use crate::pieces::Piece;
use crate::revision::Revision;
use crate::settings::ValueError;
use crate::state::State;
use crate::task_times::TaskTimes;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Age beyond which an echoed tick is stale, ticks. A block is 20 ticks, its
/// transmission 17, a heartbeat every 20.
pub const STALE_TICKS: u64 = 400;

/// Message of comms to the drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub enum ToDrive {
    /// Heartbeat, sent every millisecond.
    Heartbeat(Heartbeat),
    /// One piece of a commit, to be applied at the start of a block.
    Commit {
        /// Revision of the commit.
        revision: Revision,
        /// Seal over all values of the commit, of this start of comms.
        seal: u32,
        /// Number of pieces sent; a value that is in none of them is at its default.
        pieces: u8,
        /// Some of the values.
        piece: Piece,
    },
    /// Order, to be executed once.
    Command {
        /// The drive's tick as comms last received it.
        seen_tick: u64,
        /// Sequence number; incremented for each command, wraps.
        number: u16,
        /// The order.
        order: Order,
    },
    /// Asks a drive that is not armed for a part of its post-mortem record, which
    /// [`FromDrive::CrashPart`] answers.
    ReadCrash {
        /// Index of the part.
        part: u8,
    },
}

/// Heartbeat of comms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Heartbeat {
    /// The drive's tick as comms last received it.
    pub seen_tick: u64,
    /// Ticks from `seen_tick` to the end of the lease.
    pub lease_left: u16,
    /// Whether torque is permitted; if not, the drive disarms.
    pub enable: bool,
    /// Boot counter of comms.
    pub start: u16,
    /// One more than that of the heartbeat before; wraps. One that is not among the 127 after
    /// the last fresh one is ignored until the timeout, so that the same bytes again are no
    /// sign of life.
    pub number: u8,
}

/// Orders to the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub enum Order {
    /// Tests the enable line, then turns torque on.
    Arm,
    /// Sets the angle's zero here.
    Zero,
    /// Clears the fault.
    ClearFault,
    /// Plays a chirp on the coil of the vibration actuator.
    PlayChirp(PlayedChirp),
}

/// Message of the drive to comms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub enum FromDrive {
    /// Status, sent every 5 ms and at every change.
    Status(DriveStatus),
    /// A part of the post-mortem record.
    CrashPart(crash::Part),
    /// Times of the tasks, sent once a second by a drive that measures them.
    Times(TaskTimes),
}

impl FromDrive {
    /// First byte of the message [`Self::Times`], for an incremental encoder; the words follow.
    pub const TIMES: u8 = 2;
}

/// Bytes of a counter, at most.
pub const COUNTER_BYTES: usize = u32::POSTCARD_MAX_SIZE;

impl DriveStatus {
    /// Bytes of [`Self::head`], at most.
    pub const HEAD_BYTES: usize = FromDrive::POSTCARD_MAX_SIZE - DRIVE_COUNT * COUNTER_BYTES;

    /// The message [`FromDrive::Status`] up to the counters, in three parts, for an
    /// incremental encoder, which appends them one by one.
    pub fn head(
        &self,
    ) -> (
        impl Serialize + use<>,
        impl Serialize + use<>,
        impl Serialize + use<>,
    ) {
        const STATUS: u8 = 0;
        let begin = (STATUS, self.tick, self.start, self.comms_start);
        let middle = (
            (self.state, self.fault, self.coil_fault),
            (self.revision, self.refused, self.last),
        );
        let end = (
            (self.zeroed, self.polarity_proven),
            (self.awaits_comms, self.measured),
        );
        (begin, middle, end)
    }
}

/// Status of the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct DriveStatus {
    /// Current tick.
    pub tick: u64,
    /// Boot counter of the drive.
    pub start: u16,
    /// Boot counter of comms in its last heartbeat; `refused` and `last` refer
    /// to commits and commands since that boot.
    pub comms_start: Option<u16>,
    /// State of the drive.
    pub state: State,
    /// Code of the fault, 0 for none.
    pub fault: u8,
    /// Code of the fault of the vibration actuator's coil, 0 for none.
    pub coil_fault: u8,
    /// Active revision of the parameters, if it is of this boot of comms.
    pub revision: Revision,
    /// The last rejected commit, and the reason.
    pub refused: Option<(Revision, ValueError)>,
    /// The last completed command.
    pub last: Option<Outcome>,
    /// Whether the angle's zero was set.
    pub zeroed: bool,
    /// Whether arming has proven that encoder and motor turn the same way.
    pub polarity_proven: bool,
    /// Arming has come to where it needs the enable line of comms.
    pub awaits_comms: bool,
    /// Measurements of the drive beside the motion.
    pub measured: Measured,
    /// The drive's counters.
    pub counters: [u32; DRIVE_COUNT],
}

/// Outcome of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub struct Outcome {
    /// Sequence number of the command.
    pub number: u16,
    /// Success, or the error.
    pub result: Result<(), DriveRefusal>,
}

/// Errors of orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub enum DriveRefusal {
    /// No parameters were received yet.
    NoParameters,
    /// No lease, or an expired one.
    NoLease,
    /// A fault is latched.
    Faulted {
        /// The fault's code.
        code: u8,
    },
    /// Not while armed.
    Armed,
    /// The encoder's counts are implausible.
    NoEncoder,
    /// Arming was aborted by comms or the host.
    Aborted,
    /// The angle's zero was not set since the drive's start.
    NotZeroed,
    /// The leg is outside the range of motion.
    OutsideRange,
    /// Only while armed, by the session that has armed.
    NotArmed,
    /// There is no vibration actuator, or its coil has a fault.
    NoActuator,
    /// The chirp is outside its ranges, above the supply, or would drive the mass
    /// beyond twice its stroke by the parameters in use.
    ChirpOutOfRange,
    /// Another chirp is being played.
    ChirpPlaying,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::write;

    #[test]
    fn a_status_is_its_head_and_its_counters() {
        let status = DriveStatus {
            tick: u64::MAX,
            start: u16::MAX,
            comms_start: Some(u16::MAX),
            state: State::Faulted,
            fault: 255,
            coil_fault: 255,
            revision: Revision(u32::MAX),
            refused: Some((Revision(u32::MAX), ValueError::KineticAboveStatic)),
            last: Some(Outcome {
                number: u16::MAX,
                result: Err(DriveRefusal::Faulted { code: 255 }),
            }),
            zeroed: true,
            polarity_proven: true,
            awaits_comms: true,
            measured: Measured {
                supply_cv: u16::MAX,
                motor_c: i16::MIN,
                joint_cdeg: Some(u16::MAX),
            },
            counters: core::array::from_fn(|n| u32::MAX >> n),
        };
        for status in [status, DriveStatus::default()] {
            let (mut whole, mut part) = ([0; 256], [0; 256]);
            let whole = write(&FromDrive::Status(status), &mut whole).unwrap();
            let (begin, middle, end) = status.head();
            let part = &mut part[..DriveStatus::HEAD_BYTES];
            let mut pieces = write(&begin, part).unwrap().to_vec();
            pieces.extend(write(&middle, part).unwrap());
            pieces.extend(write(&end, part).unwrap());
            for counter in &status.counters {
                let mut bytes = [0; COUNTER_BYTES];
                pieces.extend(write(counter, &mut bytes).unwrap());
            }
            assert_eq!(whole, pieces);
        }
    }
}
