//! The comms controller, with anything from hosts and from the drive,
//! millisecond by millisecond:
//!
//! - its line is on only while a host holds the lease, blocks arrive, and
//!   there is no fault of comms; and only after a host has requested arming, and
//!   none since disarming or a stop. The same holds for `enable` in heartbeats;
//! - no heartbeat carries a longer lease than there is, by either clock;
//! - every frame for a host or for the drive is in order. A request has at most
//!   as many replies as it was sent times, and there are no others; it is executed
//!   once;
//! - the revision changes only after a commit, or a refusal, to the next one. Parameters that
//!   are read, sent or saved are those of the boot or of a commit that was not
//!   refused, and valid;
//! - every sample of a subscription is accounted for, and a block is the drive's;
//! - nothing is saved and nothing reboots without a request.

mod hosts;

use crate::bytes::Bytes;
use crate::drive_model::DriveModel;
use crate::from_comms::{self, Frames, FromComms};
use crate::host_oracle::HostOracle;
use crate::known_values::KnownValues;
use crate::lease_oracle::LeaseOracle;
use crate::link_inputs;
use crate::sent::Sent;
use crepitus_device::Comms;
use crepitus_device::comms::{Boot, Inputs, Outputs};
use crepitus_device::self_test::SelfTest;
use crepitus_device::usb_port::HostBytes;
use crepitus_protocol::host::Operation;
use crepitus_protocol::link::{Order, ToDrive};
use crepitus_protocol::management::{Identity, ManagementRequest, ResetCause};
use crepitus_protocol::pieces::Piece;
use crepitus_protocol::{
    Decoder, LEASE_TICKS, Lane, Nonce, Revision, Session, State, Values, frame, schema,
};
use std::collections::BTreeMap;

/// The most milliseconds of one input: a lease that is renewed, and one that
/// ends; a request that times out.
const MOST_MS: u64 = 700;

/// Length of a lease, ms.
const LEASE_MS: u64 = 250;

/// Timeout: without a block for this long the drive is silent, ms.
const SILENT_MS: u64 = 5;

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let reset = bytes.choice(&ResetCause::ALL);
    let saved = bytes.byte();
    let boot = Boot {
        self_test: SelfTest::default(),
        identity: Identity {
            schema: schema::HASH,
            reset,
            ..Identity::default()
        },
        start: u16::from(bytes.byte()),
        entropy: 1,
        saved: (saved > 127).then(|| {
            let revision = bytes.choice(&[0, 1, 7, u32::MAX - 1]);
            (Revision(revision), link_inputs::values(&mut bytes))
        }),
        counters: bytes.choice(&[0, u32::MAX - 2]),
        crash: None,
    };
    let mut bench = Bench::new(&boot);
    while !bytes.is_empty() && bench.now_ms < MOST_MS {
        bench.step(&mut bytes);
        bench.revision();
    }
    bench.read(usize::MAX);
}

/// A session of [`Bench::numbers`].
fn session_at(place: u32) -> Session {
    Session(place * 0x1001)
}

/// Comms, and an oracle that observes both its wires.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a line or a fact by itself"
)]
struct Bench {
    comms: Comms,
    start: u16,
    now_ms: u64,
    line_is_on: bool,
    drive: DriveModel,
    host: HostOracle,
    from_comms: Frames,
    /// Decoders of the bytes from hosts and to the drive.
    ear: Decoder,
    link_ear: Decoder,
    /// The last byte from hosts was no delimiter.
    is_in_frame: bool,
    numbers: [u32; 5],
    /// Time of the last block, ms.
    block_ms: Option<u64>,
    lease: LeaseOracle,
    /// The tick at which the lease ends, at most; none, if the drive's ticks
    /// have restarted since it was acquired.
    lease_end_tick: Option<u64>,
    /// Last request of each session that was executed.
    executed: BTreeMap<u32, (Nonce, u32)>,
    /// Last renewal of each.
    renewed: BTreeMap<u32, (Nonce, u32)>,
    /// Commits that were sent, until they are refused.
    commits: BTreeMap<(u32, u32), Values>,
    /// Reasons that there were for another revision.
    numbered: u32,
    revision: Revision,
    values: KnownValues,
    may_save: bool,
    may_reboot: bool,
}

