//! The drive controller, with anything on its link and any readings, tick by
//! tick:
//!
//! - the bridge is driven only while armed or arming, with the line on, with a
//!   finite voltage, and not in a tick in which the hardware has tripped;
//! - at most 100 ticks after the last fresh heartbeat, and before the end of
//!   the lease that it carried;
//! - at most 10 ticks in a row without the line read back on;
//! - a fault stays until a command clears it; nothing else arms but a command;
//! - active parameters were sent completely, and are valid;
//! - torque is a number within the largest limit, and zero unless armed;
//! - every frame that it sends is valid, and every sample is accounted for;
//! - parts of the record of a crash are that record's.

mod readings;

use crate::bytes::Bytes;
use crate::link_inputs;
use crate::winding::{CoilWinding, Winding};
use crepitus_device::Drive;
use crepitus_device::drive::coil::{CoilOutput, LARGEST_COIL_DUTY};
use crepitus_device::drive::command::{Inputs, Outputs};
use crepitus_device::drive::motor::Bridge;
use crepitus_device::drive::prepare::LARGEST_DUTY;
use crepitus_device::drive::{Boot, Crash};
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::crash::{End, Head, PART_WORDS, TICK_WORDS};
use crepitus_protocol::link::{FromDrive, Heartbeat, Order, STALE_TICKS, ToDrive};
use crepitus_protocol::management::{Answer, Identity, ManagementRequest, ResetCause};
use crepitus_protocol::pieces::{self, Piece};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, SampleFlags};
use crepitus_protocol::{
    Decoder, DeviceSettings, HEARTBEAT_TICKS, Lane, Revision, State, TICK_US, Values, frame, schema,
};
use readings::{Readings, SensorFault};
use std::array;
use std::collections::VecDeque;

/// The most ticks of one input.
const MOST_TICKS: u64 = 4096;

/// The largest torque that limits can be set to, N·m.
const MOST_NM: f32 = 4.5;

/// More runs than a status takes to be made, with the answers that go before it.
const STATUS_RUNS: usize = 60;

/// The most milliseconds that a drive in order takes from a commit to its revision.
const MOST_PREPARING_MS: u32 = 20;

/// Bytes that say how it starts.
pub(crate) const HEAD_BYTES: usize = 5;

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let reset = bytes.choice(&ResetCause::ALL);
    let counter = bytes.choice(&[0, 7, 0x7fff_fff0, 0xffff_fff0]);
    let start = u16::from(bytes.byte());
    let boot = Boot {
        self_test: SelfTest::default(),
        identity: Identity {
            schema: schema::HASH,
            reset,
            ..Identity::default()
        },
        counter,
        start,
        tick: bytes.choice(&[0, 1, (1 << 32) - 50, 1 << 40]),
        sequence: bytes.choice(&[0, u16::MAX - 1]),
        crash: (start & 0x80 != 0).then(|| Crash {
            head: Head::new(start, End::Panic, 7),
            ticks: array::from_fn(|n| [u32::try_from(n).expect("a few"); TICK_WORDS]),
        }),
    };
    let mut bench = Bench::new(&boot);
    while !bytes.is_empty() && bench.ticks < MOST_TICKS {
        bench.step(&mut bytes);
    }
    bench.read(1_000);
}

/// A drive, and an oracle that observes its link.
struct Bench {
    drive: Drive,
    winding: Winding,
    coil: CoilWinding,
    counter: u32,
    line_is_on: bool,
    ticks: u64,
    /// Decoder of the bytes to the drive.
    ear: Decoder,
    comms_start: Option<u64>,
    /// Number of the last heartbeat; start and number of the last one that was fresh.
    beat: u8,
    last_beat: Option<(u16, u8)>,
    lease_end: u64,
    sent: Vec<(Revision, Values)>,
    number: u16,
    /// Ticks in a row with a driven bridge and the line read back off.
    astray: u32,
    /// Decoder of the bytes from the drive.
    host: Decoder,
    /// Next tick, state and revision of the drive in the last runs of the link's task.
    states: VecDeque<(u64, State, Revision)>,
    /// Comms has reported a start other than 0.
    has_restarted: bool,
    received: u64,
    first_tick: u64,
    /// Ticks since `first_tick`: true with torque.
    energised: Vec<bool>,
    sequence: u16,
    /// Words of its record of a crash.
    crash: Vec<u32>,
}

