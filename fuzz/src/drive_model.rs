//! Model of a drive as comms sees it: it executes orders, and sends any other
//! message that the input bytes make.

use crate::block_frames;
use crate::bytes::Bytes;
use crate::link_inputs;
use crepitus_protocol::crash;
use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::link::{
    DriveRefusal, DriveStatus, FromDrive, Heartbeat, Order, Outcome, ToDrive,
};
use crepitus_protocol::management::{Action, Answer, Identity, Role};
use crepitus_protocol::pieces::Reassembly;
use crepitus_protocol::telemetry::{
    BLOCK_SAMPLES, BLOCK_TICKS, Block, BlockFlags, NO_CURRENT, Sample, SampleFlags,
};
use crepitus_protocol::{Decoder, Lane, Revision, State, ValueError, schema};
use std::collections::{BTreeSet, VecDeque};

/// Ticks stay within two months, the range of a drive.
const MOST_TICK: u64 = 1 << 37;

/// Milliseconds between two blocks.
const BLOCK_MS: u8 = 4;

/// Milliseconds between two statuses, if nothing changes.
const STATUS_MS: u8 = 5;

/// A current that no drive commands, mA.
const OVERCURRENT_MA: i16 = 2_500;

/// Milliseconds of arming, in which it awaits the line of comms.
const ARMING_MS: u8 = 3;

/// The most restarts: blocks carry five bits of their count.
const MOST_RESTARTS: u32 = 30;

/// The drive.
#[expect(clippy::struct_excessive_bools, reason = "each is a fact by itself")]
pub(crate) struct DriveModel {
    status: DriveStatus,
    /// The last status, and milliseconds since.
    reported: DriveStatus,
    reported_ms: u8,
    /// Milliseconds since the last block.
    block_ms: u8,
    sequence: u16,
    /// Samples that it did not send.
    dropped: u32,
    /// Blocks that it sent.
    blocks: VecDeque<Block>,
    comms_start: u16,
    has_sent_hello: bool,
    has_rejected: bool,
    has_restarted: bool,
    restarts: u32,
    /// The latest tick that it has reported since, and whether its last block was the first to.
    latest_tick: u64,
    is_newest: bool,
    reassembly: (Revision, Reassembly),
    /// Revisions that its statuses have reported.
    revisions: BTreeSet<u32>,
    /// The part of its post-mortem record that it was asked for.
    crash_part: Option<u8>,
    /// A block was sent before its millisecond.
    is_ahead: bool,
    /// While it arms: the number of that command, and milliseconds that are left.
    arming: Option<(u16, u8)>,
}

impl DriveModel {
    pub(crate) fn new(comms_start: u16) -> Self {
        Self {
            status: DriveStatus {
                comms_start: Some(comms_start),
                ..DriveStatus::default()
            },
            reported: DriveStatus::default(),
            reported_ms: STATUS_MS,
            block_ms: 0,
            sequence: 0,
            dropped: 0,
            blocks: VecDeque::new(),
            comms_start,
            has_sent_hello: false,
            has_rejected: false,
            has_restarted: false,
            restarts: 0,
            latest_tick: 0,
            is_newest: false,
            reassembly: (Revision::NONE, Reassembly::new(0, 0, 0)),
            revisions: BTreeSet::new(),
            crash_part: None,
            is_ahead: false,
            arming: None,
        }
    }

    /// Returns whether the last block shows an overcurrent while armed or arming. A stale block does not
    /// count: after an unseen restart comms ignores it.
    pub(crate) fn shows_overcurrent(&self) -> bool {
        self.blocks.back().is_some_and(|block| {
            let is_live = matches!(block.flags.state(), State::Arming | State::Armed);
            let is_over = |sample: &Sample| sample.current_ma == OVERCURRENT_MA;
            is_live && self.is_newest && block.samples.iter().all(is_over)
        })
    }

    /// Returns whether it has rejected a commit since the last call.
    pub(crate) fn has_rejected(&mut self) -> bool {
        std::mem::take(&mut self.has_rejected)
    }

    /// Returns whether a status has reported the revision just before this one.
    pub(crate) fn has_reported_before(&self, revision: Revision) -> bool {
        let before = |reported: &u32| Revision(*reported).next() == revision;
        self.revisions.iter().any(before)
    }

    /// True if its ticks have restarted since the last call.
    pub(crate) fn has_restarted(&mut self) -> bool {
        std::mem::take(&mut self.has_restarted)
    }

    /// The latest tick that it has reported.
    pub(crate) fn tick(&self) -> u64 {
        self.latest_tick
    }

