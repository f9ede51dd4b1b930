//! The image's torque is that of the native `Drive`, bit for bit.
//!
//! What the image reads from its registers is written down, in its order: the
//! encoder's counter, the converters, the clock, the enable line, the break, and how far
//! the DMA has come. The native drive is given just that, at the same places
//! of its program, has to send the same blocks, and to want the same duties of motor and
//! coil.

use crate::host::{Flash, Host, examination, image};
use crate::symptoms::{self, CASES, Case, PERIOD_TICKS, SYMPTOMS};
use crepitus_device::Drive;
use crepitus_device::board::LARGEST_COIL_DUTY;
use crepitus_device::drive::Boot;
use crepitus_device::drive::coil::CoilOutput;
use crepitus_device::drive::command::{Inputs, Outputs};
use crepitus_device::drive::motor::Bridge;
use crepitus_device::drive::slow_checks::SlowInput;
use crepitus_emulator::Time;
use crepitus_emulator::mcu::Access;
use crepitus_model::Real;
use crepitus_model::render::effects::Phases;
use crepitus_protocol::frame::DELIMITER;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};
use crepitus_protocol::{Decoder, Lane, Revision, State};
use std::collections::BTreeMap;

const ENCODER: u32 = 0x4000_0c24;
const SENSOR_FLAGS: u32 = 0x4001_2000;
/// The regular conversion and the injected ones, in the order in which they are read.
const SENSOR_DATA: [u32; 4] = [0x4001_204c, 0x4001_203c, 0x4001_2040, 0x4001_2044];
const MONITOR_DATA: [u32; 4] = [0x4001_214c, 0x4001_213c, 0x4001_2140, 0x4001_2144];
const SLOW_SEQUENCE: u32 = 0x4001_2234;
const SLOW_DATA: u32 = 0x4001_224c;
/// The injected conversion of the third converter, and the flags of the coil's timer: both
/// are read while the coil is driven only.
const COIL_DATA: u32 = 0x4001_223c;
const COIL_FLAGS: u32 = 0x4001_0410;
const CLOCK: u32 = 0x4000_0024;
const LINE: u32 = 0x4002_0410;
const BREAK_FLAGS: u32 = 0x4001_0010;
const LINK_CONTROL: u32 = 0x4001_140c;
const RECEIVED_LEFT: u32 = 0x4002_642c;
/// Compare values of bridge and coil, in the order in which they are written.
const MOTOR_COMPARE: [u32; 2] = [0x4001_0034, 0x4001_0038];
const COIL_COMPARE: [u32; 2] = [0x4001_043c, 0x4001_0440];
pub(crate) const REGISTERS: [u32; 23] = [
    ENCODER,
    SENSOR_FLAGS,
    SENSOR_DATA[0],
    SENSOR_DATA[1],
    SENSOR_DATA[2],
    SENSOR_DATA[3],
    MONITOR_DATA[0],
    MONITOR_DATA[1],
    MONITOR_DATA[2],
    MONITOR_DATA[3],
    SLOW_SEQUENCE,
    SLOW_DATA,
    COIL_DATA,
    COIL_FLAGS,
    CLOCK,
    LINE,
    BREAK_FLAGS,
    LINK_CONTROL,
    RECEIVED_LEFT,
    MOTOR_COMPARE[0],
    MOTOR_COMPARE[1],
    COIL_COMPARE[0],
    COIL_COMPARE[1],
];

/// Clocks of half a period of both timers.
const TOP: f64 = 4_200.0;

/// Bytes of the ring that the DMA fills.
const RING: u32 = 2_048;

/// The most that a run of the task takes of them.
const RUN: u32 = 24;

/// Ticks that are compared, at least.
const TICKS: usize = 20_000;

/// Converts the sum of a converter's four counts to amperes, in the image's arithmetic.
fn amperes(sum: u32) -> f32 {
    #[expect(clippy::cast_precision_loss, reason = "fourteen bits")]
    let sum = sum as f32;
    (sum * (1.0 / (4.0 * 4096.0)) - 0.5) * (3.3 / (20.0 * 0.033))
}