impl Bench {
    fn new(boot: &Boot) -> Self {
        let comms = Comms::new(boot);
        Self {
            start: boot.start,
            now_ms: 0,
            line_is_on: false,
            drive: DriveModel::new(boot.start),
            host: HostOracle::default(),
            from_comms: Frames::default(),
            ear: Decoder::new(),
            link_ear: Decoder::new(),
            is_in_frame: false,
            numbers: [1, 2, 0x7ffe, 0xfffe, 9],
            block_ms: None,
            lease: LeaseOracle::new(LEASE_MS),
            lease_end_tick: None,
            executed: BTreeMap::new(),
            renewed: BTreeMap::new(),
            commits: BTreeMap::new(),
            numbered: 0,
            revision: comms.revision(),
            values: KnownValues::new(boot.saved.map(|(_, values)| values)),
            may_save: false,
            may_reboot: false,
            comms,
        }
    }

    fn step(&mut self, bytes: &mut Bytes<'_>) {
        match bytes.byte() % 9 {
            0 => {
                let how = bytes.byte();
                let line = (how & 1 != 0).then_some(how & 2 != 0);
                self.drive.silent_millisecond();
                self.tick(line);
            }
            // Normal operation, for this many milliseconds.
            1 => {
                let count = if bytes.byte() < 128 { usize::MAX } else { 8 };
                self.run(link_inputs::milliseconds(bytes), count);
            }
            2 | 3 => {
                let place = usize::from(bytes.byte()) % self.numbers.len();
                let operation = link_inputs::operation(bytes, self.comms.revision());
                let number = &mut self.numbers[place];
                let mut before = 0;
                match bytes.byte() {
                    // Repeated; but of a subscription nobody could tell which
                    // one it is that begins.
                    0..=47 if operation != Operation::Subscribe => {}
                    48..=55 => *number += u32::from(bytes.u16()),
                    56..=63 => before = u32::from(bytes.u16()),
                    _ => *number += 1,
                }
                let number = number.saturating_sub(before);
                let session = session_at(u32::try_from(place).expect("a few"));
                if self.host.nonce(session) == Nonce::NONE {
                    // One number before, so that what follows is newer.
                    self.request(session, number.saturating_sub(1), Operation::Open);
                    self.read(usize::MAX);
                }
                self.request(session, number, operation);
                if number % 8 == 3 {
                    self.stale_request(session, number + 1, operation);
                }
            }
            4 => {
                let count = usize::from(bytes.byte());
                self.send_raw(bytes.take_some(count));
            }
            5 => {
                let question = ManagementRequest {
                    action: link_inputs::action(bytes),
                    token: bytes.byte(),
                };
                let frame = frame::encode_bytes(Lane::Management, &question.bytes());
                self.send(&frame.expect("a short frame"), &Sent::Question(question));
            }
            6 => {
                let frame = self.drive.anything(bytes);
                if self.drive.has_restarted() {
                    self.lease_end_tick = None;
                }
                self.numbered += u32::from(self.drive.has_rejected());
                self.drive_says(&frame);
            }
            7 => match bytes.byte() {
                0..=15 => {
                    self.comms.host_lost();
                    self.host.cut();
                    self.from_comms.cut();
                    self.ear.reset();
                    self.is_in_frame = false;
                }
                16..=63 => self.comms.saved(bytes.byte() < 200),
                240..=249 => self.arm(),
                250.. => self.evict_sessions(),
                count => self.read(usize::from(count)),
            },
            _ => {
                self.drive.silent_millisecond();
                self.tick(None);
                for _ in 0..bytes.byte() % 8 {
                    self.link_frame();
                }
            }
        }
    }

    /// Normal operation; the host reads so many bytes in a millisecond.
    fn run(&mut self, milliseconds: u16, count: usize) {
        for _ in 0..milliseconds {
            if self.now_ms >= MOST_MS {
                break;
            }
            self.good_millisecond();
            self.read(count);
        }
        // What follows finds the drive present.
        if let Some(block) = self.drive.next_block() {
            self.drive_says(&block);
        }
    }

    /// All that arming needs.
    fn arm(&mut self) {
        let session = Session(0);
        for operation in [Operation::Open, Operation::Zero, Operation::Arm] {
            if let Some(number) = self.numbers.first_mut() {
                *number += 1;
                let number = *number;
                self.request(session, number, operation);
            }
            self.run(10, usize::MAX);
        }
    }

    fn drive_says(&mut self, frame: &[u8]) {
        for byte in frame {
            self.comms.link_received(*byte);
        }
        if from_comms::is_block(frame) {
            self.block_ms = Some(self.now_ms);
            assert!(!self.drive.shows_overcurrent() || self.comms.fault().is_some());
        }
    }

