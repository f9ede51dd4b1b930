//! Messages between the two controllers.
//!
//! **Freshness.** Every heartbeat and every command echoes the drive's own
//! tick, as comms last saw it. What has been on its way for too long, however
//! it came to be delayed, repeated or replayed, is older than
//! [`STALE_TICKS`] by the drive's own clock and does not count. The lease ends
//! at a tick of the drive, too, so a late heartbeat cannot make it longer.
//!
//! **Commands** have numbers. The drive carries out a number that is newer
//! than the last one, once, and says the outcome in every [`DriveStatus`];
//! comms repeats a command until it hears its outcome.

use crate::counters::DRIVE_COUNT;
use crate::pieces::Piece;
use crate::revision::Revision;
use crate::settings::ValueError;
use crate::state::State;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A message whose echo is older than this does not count, ticks. A block is
/// 20 ticks, its way 17, a heartbeat every 20.
pub const STALE_TICKS: u64 = 400;

/// What comms tells the drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub enum ToDrive {
    /// Comms is alive. Sent every millisecond.
    Heartbeat(Heartbeat),
    /// Parameters to apply with the next block, one piece of them.
    Commit {
        /// Their revision.
        revision: Revision,
        /// Checksum over all values of the commit.
        checksum: u32,
        /// Some of the values.
        piece: Piece,
    },
    /// Do this, once.
    Command {
        /// The drive's tick as comms last saw it.
        seen_tick: u64,
        /// Grows by one with each command; wraps.
        number: u16,
        /// What.
        order: Order,
    },
}

/// Comms is alive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Heartbeat {
    /// The drive's tick as comms last saw it.
    pub seen_tick: u64,
    /// The lease ends so many ticks after `seen_tick`.
    pub lease_left: u16,
    /// Whether there may be torque: without it the drive disarms.
    pub enable: bool,
    /// Which start of comms this is.
    pub start: u16,
}

/// What the drive can be told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub enum Order {
    /// Prove the enable line, then render.
    Arm,
    /// The angle is zero here.
    Zero,
    /// Forget the fault.
    ClearFault,
}

/// What the drive tells comms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub enum FromDrive {
    /// How it is. Sent every 5 ms, and at every change.
    Status(DriveStatus),
}

/// Bytes of a counter, at most.
pub const COUNTER_BYTES: usize = u32::POSTCARD_MAX_SIZE;

impl DriveStatus {
    /// Bytes of [`Self::head`], at most.
    pub const HEAD_BYTES: usize = FromDrive::POSTCARD_MAX_SIZE - DRIVE_COUNT * COUNTER_BYTES;

    /// The message [`FromDrive::Status`] as far as the counters, for a sender
    /// that makes its frame piece by piece. Each of them follows by itself.
    pub fn head(&self) -> impl Serialize + use<> {
        const STATUS: u8 = 0;
        (
            (STATUS, self.tick, self.start, self.heard),
            (self.state, self.fault, self.revision, self.refused),
            (self.last, self.zeroed, self.polarity_proven),
        )
    }
}

/// How the drive is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct DriveStatus {
    /// Now.
    pub tick: u64,
    /// Which start of the drive this is.
    pub start: u16,
    /// Which start of comms it has heard last; what it says of commits and
    /// commands is about that one's.
    pub heard: Option<u16>,
    /// Its state.
    pub state: State,
    /// Code of its fault, 0 for none.
    pub fault: u8,
    /// The parameters in force.
    pub revision: Revision,
    /// The last commit that it refused, and why.
    pub refused: Option<(Revision, ValueError)>,
    /// The last command that it carried out.
    pub last: Option<Outcome>,
    /// Whether the angle's zero was said.
    pub zeroed: bool,
    /// Whether encoder and motor have been seen to turn the same way.
    pub polarity_proven: bool,
    /// What it has counted.
    pub counters: [u32; DRIVE_COUNT],
}

/// What became of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub struct Outcome {
    /// Its number.
    pub number: u16,
    /// Done; or why not.
    pub result: Result<(), DriveRefusal>,
}

/// Why the drive does not do what it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
#[non_exhaustive]
pub enum DriveRefusal {
    /// It was given no parameters yet.
    NoParameters,
    /// There is no live lease.
    NoLease,
    /// A fault stands in the way: its code.
    Faulted {
        /// The code.
        code: u8,
    },
    /// Not while there is torque.
    Armed,
    /// The encoder's counts are not to be believed.
    NoEncoder,
    /// Arming was given up: comms or the host took it back.
    Aborted,
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
            heard: Some(u16::MAX),
            state: State::Faulted,
            fault: 255,
            revision: Revision(u32::MAX),
            refused: Some((Revision(u32::MAX), ValueError::KineticAboveStatic)),
            last: Some(Outcome {
                number: u16::MAX,
                result: Err(DriveRefusal::Faulted { code: 255 }),
            }),
            zeroed: true,
            polarity_proven: true,
            counters: core::array::from_fn(|n| u32::MAX >> n),
        };
        for status in [status, DriveStatus::default()] {
            let (mut whole, mut part) = ([0; 256], [0; 256]);
            let whole = write(&FromDrive::Status(status), &mut whole).unwrap();
            let head = write(&status.head(), &mut part[..DriveStatus::HEAD_BYTES]).unwrap();
            let mut pieces = head.to_vec();
            for counter in &status.counters {
                let mut bytes = [0; COUNTER_BYTES];
                pieces.extend(write(counter, &mut bytes).unwrap());
            }
            assert_eq!(whole, pieces);
        }
    }
}