/// Converts a channel's counts to what it measures, in the image's arithmetic.
fn slow(channel: u32, counts: u32) -> SlowInput {
    #[expect(clippy::cast_precision_loss, reason = "twelve bits")]
    let share = counts as f32 * (1.0 / 4096.0);
    match channel {
        13 => SlowInput::SupplyV(share * 3.3 * 16.0),
        2 => SlowInput::MotorC((share * 3.3 - 0.5) * 100.0),
        _ => SlowInput::JointTurns(share),
    }
}

/// Converts the counts of the coil's current to amperes, in the image's arithmetic.
fn coil_amperes(counts: u32) -> f32 {
    #[expect(clippy::cast_precision_loss, reason = "twelve bits")]
    let share = counts as f32 * (1.0 / 4096.0);
    (share - 0.5) * (3.3 / (20.0 * 0.025))
}

/// The native drive, led by what the image has read.
struct Replay<'a> {
    drive: Drive,
    inputs: Inputs,
    /// Outputs that it wanted of motor and coil in its last tick.
    outputs: Outputs,
    /// The first compare value of a pair.
    compare: u32,
    /// Duties of the image that were compared with it.
    duties: u64,
    /// Sum of the counts of a current that were read.
    sum: u32,
    /// Channel of the third converter.
    channel: u32,
    clock_us: u32,
    /// Bytes that the image's link has received.
    bytes: std::slice::Iter<'a, u8>,
    next: u32,
    /// The last run of the link's task took bytes, and the end of a frame.
    has_received: bool,
    has_ended: bool,
    /// Samples that were put into blocks.
    pushed: u64,
    /// The parameters in force, block by block, in the image.
    revisions: BTreeMap<u64, Revision>,
    decoder: Decoder,
    blocks: Vec<Block>,
}

