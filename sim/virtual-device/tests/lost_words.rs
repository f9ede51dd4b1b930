//! Single words that the link loses, at the worst moment.

mod support;

use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Operation, Refusal, Request};
use crepitus_protocol::{DeviceSettings, Fault, State, ValueError};
use crepitus_virtual_device::leg::CurrentPath;
use crepitus_virtual_device::{Faults, Start};
use support::{Host, examination, set};

/// Ticks of the drive in a millisecond.
const TICKS_PER_MS: u64 = 20;

fn connected() -> Host {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    host
}

fn request(host: &mut Host, operation: Operation) -> Request {
    host.request(operation)
}

fn cut(is_cut: bool) -> Faults {
    Faults {
        is_cut,
        ..Faults::default()
    }
}

/// The drive is armed and faults, and comms hears of both at once.
#[test]
fn armed_and_faulted_in_one_word() {
    let mut host = connected();
    assert_eq!(host.ask_patiently(Operation::Zero), Ok(Answer::Done));
    host.renew_every = Some(1_000);
    let arm = request(&mut host, Operation::Arm);
    host.say(&arm);
    while host.device.board().drive().state() != State::Armed {
        host.device.board_mut().up().injector.faults =
            cut(host.device.board().drive().state() == State::Arming);
        // Blocks may pass, or the drive is silent.
        if host.device.board().now() % 60 < 30 {
            host.device.board_mut().up().injector.faults = cut(false);
        }
        host.tick();
    }
    host.device.board_mut().up().injector.faults = cut(true);
    host.device
        .board_mut()
        .set_converter(CurrentPath::Sensor, false);
    while host.device.board().drive().state() == State::Armed {
        host.tick();
    }
    host.device
        .board_mut()
        .set_converter(CurrentPath::Sensor, true);
    host.run(20);
    host.device.board_mut().up().injector.faults = cut(false);
    assert_eq!(host.answer_to(&arm), Some(Ok(Answer::Done)));
    host.run(400);
    let status = host.status();
    assert_eq!(
        (status.state, status.drive_fault, status.comms_fault),
        (State::Faulted, Fault::CurrentMissing.code(), 0)
    );
    // Nobody wants torque any more, so it can be cleared and armed again.
    assert_eq!(host.ask(Operation::ClearFault), Ok(Answer::Done));
    host.run(100);
    assert_eq!(host.status().state, State::Disarmed);
    host.arm();
}

/// Disarmed, and at once something that only changes without torque.
#[test]
fn what_needs_no_torque_may_follow_a_disarm_at_once() {
    for phase in 0..40 {
        let mut host = connected();
        host.arm();
        host.run(phase);
        let (base, mut values) = host.parameters();
        set(&mut values, "encoder.velocity_bandwidth_hz", 60.0);
        let disarm = request(&mut host, Operation::Disarm);
        let commit = request(&mut host, Operation::Commit { base, values });
        host.say(&disarm);
        host.say(&commit);
        let answer = host.answer_to(&commit);
        assert!(matches!(answer, Some(Ok(_))), "phase {phase}: {answer:?}");
    }
}

/// The drive refuses a commit, comms does not hear of it and believes that it
/// is in force. It has to take effect, or nothing can be committed again.
#[test]
fn a_refusal_that_is_never_heard() {
    let mut stuck = 0;
    for phase in 0..40 {
        let mut host = connected();
        host.arm();
        host.run(2_000 + phase);
        let (base, mut values) = host.parameters();
        set(&mut values, "encoder.velocity_bandwidth_hz", 60.0);
        assert!(DeviceSettings::of(&values).is_ok());
        // Until the commit comes, the drive does not hear that it is disarmed.
        host.device.board_mut().down().injector.faults = cut(true);
        let disarm = request(&mut host, Operation::Disarm);
        let commit = request(&mut host, Operation::Commit { base, values });
        let carried_out = host.comms_count(CommsCounter::Requests);
        host.say(&disarm);
        while host.comms_count(CommsCounter::Requests) == carried_out {
            host.tick();
        }
        host.run(phase % 8);
        host.say(&commit);
        while host.comms_count(CommsCounter::Requests) < carried_out + 2 {
            host.tick();
        }
        host.device.board_mut().up().injector.faults = cut(true);
        // Heartbeats, first in every millisecond, are lost for longer than the
        // pieces of the commit behind them.
        let mut before = 0;
        for _ in 0..5 * TICKS_PER_MS {
            let board = host.device.board_mut();
            let begins = board.now().is_multiple_of(TICKS_PER_MS);
            let injector = &mut board.down().injector;
            if begins {
                before = injector.passed();
            }
            injector.faults = cut(injector.passed() == before);
            host.tick();
        }
        host.device.board_mut().down().injector.faults = cut(false);
        host.run(15_000);
        host.device.board_mut().up().injector.faults = cut(false);
        stuck += host.drive_count(DriveCounter::RefusedCommits);
        host.run(4_000);
        let answer = host.answer_to(&commit);
        let refused = matches!(
            answer,
            Some(Err(Refusal::Values(ValueError::NeedsDisarmed { .. })))
        );
        assert!(
            refused || answer == Some(Err(Refusal::Unconfirmed)),
            "phase {phase}: {answer:?}"
        );
        let status = host.status();
        assert_eq!(status.in_force, status.revision, "phase {phase}");
        let (_, now) = host.parameters();
        if !refused {
            assert_eq!(now, values, "phase {phase}: it had to come into force");
        }
        host.set("crepitus.static_torque_nm", 0.5);
        let _ = host.ask(Operation::ClearFault);
        host.run(100);
        host.arm();
    }
    assert!(stuck > 0, "the case was met");
    println!("{stuck} of 40 refusals were not heard");
}