    fn good_millisecond(&mut self) {
        let is_live = matches!(self.comms.state(), State::Arming | State::Armed);
        let is_idle = !is_live && self.host.is_idle();
        for frame in self.drive.millisecond(is_idle) {
            self.drive_says(&frame);
        }
        self.tick(None);
        while self.link_frame() {}
    }

    fn tick(&mut self, line: Option<bool>) {
        self.now_ms += 1;
        let outputs = self.comms.tick(&Inputs {
            enable_is_on: line.unwrap_or(self.line_is_on),
        });
        self.line_is_on = outputs.enable;
        self.hold(&outputs);
    }

    fn hold(&mut self, outputs: &Outputs) {
        if outputs.enable {
            assert!(self.lease.is_alive(self.now_ms), "enabled without a lease");
            assert!(self.lease.is_wanted(), "enabled, and nobody wants it");
            assert_eq!(self.comms.fault(), None);
            let heard = self.block_ms.expect("a block");
            assert!(self.now_ms - heard < SILENT_MS, "the drive is silent");
        }
        if let Some((revision, values)) = outputs.save {
            assert!(std::mem::take(&mut self.may_save));
            assert_eq!(revision, self.comms.revision());
            assert!(self.values.has(&values));
        }
        if outputs.reboot {
            assert!(self.may_reboot, "it starts anew, and nobody has asked");
            assert!(!outputs.enable);
        }
    }

    fn revision(&mut self) {
        let now = self.comms.revision();
        if now == self.revision {
            return;
        }
        // Commits that were refused had numbers, too; what the drive has refused after it was
        // taken for committed is given another; and one that the drive would take for old the
        // next after what it has in force.
        let mut before = now;
        while before != self.revision && !self.drive.has_reported_before(before) {
            assert!(self.numbered > 0, "a revision without a commit");
            self.numbered -= 1;
            before = Revision(before.0.wrapping_sub(1));
        }
        self.revision = now;
    }

    /// Takes the next frame for the drive, if there is one.
    fn link_frame(&mut self) -> bool {
        let Some(frame) = self.comms.link_to_send() else {
            return false;
        };
        let mut found = 0;
        for byte in &frame {
            let Some(body) = self.link_ear.push(*byte) else {
                continue;
            };
            let body = body.expect("a frame in order");
            found += 1;
            match body.lane() {
                Some(Lane::ToDrive) => {
                    let message = body.message().expect("a message");
                    self.told(&message);
                }
                Some(Lane::Management) => {
                    let question = ManagementRequest::of(body.payload);
                    self.drive.manage(question.expect("a question").action);
                }
                other => panic!("{other:?} for the drive"),
            }
        }
        assert_eq!(found, 1, "frames in a frame");
        true
    }

    fn told(&mut self, message: &ToDrive) {
        self.drive.receive(message);
        match message {
            ToDrive::Heartbeat(heartbeat) => {
                let left = u64::from(heartbeat.lease_left);
                assert!(left < LEASE_TICKS);
                assert!(left == 0 || self.lease.is_alive(self.now_ms));
                let end = self.lease_end_tick.filter(|_| left > 0);
                assert!(end.is_none_or(|end| heartbeat.seen_tick + left < end));
                assert!(!heartbeat.enable || self.lease.is_wanted());
            }
            ToDrive::Commit { seal, piece, .. } => {
                let source = self.values.by_seal(*seal, self.start);
                let source = source.expect("valid values of a host");
                assert_eq!(Piece::of(&source.0, piece.index), Some(*piece));
            }
            ToDrive::Command { order, .. } => {
                assert!(*order != Order::Arm || self.lease.is_wanted());
            }
            ToDrive::ReadCrash { .. } => {}
        }
    }

    /// Takes this many bytes for the host.
    fn read(&mut self, count: usize) {
        let mut left = count;
        while left > 0 && !self.comms.to_send().is_empty() {
            let run = self.comms.to_send();
            let run = &run[..run.len().min(left)];
            let (drive, host, values) = (&mut self.drive, &mut self.host, &self.values);
            let mut replies = Vec::new();
            self.from_comms.split(run, |frame| {
                if from_comms::is_block(frame) {
                    host.block(&drive.take_block(frame));
                } else if let FromComms::Reply(reply) = FromComms::of(frame) {
                    host.reply(&reply, values);
                    replies.push(reply);
                }
            });
            let count = run.len();
            self.comms.sent(count);
            left -= count;
            for reply in &replies {
                self.replied(reply);
            }
        }
    }
}

#[cfg(test)]
mod tests;