impl Replay<'_> {
    fn access(&mut self, access: &Access) {
        if access.is_write {
            match access.address {
                SLOW_SEQUENCE => self.channel = access.value,
                first if first == MOTOR_COMPARE[0] || first == COIL_COMPARE[0] => {
                    self.compare = access.value;
                }
                second if second == MOTOR_COMPARE[1] => {
                    let is_driven = self.outputs.bridge != Bridge::Float;
                    let duty = if is_driven { self.outputs.duty } else { 0.0 };
                    self.duty("motor", duty, self.compare, access.value);
                }
                // The coil's inputs are high from their compare value up.
                second if second == COIL_COMPARE[1] => {
                    let duty = match self.outputs.coil {
                        CoilOutput::Driven(duty) => duty.within(LARGEST_COIL_DUTY),
                        CoilOutput::Asleep => 0.0,
                    };
                    self.duty("coil", duty, access.value, self.compare);
                }
                _ => {}
            }
            return;
        }
        match access.address {
            ENCODER => self.sample(access.value),
            SENSOR_FLAGS => self.inputs = Inputs::default(),
            address if SENSOR_DATA.contains(&address) => {
                let all = self.add(address, access.value, &SENSOR_DATA);
                self.inputs.current_a = all.map(amperes).or(self.inputs.current_a);
            }
            address if MONITOR_DATA.contains(&address) => {
                let all = self.add(address, access.value, &MONITOR_DATA);
                self.inputs.monitor_a = all.map(|sum| -amperes(sum)).or(self.inputs.monitor_a);
            }
            SLOW_DATA => self.inputs.slow = slow(self.channel, access.value),
            COIL_DATA => self.inputs.coil_a = Some(coil_amperes(access.value)),
            COIL_FLAGS => self.inputs.coil_has_tripped = access.value >> 7 & 1 == 1,
            CLOCK => {
                self.inputs.interval_us = access.value.wrapping_sub(self.clock_us);
                self.clock_us = access.value;
            }
            // PB1, PB10.
            LINE => {
                self.inputs.enable_is_on = access.value >> 1 & 1 == 1;
                self.inputs.comms_enable_is_on = access.value >> 10 & 1 == 1;
            }
            BREAK_FLAGS => {
                self.inputs.has_tripped = access.value >> 7 & 1 == 1;
                self.outputs = self.drive.command_motor(&self.inputs);
                self.pushed += u64::from(self.drive.next_tick() > 0);
            }
            RECEIVED_LEFT => {
                let end = (RING - access.value) % RING;
                let come = (end + RING - self.next) % RING;
                let run = come.min(RUN);
                self.link(run);
            }
            _ => {}
        }
    }

    /// Compares a duty that the image sets with the native drive's: a clock of each.
    fn duty(&mut self, what: &str, wanted: f32, high: u32, low: u32) {
        let set = (f64::from(high) - f64::from(low)) / TOP;
        let tick = self.drive.next_tick();
        assert!(
            (set - f64::from(wanted)).abs() <= 2.0 / TOP,
            "before tick {tick} the {what} has a duty of {set}, and {wanted} is wanted"
        );
        self.duties += 1;
    }

    /// Adds counts of a current; returns the sum of all once the last has been read.
    fn add(&mut self, address: u32, counts: u32, registers: &[u32; 4]) -> Option<u32> {
        if address == registers[0] {
            self.sum = 0;
        }
        self.sum += counts;
        (address == registers[3]).then_some(self.sum)
    }

    fn sample(&mut self, counter: u32) {
        // The block of the sample after the next one: a plan is taken over before
        // the first tick of its block.
        let block = (self.pushed + 1) / BLOCK_SAMPLES as u64 * BLOCK_SAMPLES as u64;
        let in_force = self.revisions.get(&block);
        // When the idle loop was done with a commit shows in the blocks.
        if in_force.is_some_and(|revision| *revision != self.drive.revision()) {
            self.drive.prepare();
        }
        self.drive.sample_encoder(counter);
        self.drive.render_torque();
    }

    /// Receives or sends, as the task does.
    fn link(&mut self, run: u32) {
        let is_end = run > 0 && self.is_end();
        let may_receive = !self.has_received || is_end && !self.has_ended;
        self.has_received = run > 0 && may_receive;
        self.has_ended = self.has_received && is_end;
        if !self.has_received {
            self.send();
            return;
        }
        for _ in 0..if is_end { 1 } else { run } {
            let byte = self.bytes.next().expect("it has been received");
            self.drive.link_received(*byte);
            self.next = (self.next + 1) % RING;
            if self.is_end() {
                break;
            }
        }
    }

    /// Returns whether the next byte ends a frame.
    fn is_end(&self) -> bool {
        self.bytes.as_slice().first() == Some(&DELIMITER)
    }

    fn send(&mut self) {
        let Some(frame) = self.drive.link_to_send(true) else {
            return;
        };
        for byte in &frame {
            if let Some(Ok(body)) = self.decoder.push(*byte)
                && body.lane() == Some(Lane::Telemetry)
            {
                self.blocks.extend(body.message::<Block>());
            }
        }
    }
}

#[test]
fn twenty_thousand_ticks_are_those_of_the_native_drive_bit_for_bit() {
    check(Flash::ZeroWaitStates);
}

#[test]
fn with_the_modelled_flash_too() {
    check(Flash::Modelled);
}

/// The drive's link is switched on at any instant of the frames of comms: every millisecond
/// there are 31 µs of them.
#[test]
fn whatever_comms_sends_while_it_starts() {
    let Some(image) = image() else { return };
    for late_us in (0..1_000).step_by(29) {
        let late = Time::from_us(late_us);
        let mut host = Host::late(&image, &examination(), &REGISTERS, late);
        host.arm();
        host.run(100);
        assert!(compare(&mut host) > 0, "{late_us} µs");
    }
}

fn check(flash: Flash) {
    let Some(image) = image() else { return };
    let mut host = Host::timed(&image, &examination(), &REGISTERS, flash);
    host.arm();
    host.run(TICKS as u64 + 500);
    let armed = compare(&mut host);
    assert!(armed >= TICKS, "{armed} ticks under torque");
    // To the end: in the last 100 ms, as in one sample there may be none.
    let last = host.blocks.iter().rev().take(100);
    let mut torques_nm = last.flat_map(|block| block.samples.map(|sample| sample.torque_nm));
    assert!(torques_nm.any(|torque_nm| torque_nm.abs() > 0.05));
}

