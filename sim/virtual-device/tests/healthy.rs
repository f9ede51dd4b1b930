//! Everything in order: what the chain does when nothing is wrong with it.

mod support;

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::ramp::Ramp;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{Frozen, Settings, StepCoefficients, StickSlip};
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::parameters;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, SampleFlags, TICKS_BYTES};
use crepitus_protocol::{Revision, State, TICK_S, TICKS_PER_S};
use crepitus_virtual_device::Start;
use std::time::Instant;
use support::{Host, examination};

#[test]
fn it_is_found_armed_moved_and_disarmed() {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    let status = host.status();
    assert_eq!(
        (status.state, status.drive_fault, status.comms_fault),
        (State::Disarmed, 0, 0)
    );
    assert!(status.drive_present);
    assert_eq!(status.in_force, status.revision);
    assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
    host.subscribe();
    host.samples = Some(Vec::new());
    host.arm();
    assert_eq!(host.status().state, State::Armed);
    host.run(20_000);
    let status = host.status();
    assert_eq!(
        (status.state, status.drive_fault, status.comms_fault),
        (State::Armed, 0, 0),
        "after a second under torque"
    );
    assert!(status.polarity_proven && status.zeroed);
    let samples = host.samples.take().unwrap();
    let breaks = samples
        .iter()
        .filter(|s| s.flags.has(SampleFlags::BREAK))
        .count();
    assert!(breaks > 10, "{breaks} breaks in a second of grating");
    let torque = samples
        .iter()
        .map(|s| s.torque_nm.abs())
        .fold(0.0, f32::max);
    assert!((0.35..=0.4).contains(&torque), "{torque}");
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    host.run(100);
    assert_eq!(host.status().state, State::Disarmed);
    assert!(!host.device.board().is_driven());
}

/// 60 s of every sample, through packets of 64 bytes.
#[test]
fn a_minute_of_telemetry_arrives_complete_and_faster_than_it_happens() {
    const SECONDS: u64 = 60;
    let mut host = Host::new(&examination(), &Start::default());
    host.run(2_000);
    host.arm();
    host.subscribe();
    let (usb, link) = (
        host.device.traffic(),
        host.device.board_mut().up().traffic(),
    );
    let begun = Instant::now();
    host.run(SECONDS * u64::from(TICKS_PER_S));
    let wall_s = begun.elapsed().as_secs_f64();

    assert_eq!(host.status().state, State::Armed);
    let accounting = host.accounting.unwrap();
    let board = host.device.board();
    let drive = board.drive().counters();
    let comms = board.comms().counters();
    // At every point of the chain.
    assert_eq!(drive.get(DriveCounter::Dropped), 0);
    assert_eq!(comms.get(CommsCounter::LostSamples), 0);
    assert_eq!(comms.get(CommsCounter::DroppedSamples), 0);
    assert_eq!(accounting.dropped, 0);
    let on_the_way = drive.get(DriveCounter::Produced) - comms.get(CommsCounter::ReceivedSamples);
    assert!(
        on_the_way <= 40,
        "{on_the_way} samples between drive and comms"
    );
    let on_the_way = u64::from(comms.get(CommsCounter::SentSamples)) - accounting.received;
    assert!(
        on_the_way <= 120,
        "{on_the_way} samples between comms and host"
    );
    let produced = SECONDS * u64::from(TICKS_PER_S);
    assert!(accounting.received >= produced);

    let payload = accounting.received / BLOCK_SAMPLES as u64 * TICKS_BYTES as u64;
    let (usb_end, link_end) = (
        host.device.traffic(),
        host.device.board_mut().up().traffic(),
    );
    let usb_bytes = usb_end.bytes_in - usb.bytes_in;
    let overhead = 100.0 * (ratio(usb_bytes, payload) - 1.0);
    let usb_rate = ratio(usb_bytes, SECONDS) / 1e6;
    let link_rate = 10.0 * ratio(link_end.bytes - link.bytes, SECONDS) / 1e6;
    println!(
        "{} samples received, {} dropped; envelope {overhead:.2} %; USB {usb_rate:.3} MB/s of 1.0; \
         link {link_rate:.2} Mbaud of 4.2; {:.1} times real time",
        accounting.received,
        accounting.dropped,
        ratio(SECONDS, 1) / wall_s
    );
    assert!(overhead <= 7.0, "{overhead} %");
    assert!(usb_rate < 1.0 && link_rate < 4.2);
    assert!(wall_s < ratio(SECONDS, 1), "slower than real time");
}

/// The model torque that the drive reports is that of `model` alone on the
/// same counts, to the bit, whatever else is added and limited.
#[test]
fn the_model_torque_is_that_of_the_model() {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(2_000);
    host.subscribe();
    for name in ["friction-compensation.render", "bone-shaping.render"] {
        set(&mut host, name, 1.0);
    }
    host.arm();
    // A joint that begins while the leg rests, for longer than the estimate of
    // its speed remembers: from there on everything is known.
    set(&mut host, "crepitus.render", 0.0);
    while !rests(&mut host) {}
    host.samples = Some(Vec::new());
    let revision = set(&mut host, "crepitus.render", 1.0);
    while host.last_block.unwrap().revision != revision {
        host.tick();
    }
    let before = host.samples.as_ref().unwrap().len() - BLOCK_SAMPLES;
    host.run(60_000);
    let samples = host.samples.take().unwrap();

    let mut settings = Settings::default();
    let target = StepCoefficients::new(&settings.validate().unwrap(), TICK_S).unwrap();
    settings.parameters.kinetic_torque_nm = 0.0;
    settings.parameters.static_torque_nm = 0.0;
    let silent = StepCoefficients::new(&settings.validate().unwrap(), TICK_S).unwrap();
    let mut ramp = Ramp::new(silent, target, 100.0);
    let mut model = Frozen::<f32, ExactEvents>::new(silent, 0.0);
    let encoder = EncoderSettings::default();
    let mut reader = EncoderReader::new(&encoder, TICK_S, samples[before].count, 0.0).unwrap();
    let mut events = 0;
    for (n, sample) in samples[before..].iter().enumerate() {
        if let Some(coefficients) = ramp.advance() {
            model.adjust(coefficients);
        }
        model.step(&reader.read(sample.count), |_| events += 1);
        assert_eq!(
            model.torque_nm().to_bits(),
            sample.model_torque_nm.to_bits(),
            "after {n} ticks and {events} events"
        );
    }
    let different = samples[before..]
        .iter()
        .filter(|s| s.model_torque_nm != s.torque_nm)
        .count();
    println!(
        "{} ticks with {events} events are the same to the bit; in {different} of them more was shown",
        samples.len() - before
    );
    assert!(events > 100 && different > 10_000);
}

fn set(host: &mut Host, name: &str, value: f64) -> Revision {
    let (id, _) = parameters::find(name).unwrap();
    host.commit(|values| values.set(id, value)).unwrap()
}

/// Runs 150 ms: whether the leg has rested all the time.
fn rests(host: &mut Host) -> bool {
    host.samples = Some(Vec::new());
    host.run(3_000);
    let samples = host.samples.take().unwrap();
    samples.iter().all(|s| s.count == samples[0].count)
}

#[expect(clippy::cast_precision_loss, reason = "numbers to print")]
fn ratio(a: u64, b: u64) -> f64 {
    a as f64 / b as f64
}
