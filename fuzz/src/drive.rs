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

mod from_drive;
mod readings;
mod to_drive;

use crate::bytes::Bytes;
use crate::link_inputs;
use crate::winding::{CoilWinding, Winding};
use crepitus_device::Drive;
use crepitus_device::board::{LARGEST_COIL_DUTY, LARGEST_DUTY};
use crepitus_device::drive::coil::CoilOutput;
use crepitus_device::drive::command::{Inputs, Outputs};
use crepitus_device::drive::motor::Bridge;
use crepitus_device::drive::{Boot, Crash};
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::crash::{End, Head, TICK_WORDS};
use crepitus_protocol::link::{Heartbeat, Order, ToDrive};
use crepitus_protocol::management::{Identity, ManagementRequest, ResetCause};
use crepitus_protocol::{
    Decoder, DeviceSettings, HEARTBEAT_TICKS, Lane, Revision, State, TICK_US, Values, frame, schema,
};
use readings::{Readings, SensorFault};
use std::array;
use std::collections::VecDeque;

/// The most ticks of one input.
const MOST_TICKS: u64 = 4096;

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
}

#[cfg(test)]
mod tests;
