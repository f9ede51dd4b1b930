//! Model of a drive as comms sees it: it executes orders, and sends any other
//! message that the input bytes make.

use crate::bytes::Bytes;
use crate::link_inputs;
use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::link::{
    DriveRefusal, DriveStatus, FromDrive, Heartbeat, Order, Outcome, ToDrive,
};
use crepitus_protocol::management::{Answer, Identity, Role};
use crepitus_protocol::pieces::Reassembly;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, BlockFlags};
use crepitus_protocol::{Lane, Revision, State, ValueError, schema};

/// Ticks stay within two months, the range of a drive.
const MOST_TICK: u64 = 1 << 37;

/// The drive.
pub(crate) struct DriveModel {
    status: DriveStatus,
    sequence: u16,
    comms_start: u16,
    has_sent_hello: bool,
    has_rejected: bool,
    reassembly: (Revision, Reassembly),
}

impl DriveModel {
    pub(crate) fn new(comms_start: u16) -> Self {
        Self {
            status: DriveStatus {
                comms_start: Some(comms_start),
                ..DriveStatus::default()
            },
            sequence: 0,
            comms_start,
            has_sent_hello: false,
            has_rejected: false,
            reassembly: (Revision::NONE, Reassembly::new(0)),
        }
    }

    /// Whether it has rejected a commit since the last call.
    pub(crate) fn has_rejected(&mut self) -> bool {
        std::mem::take(&mut self.has_rejected)
    }

    /// Executes a message of comms.
    pub(crate) fn receive(&mut self, message: &ToDrive) {
        match *message {
            ToDrive::Heartbeat(Heartbeat {
                lease_left, enable, ..
            }) => {
                if self.status.state == State::Armed {
                    if !enable {
                        self.status.state = State::Disarmed;
                    } else if lease_left == 0 {
                        self.status.state = State::Faulted;
                        self.status.fault = 2;
                    }
                }
            }
            ToDrive::Commit {
                revision,
                checksum,
                piece,
            } => {
                if self.reassembly.0 != revision || self.reassembly.1.checksum() != checksum {
                    self.reassembly = (revision, Reassembly::new(checksum));
                }
                self.reassembly.1.add(&piece);
                if self.reassembly.1.values().is_some() {
                    self.status.revision = revision;
                }
            }
            ToDrive::Command { number, order, .. } => {
                match order {
                    Order::Arm => self.status.state = State::Armed,
                    Order::Zero => self.status.zeroed = true,
                    Order::ClearFault => {
                        (self.status.state, self.status.fault) = (State::Disarmed, 0);
                    }
                }
                self.status.last = Some(Outcome {
                    number,
                    result: Ok(()),
                });
            }
        }
    }

    /// Messages of a normal drive in a millisecond.
    pub(crate) fn millisecond(&mut self) -> Vec<Frame> {
        let mut frames = vec![self.block(0), self.status()];
        if !std::mem::replace(&mut self.has_sent_hello, true) {
            frames.push(hello(schema::HASH));
        }
        frames
    }

    fn block(&mut self, dropped: u32) -> Frame {
        let status = &mut self.status;
        let block = Block {
            sequence: self.sequence,
            first_tick: status.tick,
            revision: status.revision,
            dropped,
            flags: BlockFlags::new(status.state, status.zeroed, status.start),
            ..Block::default()
        };
        self.sequence = self.sequence.wrapping_add(1);
        status.tick = (status.tick + BLOCK_SAMPLES as u64).min(MOST_TICK);
        frame::encode(Lane::Telemetry, &block).expect("every message fits")
    }

    fn status(&self) -> Frame {
        let message = FromDrive::Status(self.status);
        frame::encode(Lane::FromDrive, &message).expect("every message fits")
    }

    /// Anything else.
    pub(crate) fn anything(&mut self, bytes: &mut Bytes<'_>) -> Frame {
        match bytes.byte() % 8 {
            // Samples are lost on the link, or were dropped before it.
            0 => {
                self.status.tick += BLOCK_SAMPLES as u64 * u64::from(bytes.byte());
                let dropped = u32::from(bytes.byte()) * 20;
                self.block(dropped)
            }
            // It has restarted.
            1 => {
                self.status = DriveStatus {
                    start: u16::from(bytes.byte()),
                    tick: u64::from(bytes.byte()) * 20,
                    ..DriveStatus::default()
                };
                self.has_sent_hello = false;
                self.block(0)
            }
            2 => {
                self.status.state = bytes.choice(&State::ALL);
                self.status.fault = if self.status.state == State::Faulted {
                    bytes.byte().max(1)
                } else {
                    0
                };
                self.status()
            }
            3 => {
                self.has_rejected = true;
                self.status.refused = Some((
                    Revision(u32::from(bytes.byte())),
                    ValueError::NeedsDisarmed { id: bytes.byte() },
                ));
                self.status()
            }
            4 => {
                self.status.last = Some(Outcome {
                    number: u16::from(bytes.byte()),
                    result: bytes.choice(&[
                        Ok(()),
                        Err(DriveRefusal::NoLease),
                        Err(DriveRefusal::Faulted { code: 9 }),
                        Err(DriveRefusal::Aborted),
                    ]),
                });
                self.status()
            }
            5 => {
                self.status.revision = Revision(u32::from(bytes.byte()));
                self.status.comms_start = bytes.choice(&[None, Some(self.comms_start), Some(99)]);
                self.status()
            }
            6 => {
                let tick = link_inputs::near(bytes, self.status.tick).min(MOST_TICK);
                self.status.tick = tick.max(self.status.tick);
                self.status()
            }
            _ => hello(if bytes.byte() < 128 { schema::HASH } else { 0 }),
        }
    }
}

fn hello(schema: u64) -> Frame {
    let own = Identity {
        role: Role::Drive,
        schema,
        ..Identity::default()
    };
    let answer = Answer::Hello {
        token: 0,
        own,
        drive: own,
    };
    frame::encode_bytes(Lane::ManagementAnswer, &answer.bytes()).expect("a short frame")
}