/// Each symptom by itself, in both forms where it has two, and all at once.
#[test]
fn every_symptom_is_that_of_the_native_drive_bit_for_bit() {
    let Some(mut host) = symptoms::armed(&REGISTERS, Flash::ZeroWaitStates) else {
        return;
    };
    let all: Vec<&Case> = CASES.iter().take(SYMPTOMS).collect();
    let each = CASES.iter().map(|case| vec![case]);
    let each: Vec<Vec<&Case>> = each.chain([all]).collect();
    for cases in &each {
        let revision = symptoms::commit(&mut host, symptoms::values_of(cases));
        host.run(PERIOD_TICKS);
        let blocks = host
            .blocks
            .iter()
            .filter(|block| block.revision == revision);
        let phases: Vec<Phases> = blocks.flat_map(|b| b.phases).map(Phases::from).collect();
        for case in cases {
            for phase in case.phases {
                let mut named = phases.iter().flat_map(|phases| phases.named());
                let is_there =
                    named.any(|(spec, name)| spec.name == case.symptom && name == *phase);
                assert!(is_there, "{}: {phase}", case.symptom);
            }
        }
    }
    let armed = compare(&mut host);
    assert!(
        armed as u64 >= each.len() as u64 * PERIOD_TICKS,
        "{armed} ticks under torque"
    );
}

/// Gives the native drive what the image has read, and compares what they have sent: how
/// many ticks of it armed.
pub(crate) fn compare(host: &mut Host) -> usize {
    let accesses = host.board.mcu_mut().take_accesses();
    let listens = accesses
        .iter()
        .find(|access| access.address == LINK_CONTROL && access.is_write)
        .expect("the link is switched on");
    let bytes: Vec<u8> = host
        .board
        .comms()
        .to_drive()
        .iter()
        .filter(|character| character.at > listens.at.units())
        .map(|character| character.byte)
        .collect();
    let first = host.blocks.first().expect("a block");
    // Until the first current is asked for the counter is read to begin with.
    let begin = accesses
        .iter()
        .position(|access| access.address == SENSOR_FLAGS)
        .expect("a first tick");
    let counter = accesses[..begin]
        .iter()
        .rfind(|access| access.address == ENCODER)
        .expect("a count");
    let boot = Boot {
        counter: counter.value,
        start: first.flags.start().into(),
        ..Boot::default()
    };
    let revision = |block: &Block| (block.first_tick, block.revision);
    let mut replay = Replay {
        drive: Drive::new(&boot).expect("a drive"),
        inputs: Inputs::default(),
        outputs: Outputs::default(),
        compare: 0,
        duties: 0,
        sum: 0,
        channel: 13,
        clock_us: 0,
        bytes: bytes.iter(),
        next: 0,
        has_received: false,
        has_ended: false,
        pushed: 0,
        revisions: host.blocks.iter().map(revision).collect(),
        decoder: Decoder::new(),
        blocks: Vec::new(),
    };
    for access in &accesses[begin..] {
        replay.access(access);
    }
    let natives = replay
        .blocks
        .iter()
        .skip_while(|block| block.sequence != first.sequence);
    let (mut armed, mut compared) = (0, 0);
    for (image, native) in host.blocks.iter().zip(natives) {
        compared += 1;
        assert_eq!(image, native);
        // Floats that are equal may differ in the sign of a zero.
        for (ours, theirs) in image.samples.iter().zip(&native.samples) {
            assert_eq!(ours.torque_nm.to_bits(), theirs.torque_nm.to_bits());
            let (ours, theirs) = (ours.model_torque_nm, theirs.model_torque_nm);
            assert_eq!(ours.to_bits(), theirs.to_bits());
        }
        if image.flags.state() == State::Armed {
            armed += BLOCK_SAMPLES;
        }
    }
    assert!(replay.duties >= armed as u64, "{} duties", replay.duties);
    let blocks = host.blocks.len();
    assert!(compared + 3 >= blocks, "{compared} of {blocks} blocks");
    armed
}
