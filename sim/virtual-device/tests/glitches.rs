//! Disturbances that are over in a moment, and motions of a hand while the device is
//! being armed: neither is a fault.

mod support;

use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::{Fault, State};
use crepitus_virtual_device::board::Controller;
use crepitus_virtual_device::leg::{CurrentPath, EncoderWiring};
use crepitus_virtual_device::{Board, Start};
use support::{Host, examination, examination_at};

fn connected() -> Host {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    host
}

fn faults(board: &Board) -> [Option<Fault>; 2] {
    [board.drive().fault(), board.comms().fault()]
}

/// Something is wrong for so many ticks, again and again.
fn flicker(host: &mut Host, ticks: u64, break_it: fn(&mut Board), mend_it: fn(&mut Board)) {
    for round in 0..20 {
        break_it(host.device.board_mut());
        host.run(ticks);
        mend_it(host.device.board_mut());
        host.run(100 + 7 * round);
        assert_eq!(faults(host.device.board()), [None, None], "round {round}");
    }
}

#[test]
fn a_moment_under_torque_is_no_fault() {
    let mut host = connected();
    host.subscribe();
    host.arm();
    host.run(6_000);
    flicker(
        &mut host,
        2,
        |board| board.set_converter(CurrentPath::Sensor, false),
        |board| board.set_converter(CurrentPath::Sensor, true),
    );
    flicker(
        &mut host,
        19,
        |board| board.set_renderings(0),
        |board| board.set_renderings(1),
    );
    flicker(
        &mut host,
        8,
        |board| board.set_stuck(Controller::Drive, Some(false)),
        |board| board.set_stuck(Controller::Drive, None),
    );
    let jump = |board: &mut Board, counts: i32| {
        let count = board.leg().count();
        board.leg_mut().preset_count(count.wrapping_add(counts));
    };
    for _ in 0..20 {
        jump(host.device.board_mut(), 50_000);
        host.run(1);
        jump(host.device.board_mut(), -50_000);
        host.run(100);
    }
    assert_eq!(host.status().state, State::Armed);
    assert_eq!(host.accounting.expect("a subscription").dropped, 0);
}

#[test]
fn a_moment_at_rest_is_no_fault() {
    let mut host = connected();
    for controller in [Controller::Drive, Controller::Comms] {
        for _ in 0..20 {
            host.device.board_mut().set_stuck(controller, Some(true));
            host.run(8);
            host.device.board_mut().set_stuck(controller, None);
            host.run(33);
        }
    }
    assert_eq!(faults(host.device.board()), [None, None]);
    assert_eq!(host.status().state, State::Disarmed);
}

/// A leg that a hand swings fast, armed at whatever
/// moment: encoder and motor are judged by the push alone.
#[test]
fn a_leg_that_moves_while_it_is_armed_is_not_misjudged() {
    let mut host = Host::new(&examination_at(150.0, 0.05), &Start::default());
    host.run(400);
    host.renew_every = Some(1_000);
    let (mut proven, mut noticed) = (0, 0);
    for wiring in [EncoderWiring::Right, EncoderWiring::Swapped] {
        host.device.board_mut().leg_mut().set_encoder_wiring(wiring);
        for round in 0..60 {
            host.run(137);
            assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
            let answer = host.ask(Operation::Arm);
            let is_proven = host.status().polarity_proven;
            if wiring == EncoderWiring::Right {
                assert_eq!(answer, Ok(Answer::Done), "round {round}");
                proven += u32::from(is_proven);
            } else {
                // In the wrong sense the bridge starts with the wrong voltage: a
                // fast leg makes a large current of it, and back-EMF contradicts
                // the counts.
                let faults = [
                    Fault::EncoderPolarity,
                    Fault::Overcurrent,
                    Fault::SpeedMismatch,
                ];
                let is_refused = faults
                    .map(Fault::code)
                    .map(|code| Err(Refusal::Drive(DriveRefusal::Faulted { code })))
                    .contains(&answer);
                assert!(is_refused || !is_proven, "round {round}: {answer:?}");
                noticed += u32::from(is_refused);
            }
            assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
            host.run(60);
            assert_eq!(host.ask(Operation::ClearFault), Ok(Answer::Done));
        }
    }
    println!("{proven} of 60 proven, {noticed} of 60 swapped encoders noticed");
    assert!(proven >= 50 && noticed >= 50);
}