    /// Executes a message of comms.
    pub(crate) fn receive(&mut self, message: &ToDrive) {
        match *message {
            ToDrive::Heartbeat(Heartbeat {
                lease_left,
                enable,
                start,
                ..
            }) => {
                self.status.comms_start = Some(start);
                if matches!(self.status.state, State::Arming | State::Armed) {
                    if !enable {
                        self.status.state = State::Disarmed;
                    } else if lease_left == 0 {
                        self.status.state = State::Faulted;
                        self.status.fault = 2;
                    }
                }
                self.abort_arming();
            }
            ToDrive::Commit {
                revision,
                seal,
                pieces,
                piece,
            } => {
                if self.reassembly.0 != revision || self.reassembly.1.seal() != seal {
                    let reassembly = Reassembly::new(seal, self.comms_start, pieces);
                    self.reassembly = (revision, reassembly);
                }
                self.reassembly.1.add(&piece);
                if self.reassembly.1.values().is_some() {
                    self.status.revision = revision;
                }
            }
            ToDrive::Command { number, order, .. } => {
                match order {
                    // The result comes later.
                    Order::Arm => {
                        (self.status.state, self.status.awaits_comms) = (State::Arming, true);
                        self.arming = Some((number, ARMING_MS));
                        return;
                    }
                    Order::Zero => self.status.zeroed = true,
                    Order::ClearFault => {
                        (self.status.state, self.status.fault) = (State::Disarmed, 0);
                    }
                    Order::PlayChirp(_) => {}
                }
                self.status.last = Some(Outcome {
                    number,
                    result: Ok(()),
                });
            }
            ToDrive::ReadCrash { part } => self.crash_part = Some(part),
        }
    }

    /// A question of the lane that never changes: who it is, is said again.
    pub(crate) fn manage(&mut self, action: Action) {
        self.has_sent_hello &= action != Action::Hello;
    }

    /// Ends arming where the state was left.
    fn abort_arming(&mut self) {
        if self.status.state == State::Arming {
            return;
        }
        self.status.awaits_comms = false;
        if let Some((number, _)) = self.arming.take() {
            let result = Err(DriveRefusal::Aborted);
            self.status.last = Some(Outcome { number, result });
        }
    }

    /// Arms for a millisecond.
    fn arm(&mut self) {
        self.abort_arming();
        match &mut self.arming {
            None => {}
            Some((number, 0)) => {
                let (number, result) = (*number, Ok(()));
                self.status.last = Some(Outcome { number, result });
                (self.status.state, self.status.awaits_comms) = (State::Armed, false);
                self.arming = None;
            }
            Some((_, left_ms)) => *left_ms -= 1,
        }
    }

    /// The messages of a normal drive in a millisecond: a status after every
    /// change, or else every 5 ms; and as few blocks as keep it from being
    /// silent, since they cost most. It drops the others. While comms is idle it
    /// sends changes only.
    pub(crate) fn millisecond(&mut self, is_idle: bool) -> impl Iterator<Item = Frame> + use<> {
        self.arm();
        self.block_ms = self.block_ms.saturating_add(1);
        let block = if is_idle { None } else { self.due_block() };
        if block.is_none() {
            self.drop_block();
        }
        self.reported_ms = self.reported_ms.saturating_add(1);
        self.reported.tick = self.status.tick;
        let is_due = !is_idle && self.reported_ms >= STATUS_MS;
        let status = (is_due || self.reported != self.status).then(|| self.status());
        let is_first = !std::mem::replace(&mut self.has_sent_hello, true);
        let hello = is_first.then(|| hello(schema::HASH));
        let crash_part = self.crash_part.take().map(crash_part);
        [block, status, hello, crash_part].into_iter().flatten()
    }

    /// A millisecond of which comms hears nothing.
    pub(crate) fn silent_millisecond(&mut self) {
        self.arm();
        self.drop_block();
    }

    /// A block's time passes without one, unless it was sent before.
    fn drop_block(&mut self) {
        if !std::mem::take(&mut self.is_ahead) {
            self.advance();
            self.dropped = self.dropped.wrapping_add(BLOCK_TICKS);
        }
    }

    /// The block of the next millisecond, unless the last one was sent less than [`BLOCK_MS`]
    /// ago.
    pub(crate) fn next_block(&mut self) -> Option<Frame> {
        let block = self.due_block();
        self.is_ahead |= block.is_some();
        block
    }

    /// A block, unless the last one was sent less than [`BLOCK_MS`] ago.
    fn due_block(&mut self) -> Option<Frame> {
        (self.block_ms >= BLOCK_MS).then(|| self.block())
    }

    /// A block's time passes.
    fn advance(&mut self) {
        self.status.tick = (self.status.tick + BLOCK_SAMPLES as u64).min(MOST_TICK);
    }