impl Bench {
    fn new(boot: &Boot) -> Self {
        let head = boot.crash.iter().flat_map(|crash| crash.head.words());
        let ticks = boot
            .crash
            .iter()
            .flat_map(|crash| crash.ticks.as_flattened());
        Self {
            crash: head.chain(ticks.copied()).collect(),
            drive: Drive::new(boot).expect("the defaults are allowed"),
            winding: Winding::default(),
            coil: CoilWinding::default(),
            counter: boot.counter,
            line_is_on: false,
            ticks: 0,
            ear: Decoder::new(),
            comms_start: None,
            beat: 0,
            last_beat: None,
            lease_end: 0,
            sent: Vec::new(),
            number: 0,
            astray: 0,
            host: Decoder::new(),
            states: VecDeque::new(),
            has_restarted: false,
            received: 0,
            first_tick: boot.tick,
            energised: Vec::new(),
            sequence: boot.sequence,
        }
    }

    fn step(&mut self, bytes: &mut Bytes<'_>) {
        let now = self.drive.next_tick();
        match bytes.byte() % 10 {
            0 => {
                let readings = Readings::any(bytes);
                self.run(u64::from(bytes.byte()), &readings);
            }
            1 => {
                let seen_tick = link_inputs::near(bytes, now);
                let lease_left = bytes.u16();
                let enable = !bytes.byte().is_multiple_of(8);
                let which = bytes.byte();
                // Now and then one of before.
                self.beat = self.beat.wrapping_add(match which % 16 {
                    14 => 200,
                    15 => 0,
                    _ => 1,
                });
                self.send(&ToDrive::Heartbeat(Heartbeat {
                    seen_tick,
                    lease_left,
                    enable,
                    start: u16::from(which / 64),
                    number: self.beat,
                }));
            }
            // Normal operation: for this many milliseconds, and with a shaft that
            // turns.
            2 => {
                let readings = Readings {
                    turn: bytes.byte().cast_signed() / 16,
                    ..Readings::good()
                };
                for _ in 0..bytes.byte() % 32 {
                    self.heartbeat(5_000);
                    self.run(20, &readings);
                    self.read(20);
                }
            }
            3 => {
                let revision = Revision(u32::from(bytes.byte()));
                let values = link_inputs::values(bytes);
                self.commit(revision, &values);
            }
            4 => {
                let chirp = Order::PlayChirp(link_inputs::chirp(bytes));
                let order = bytes.choice(&[Order::Arm, Order::Zero, Order::ClearFault, chirp]);
                let jump = bytes.byte();
                let number = if jump < 192 {
                    self.number = self.number.wrapping_add(1);
                    self.number
                } else {
                    u16::from(jump) << 8
                };
                self.send(&ToDrive::Command {
                    seen_tick: link_inputs::near(bytes, now),
                    number,
                    order,
                });
            }
            5 => {
                let count = usize::from(bytes.byte());
                let raw = bytes.take_some(count).to_vec();
                self.receive(&raw);
            }
            6 => {
                let question = ManagementRequest {
                    action: link_inputs::action(bytes),
                    token: bytes.byte(),
                };
                let frame = frame::encode_bytes(Lane::Management, &question.bytes());
                self.receive(&frame.expect("a short frame"));
            }
            7 => match bytes.byte() {
                runs @ 0..=127 => self.read(usize::from(runs % 8)),
                part => self.send(&ToDrive::ReadCrash { part: part % 32 }),
            },
            8 => self.arm(),
            // Heartbeats of a lease that is not renewed.
            _ => {
                let seen_tick = self.drive.next_tick();
                let end = seen_tick.saturating_add(u64::from(bytes.byte()) * 4);
                for _ in 0..20 {
                    let now = self.drive.next_tick();
                    let left = end.saturating_sub(now);
                    self.heartbeat(u16::try_from(left).unwrap_or(u16::MAX));
                    self.run(20, &Readings::good());
                }
            }
        }
    }

