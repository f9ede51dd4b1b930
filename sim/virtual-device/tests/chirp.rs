//! A chirp on the coil: who may play it, what is played, and what ends it.

mod support;

use crepitus_model::control::chirp::Chirp;
use crepitus_protocol::chirp::PlayedChirp;
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::management::Action;
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{Session, State};
use crepitus_virtual_device::Start;
use support::{Host, scene};

const CHIRP: PlayedChirp = PlayedChirp {
    amplitude_mv: 400,
    from_dhz: 80,
    to_dhz: 5_000,
    duration_ms: 500,
};

/// A joint that stands still and carries the actuator as a vice would, armed.
fn armed() -> Host {
    armed_at(0.0)
}

/// An armed joint that turns at this speed, and carries the actuator as a vice would.
fn armed_at(omega_rad_s: f64) -> Host {
    let mut host = Host::new(
        &scene(
            &r#"
version = 1
title = "Actuator in a vice"
duration_s = 60.0
[motion]
kind = "constant"
from_deg = 20.0
velocity_rad_s = 0.0
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.crepitus]
preset = "coarse"
[effects.encoder]
[effects.motor]
[effects.drivetrain]
[effects.vibration-actuator]
gain = 0.0
[effects.reaction-mass]
"#
            .replace(
                "velocity_rad_s = 0.0",
                &format!("velocity_rad_s = {omega_rad_s:?}"),
            ),
        ),
        &Start::default(),
    );
    host.run(2_000);
    host.arm();
    host.run(400);
    host
}

fn play(host: &mut Host, chirp: PlayedChirp) -> Result<Answer, Refusal> {
    host.ask_patiently(Operation::PlayChirp(chirp))
}

fn refused(answer: Result<Answer, Refusal>) -> DriveRefusal {
    match answer {
        Err(Refusal::Drive(refusal)) => refusal,
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_voltage_is_that_of_the_generator_and_every_tick_is_marked() {
    let mut host = armed();
    host.subscribe();
    host.samples = Some(Vec::new());
    let mut volts = Vec::new();
    let request = host.request(Operation::PlayChirp(CHIRP));
    host.say(&request);
    for _ in 0..12_000 {
        host.run(1);
        volts.push(host.device.board().leg().coil_v().unwrap_or(0.0));
    }
    assert_eq!(host.answer_to(&request), Some(Ok(Answer::Done)));
    let settings = CHIRP.settings();
    let mut generator = Chirp::new(&settings).unwrap();
    let expected: Vec<f64> = (0..settings.duration_ticks)
        .map(|_| f64::from(generator.tick()))
        .collect();
    // The first voltage of the chirp is zero: the second tells where it begins.
    let begins = volts.iter().position(|v| *v != 0.0).unwrap() - 1;
    let rest = volts.split_off(begins);
    for (tick, (volts, expected)) in rest.iter().zip(&expected).enumerate() {
        assert!(
            (volts - expected).abs() < 1e-6,
            "{tick}: {volts} {expected}"
        );
    }
    assert!(rest[expected.len()..].iter().all(|v| *v == 0.0));
    let samples = host.samples.take().unwrap();
    let marked = samples
        .iter()
        .filter(|sample| sample.flags.has(SampleFlags::CHIRP))
        .count();
    assert_eq!(marked, expected.len());
    // The motor does not notice.
    assert_eq!(host.status().state, State::Armed);
}

#[test]
fn only_the_holder_of_the_lease_plays_and_only_what_the_actuator_bears() {
    let mut host = armed();
    // At once: a reply that comes later belongs to no chirp.
    assert_eq!(play(&mut host, CHIRP), Ok(Answer::Done));
    assert_eq!(refused(play(&mut host, CHIRP)), DriveRefusal::ChirpPlaying);
    host.run(12_000);
    for bad in [
        PlayedChirp {
            amplitude_mv: 4_700,
            ..CHIRP
        },
        PlayedChirp {
            amplitude_mv: 0,
            ..CHIRP
        },
        PlayedChirp {
            duration_ms: 499,
            ..CHIRP
        },
        PlayedChirp {
            to_dhz: 10_001,
            ..CHIRP
        },
    ] {
        assert_eq!(
            refused(play(&mut host, bad)),
            DriveRefusal::ChirpOutOfRange,
            "{bad:?}"
        );
    }
    let holder = host.session;
    host.session = Session(0x5678);
    host.open();
    assert_eq!(
        play(&mut host, CHIRP),
        Err(Refusal::Leased { by: holder }),
        "another session"
    );
    host.session = holder;
    assert_eq!(play(&mut host, CHIRP), Ok(Answer::Done));
    host.disarm();
    host.run(200);
    assert_eq!(refused(play(&mut host, CHIRP)), DriveRefusal::NotArmed);
}

#[test]
fn it_ends_with_the_torque_for_good() {
    for stop in [false, true] {
        let mut host = armed();
        assert_eq!(play(&mut host, CHIRP), Ok(Answer::Done));
        host.run(2_000);
        assert!(host.device.board().leg().coil_v().is_some());
        if stop {
            host.manage(Action::Stop, 7);
            host.renew_every = None;
        } else {
            host.disarm();
        }
        host.run(200);
        assert!(!host.device.board().coil_is_driven(), "stop {stop}");
        // The chirp does not go on where it was.
        host.arm();
        for _ in 0..4_000 {
            host.run(1);
            assert_eq!(host.device.board().leg().coil_v().unwrap_or(0.0), 0.0);
        }
    }
}

#[test]
fn an_actuator_that_is_off_plays_nothing() {
    let mut host = armed();
    host.set("vibration-actuator.render", 0.0);
    host.run(4_000);
    assert_eq!(refused(play(&mut host, CHIRP)), DriveRefusal::NoActuator);
}

#[test]
fn switching_the_actuator_off_ends_it_for_good() {
    let mut host = armed();
    assert_eq!(play(&mut host, CHIRP), Ok(Answer::Done));
    host.run(1_000);
    host.set("vibration-actuator.render", 0.0);
    host.run(4_000);
    assert!(!host.device.board().coil_is_driven());
    host.set("vibration-actuator.render", 1.0);
    for _ in 0..4_000 {
        host.run(1);
        assert_eq!(host.device.board().leg().coil_v().unwrap_or(0.0), 0.0);
    }
}

/// A gain that fades in behind a chirp would be a step of voltage at its end.
#[test]
fn a_gain_that_is_committed_meanwhile_ends_it_for_good() {
    let mut host = armed_at(0.05);
    let chirp = PlayedChirp {
        duration_ms: 5_000,
        ..CHIRP
    };
    host.subscribe();
    assert_eq!(play(&mut host, chirp), Ok(Answer::Done));
    host.run(1_000);
    host.set("vibration-actuator.gain", 1.0);
    host.run(4_000);
    host.samples = Some(Vec::new());
    host.run(20_000);
    let samples = host.samples.take().unwrap();
    let chirps = samples
        .iter()
        .filter(|sample| sample.flags.has(SampleFlags::CHIRP));
    assert_eq!((chirps.count(), samples.len() > 15_000), (0, true));
    assert_eq!(host.status().state, State::Armed);
}