    fn block(&mut self) -> Frame {
        let block = self.taken(Sample::default());
        block_frames::encode(&block)
    }

    /// A block of such samples.
    fn block_of(&mut self, sample: Sample) -> Frame {
        let block = self.taken(sample);
        frame::encode(Lane::Telemetry, &block).expect("a block fits")
    }

    fn taken(&mut self, sample: Sample) -> Block {
        let status = &self.status;
        let block = Block {
            sequence: self.sequence,
            first_tick: status.tick,
            revision: status.revision,
            dropped: self.dropped,
            flags: BlockFlags::new(status.state, status.zeroed, status.start),
            samples: [sample; BLOCK_SAMPLES],
            ..Block::default()
        };
        self.block_ms = 0;
        self.is_newest = block.end_tick() > self.latest_tick;
        self.latest_tick = self.latest_tick.max(block.end_tick());
        self.blocks.push_back(block);
        self.sequence = self.sequence.wrapping_add(1);
        self.advance();
        block
    }

    /// Takes a block that comms has forwarded, in order: as it was sent, but for
    /// the samples dropped, which comms counts itself.
    pub(crate) fn take_block(&mut self, frame: &[u8]) -> Block {
        let block = block_frames::decode(frame).or_else(|| decoded(frame));
        let block = block.expect("a block");
        let (number, dropped) = (block.sequence, block.dropped);
        let place = self.blocks.iter().position(|sent| sent.sequence == number);
        let mut sent = self.blocks.drain(..=place.expect("a block of the drive"));
        let sent = sent.next_back().expect("this one");
        assert_eq!(block, Block { dropped, ..sent });
        block
    }

    fn status(&mut self) -> Frame {
        (self.reported, self.reported_ms) = (self.status, 0);
        self.latest_tick = self.latest_tick.max(self.status.tick);
        self.revisions.insert(self.status.revision.0);
        let message = FromDrive::Status(self.status);
        frame::encode(Lane::FromDrive, &message).expect("every message fits")
    }

    /// Anything else.
    pub(crate) fn anything(&mut self, bytes: &mut Bytes<'_>) -> Frame {
        match bytes.byte() % 8 {
            // Samples are lost on the link, or were dropped before it.
            0 => {
                self.status.tick += BLOCK_SAMPLES as u64 * u64::from(bytes.byte());
                let dropped = bytes.byte();
                self.dropped = u32::from(dropped) * BLOCK_TICKS;
                if dropped < 192 {
                    self.block()
                } else {
                    self.block_of(sample(bytes))
                }
            }
            // The drive has restarted.
            1 => {
                // Mostly with the next number. The accounting sees five bits of it: one
                // of long ago would be taken for the same start, so it is not that often.
                let start = match bytes.byte() {
                    64.. if self.restarts < MOST_RESTARTS => {
                        self.restarts += 1;
                        self.status.start.wrapping_add(1)
                    }
                    _ => self.status.start,
                };
                // Without a change comms keeps on with the ticks of before.
                if start != self.status.start {
                    (self.has_restarted, self.latest_tick) = (true, 0);
                }
                self.status = DriveStatus {
                    start,
                    tick: u64::from(bytes.byte()) * 20,
                    ..DriveStatus::default()
                };
                (self.has_sent_hello, self.dropped) = (false, 0);
                self.block()
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

/// A sample that is in order, or is not.
fn sample(bytes: &mut Bytes<'_>) -> Sample {
    const TORQUES_NM: [f32; 4] = [0.0, 1.0, 9.0, f32::INFINITY];
    let flags = [
        SampleFlags::ENERGISED,
        SampleFlags::ENERGISED | SampleFlags::LOST,
        SampleFlags::LOST,
        0,
    ];
    Sample {
        count: bytes.i32(),
        current_ma: bytes.choice(&[0, OVERCURRENT_MA, -300, NO_CURRENT]),
        torque_nm: bytes.choice(&TORQUES_NM),
        model_torque_nm: bytes.choice(&TORQUES_NM),
        flags: SampleFlags(bytes.choice(&flags)),
    }
}

/// A block as the product's own decoder reads it.
fn decoded(frame: &[u8]) -> Option<Block> {
    let mut decoder = Decoder::new();
    frame
        .iter()
        .find_map(|byte| decoder.push(*byte)?.ok()?.message())
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

/// A part of a record whose words all are the part's number.
fn crash_part(number: u8) -> Frame {
    let words = (number < 23).then_some([number.into(); crash::PART_WORDS]);
    let message = FromDrive::CrashPart(crash::Part { number, words });
    frame::encode(Lane::FromDrive, &message).expect("a part fits")
}