    /// All that arming needs.
    fn arm(&mut self) {
        let revision = Revision(1);
        self.commit(revision, &Values::default());
        // The drive prepares values between its ticks, some of them in each.
        for _ in 0..MOST_PREPARING_MS {
            self.heartbeat(5_000);
            self.run(20, &Readings::good());
            if self.drive.revision() == revision {
                break;
            }
        }
        self.heartbeat(5_000);
        for order in [Order::ClearFault, Order::Zero, Order::Arm] {
            self.number = self.number.wrapping_add(1);
            self.send(&ToDrive::Command {
                seen_tick: self.drive.next_tick(),
                number: self.number,
                order,
            });
        }
    }

    fn heartbeat(&mut self, lease_left: u16) {
        self.beat = self.beat.wrapping_add(1);
        self.send(&ToDrive::Heartbeat(Heartbeat {
            seen_tick: self.drive.next_tick(),
            lease_left,
            enable: true,
            start: 0,
            number: self.beat,
        }));
    }

    fn commit(&mut self, revision: Revision, values: &Values) {
        self.sent.push((revision, *values));
        let send = pieces::to_send(&values.0);
        let [count, ..] = send.count_ones().to_le_bytes();
        let all = (0..).map_while(|index| Piece::of(&values.0, index));
        for piece in all.filter(|piece| send >> piece.index & 1 == 1) {
            self.send(&ToDrive::Commit {
                revision,
                seal: pieces::seal(&values.0, 0),
                pieces: count,
                piece,
            });
        }
    }

    fn send(&mut self, message: &ToDrive) {
        let frame = frame::encode(Lane::ToDrive, message).expect("every message fits");
        self.receive(&frame);
    }

    /// Bytes for the drive, and for the oracle.
    fn receive(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let message = match self.ear.push(*byte) {
                Some(Ok(body)) if body.lane() == Some(Lane::ToDrive) => body.message(),
                _ => None,
            };
            let (before, now) = (self.drive.state(), self.drive.next_tick());
            self.drive.link_received(*byte);
            let after = self.drive.state();
            let order = match &message {
                Some(ToDrive::Command { order, .. }) => Some(*order),
                _ => None,
            };
            assert!(
                before != State::Faulted || after == before || order == Some(Order::ClearFault),
                "{message:?} clears a fault"
            );
            assert!(
                before == after || after != State::Armed,
                "armed at once by {message:?}"
            );
            assert!(
                before == after || after != State::Arming || order == Some(Order::Arm),
                "{message:?} arms"
            );
            if let Some(ToDrive::Heartbeat(heartbeat)) = message {
                self.note(now, &heartbeat);
            }
        }
    }

    fn note(&mut self, now: u64, heartbeat: &Heartbeat) {
        self.has_restarted |= heartbeat.start != 0;
        let seen = heartbeat.seen_tick;
        let is_new = self.last_beat.is_none_or(|(start, number)| {
            let ahead = heartbeat.number.wrapping_sub(number);
            let is_silent =
                (self.comms_start).is_none_or(|last| now.saturating_sub(last) >= HEARTBEAT_TICKS);
            start != heartbeat.start || (1..128).contains(&ahead) || is_silent && ahead != 0
        });
        if is_new && seen <= now && now - seen <= STALE_TICKS {
            self.last_beat = Some((heartbeat.start, heartbeat.number));
            self.comms_start = Some(now);
            self.lease_end = seen.saturating_add(u64::from(heartbeat.lease_left));
            if !heartbeat.enable {
                let state = self.drive.state();
                assert!(matches!(state, State::Disarmed | State::Faulted));
            }
        }
    }

    fn run(&mut self, ticks: u64, readings: &Readings) {
        for _ in 0..ticks {
            self.tick(readings);
        }
    }

    fn tick(&mut self, readings: &Readings) {
        let before = self.drive.state();
        let tick = self.drive.next_tick();
        self.ticks += 1;
        self.counter = self.counter.wrapping_add_signed(readings.turn.into());
        // Ticks begin with the first result.
        if !readings.is_late || self.drive.rendered().is_none() {
            self.drive.sample_encoder(self.counter);
            self.drive.render_torque();
        }
        let current_a = readings.current_a.unwrap_or(self.winding.current_a());
        let (mut monitor_a, mut interval_us, mut coil_a) =
            (current_a, TICK_US, self.coil.current_a());
        match readings.sensor_fault {
            Some(SensorFault::MonitorOffsetA(value)) => monitor_a += value,
            Some(SensorFault::IntervalUs(value)) => interval_us = value,
            Some(SensorFault::CoilA(value)) => coil_a = value,
            _ => {}
        }
        let inputs = Inputs {
            current_a: readings.has_current.then_some(current_a),
            monitor_a: readings.has_current.then_some(monitor_a),
            interval_us,
            enable_is_on: readings.line.unwrap_or(self.line_is_on),
            comms_enable_is_on: readings.sensor_fault == Some(SensorFault::CommsLineIsOn)
                || !readings.comms_line_is_off
                    && (before == State::Armed || self.drive.awaits_comms()),
            has_tripped: readings.has_tripped,
            slow: readings.slow(tick, current_a),
            coil_a: readings.has_current.then_some(coil_a),
            coil_has_tripped: readings.sensor_fault == Some(SensorFault::CoilHasTripped),
        };
        let coil_fault = self.drive.coil_fault();
        let outputs = self.drive.command_motor(&inputs);
        if let CoilOutput::Driven(duty) = outputs.coil {
            assert!(duty.abs() <= LARGEST_COIL_DUTY, "{duty}");
            assert!(outputs.enable && inputs.comms_enable_is_on);
            assert_eq!(self.drive.state(), State::Armed);
            assert_eq!(self.drive.coil_fault(), None);
        }
        assert!(coil_fault.is_none() || self.drive.coil_fault() == coil_fault);
        if readings.is_idle {
            self.drive.prepare();
        }
        self.coil.tick(outputs.coil);
        self.line_is_on = outputs.enable;
        // Each line closes the bridge's gate by itself.
        let powered = outputs.enable && inputs.enable_is_on && inputs.comms_enable_is_on;
        self.winding.tick(
            if powered {
                outputs.bridge
            } else {
                Bridge::Float
            },
            readings.turn,
        );
        self.hold(tick, before, &inputs, &outputs);
        self.parameters();
    }

    fn hold(&mut self, tick: u64, before: State, inputs: &Inputs, outputs: &Outputs) {
        let state = self.drive.state();
        let is_driven = matches!(outputs.bridge, Bridge::Driven(_));
        self.energised.push(state == State::Armed && is_driven);
        assert!(before != State::Faulted || state == State::Faulted);
        assert!(before != State::Disarmed || !matches!(state, State::Arming | State::Armed));
        assert_eq!(self.drive.fault().is_some(), state == State::Faulted);
        let live = matches!(state, State::Arming | State::Armed);
        assert!(!live || self.drive.revision() != Revision::NONE);
        assert!(!outputs.enable || live, "the line is on in {state:?}");
        let Bridge::Driven(volts) = outputs.bridge else {
            self.astray = 0;
            return;
        };
        assert!(volts.is_finite() && live);
        let most_duty = LARGEST_DUTY * (1.0 + f32::EPSILON);
        assert!(outputs.duty.abs() <= most_duty, "{outputs:?}");
        // Arming proves that no current flows with either line off.
        let arming = state == State::Arming;
        let proves_comms = arming && !self.drive.awaits_comms();
        let proves_drive = arming && self.drive.awaits_comms() && !outputs.enable;
        assert!(inputs.comms_enable_is_on || proves_comms);
        assert!(outputs.enable || proves_drive);
        let is_proof = proves_comms || proves_drive;
        assert!(is_proof || !inputs.has_tripped && inputs.current_a.is_some());
        let heard = self.comms_start.expect("a heartbeat");
        assert!(tick - heard < HEARTBEAT_TICKS, "{} ticks", tick - heard);
        assert!(tick < self.lease_end, "the lease has ended");
        self.astray = if inputs.enable_is_on || !outputs.enable {
            0
        } else {
            self.astray + 1
        };
        assert!(self.astray <= 10, "the line is off");
    }

    fn parameters(&self) {
        let Some(values) = self.drive.values() else {
            return;
        };
        let revision = self.drive.revision();
        if revision == Revision::NONE && *values == Values::default() {
            return;
        }
        assert!(DeviceSettings::of(values).is_ok());
        assert!(
            self.sent.contains(&(revision, *values)),
            "{revision} was never sent like this"
        );
    }

    /// Lets the link's task run so often, and takes the frames it makes.
    fn read(&mut self, runs: usize) {
        for _ in 0..runs {
            let drive = &self.drive;
            let now = (drive.next_tick(), drive.state(), drive.revision());
            // A status takes a few runs to be made.
            self.states.truncate(STATUS_RUNS);
            self.states.push_front(now);
            if let Some(frame) = self.drive.link_to_send(true) {
                self.received(&frame);
            }
        }
        let counters = self.drive.counters();
        let produced = u64::from(counters.get(DriveCounter::Produced));
        let dropped = u64::from(counters.get(DriveCounter::Dropped));
        let samples = BLOCK_SAMPLES as u64;
        assert_eq!(produced, self.ticks / samples * samples);
        let waiting = produced - dropped - self.received;
        assert!(waiting <= 4 * samples, "{waiting} samples wait");
    }

    fn received(&mut self, frame: &[u8]) {
        let mut found = 0;
        for byte in frame {
            let Some(body) = self.host.push(*byte) else {
                continue;
            };
            let body = body.expect("a frame in order");
            found += 1;
            match body.lane() {
                Some(Lane::FromDrive) => match body.message().expect("a message") {
                    FromDrive::Status(status) => {
                        let told = (status.tick, status.state, status.revision);
                        // Of what another start of comms has sent, or one that it has not heard of, the drive
                        // tells nothing.
                        let is_other = self.has_restarted || status.comms_start.is_none();
                        let is_so = |(tick, state, revision): &(u64, State, Revision)| {
                            let is_told = status.revision == Revision::NONE && is_other;
                            (*tick, *state) == (told.0, told.1) && (*revision == told.2 || is_told)
                        };
                        assert!(self.states.iter().any(is_so), "{told:?} was never so");
                    }
                    FromDrive::CrashPart(part) => {
                        let expected = self.crash.chunks(PART_WORDS).nth(part.number.into());
                        let words = part.words.as_ref().map(<[u32; PART_WORDS]>::as_slice);
                        assert_eq!(words.is_some(), expected.is_some(), "{part:?}");
                        let pairs = words.into_iter().zip(expected);
                        assert!(
                            pairs
                                .into_iter()
                                .all(|(words, expected)| words.starts_with(expected))
                        );
                    }
                },
                Some(Lane::ManagementAnswer) => {
                    assert!(Answer::of(body.payload).is_some());
                }
                Some(Lane::Telemetry) => {
                    let block = body.message().expect("a block");
                    self.received += BLOCK_SAMPLES as u64;
                    self.energised(&block);
                    let end = self.received + u64::from(block_dropped(&block));
                    assert_eq!(block.end_tick() - self.first_tick, end, "sample accounting");
                    let blocks = (block.first_tick - self.first_tick) / BLOCK_SAMPLES as u64;
                    let [low, high, ..] = blocks.to_le_bytes();
                    let expected = self.sequence.wrapping_add(u16::from_le_bytes([low, high]));
                    assert_eq!(block.sequence, expected);
                }
                other => panic!("{other:?} from the drive"),
            }
        }
        assert_eq!(found, 1, "frames in a frame");
    }

    /// The samples say in which ticks there was torque.
    fn energised(&self, block: &Block) {
        let first = usize::try_from(block.first_tick - self.first_tick).expect("a few");
        let ticks = self.energised.get(first..).unwrap_or_default();
        for (sample, is_energised) in block.samples.iter().zip(ticks) {
            let says = sample.flags.has(SampleFlags::ENERGISED);
            assert_eq!(says, *is_energised, "{sample:?}");
        }
    }
}

/// Number of dropped samples that a block reports; its torque is held to its law on the way.
fn block_dropped(block: &Block) -> u32 {
    for sample in &block.samples {
        let is_energised = sample.flags.has(SampleFlags::ENERGISED);
        assert!(sample.torque_nm.abs() <= MOST_NM, "{sample:?}");
        assert!(is_energised || sample.torque_nm == 0.0, "{sample:?}");
    }
    block.dropped
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without torque most of the drive would never be searched.
    #[test]
    fn all_that_arming_needs_arms() {
        let mut bench = Bench::new(&Boot {
            self_test: SelfTest::default(),
            identity: Identity::default(),
            counter: 0,
            start: 0,
            tick: 0,
            sequence: 0,
            crash: None,
        });
        for input in [&[8][..], &[2, 0, 31]] {
            bench.step(&mut Bytes::new(input));
        }
        assert_eq!(bench.drive.state(), State::Armed);
    }
}
